#pragma once
#include <memory>
#include <optional>

#include "platform/display/dma_picture.hpp"
#include "platform/display/kms/dumb_buffer.hpp"
#include "platform/display/kms/pipeline.hpp"
#include "platform/display/picture_copy.hpp"

namespace depthscope::platform::kms {

/// Captured pictures and overlay on a hardware plane each: no processor and no GPU in the picture's
/// path. Which planes, the driver decides: each pair that could do is put to it by TEST_ONLY.
class PlaneRoute {
 public:
  static constexpr int buffer_count = 3;  // of the layer, in turn as the output's

  /// A route for pictures like this one, centred at (x, y) on the screen. 0 or -errno; -ENOTSUP: no
  /// pair of planes does it. `framebuffer`: the picture's. The card outlives the route.
  static int find(Card& card, const Pipeline& pipeline, const DmaPicture& picture,
                  std::uint32_t framebuffer, int x, int y, std::unique_ptr<PlaneRoute>& route);

  const DmaPicture& kind() const { return kind_; }
  /// Writes an overlay into a buffer; only what changed since the buffer was last used is touched.
  void draw(int buffer, const LayerView& layer);
  /// Adds everything that shows a picture and the layer in a buffer.
  void show(AtomicRequest& request, std::uint32_t framebuffer, int buffer) const;
  /// Adds what takes the route's planes off the screen, but for the primary plane.
  void hide(AtomicRequest& request) const;

 private:
  struct Layer {
    DumbBuffer memory;
    overlay::PixelRect drawn;
  };

  int createLayers(Card& card, const PlaneUnit& plane);
  void addColors(AtomicRequest& request) const;

  DmaPicture kind_;  // format, size and colours count, not the descriptors
  std::uint32_t crtc_ = 0, primary_ = 0;
  int x_ = 0, y_ = 0;
  PlaneUnit video_, overlay_;
  PixelLayout layout_ = PixelLayout::Bgrx32;
  std::array<Layer, buffer_count> layers_;
};

}  // namespace depthscope::platform::kms
