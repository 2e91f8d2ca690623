#pragma once
#include <cstdint>
#include <memory>

#include "capture/frame.hpp"
#include "kernel/owned_fd.hpp"
#include "platform/display/dma_picture.hpp"

namespace depthscope::platform::kms {

class Card;

/// Lays the overlay over captured pictures on the graphics processor, in buffers that the card
/// scans out. All its functions from one thread.
class GpuComposer {
 public:
  static constexpr int buffer_count = 3;

  virtual ~GpuComposer() = default;
  /// Whether pictures like this one can be composed, one to one.
  virtual bool takes(const capture::Frame& frame) const = 0;
  /// Draws a picture, centred on black, and the layer over it. 0 or -errno. `done` becomes readable
  /// when the processor has finished; where it is not valid, it has.
  virtual int draw(int buffer, const capture::Frame& frame, const LayerView& layer,
                   kernel::OwnedFd& done) = 0;
  /// The card's name of a buffer.
  virtual std::uint32_t framebuffer(int buffer) const = 0;
};

/// Makes one for a screen of this size. 0 or -errno; -ENOTSUP: the card has no driver for it. The
/// card outlives the composer.
using GpuComposerMaker = int (*)(Card& card, int width, int height,
                                 std::unique_ptr<GpuComposer>& composer);

/// By GBM, EGL and OpenGL ES 3.
int makeGbmComposer(Card& card, int width, int height, std::unique_ptr<GpuComposer>& composer);

}  // namespace depthscope::platform::kms
