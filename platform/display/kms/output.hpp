#pragma once
#include <array>
#include <optional>

#include "capture/frame.hpp"
#include "platform/display/display.hpp"
#include "platform/display/gpu/gpu_composer.hpp"
#include "platform/display/kms/dumb_buffer.hpp"
#include "platform/display/kms/imported_picture.hpp"
#include "platform/display/kms/mode_choice.hpp"
#include "platform/display/kms/pipeline.hpp"
#include "platform/display/kms/plane_route.hpp"
#include "platform/display/picture_copy.hpp"

namespace depthscope::platform::kms {

/// A mode as a blob of the card.
class ModeBlob {
 public:
  ModeBlob() = default;
  static int create(Card& card, const drm_mode_modeinfo& mode, ModeBlob& blob);
  ModeBlob(ModeBlob&& other) noexcept { *this = std::move(other); }
  ModeBlob& operator=(ModeBlob&& other) noexcept;
  ~ModeBlob();
  std::uint32_t id() const { return id_; }

 private:
  Card* card_ = nullptr;
  std::uint32_t id_ = 0;
};

/// One monitor in one mode, with the buffers that are shown on it in turn: one on screen, one that
/// waits for its vblank, one to write into.
class Output {
 public:
  static constexpr int buffer_count = 3;

  /// What is put on the screen at once: a composed picture in a buffer of ours or of the graphics
  /// processor's, or a captured one with a buffer of its route's layer.
  struct Shot {
    int buffer = -1;  // -1: not composed by the processor
    int gpu = -1;     // -1: not composed by the graphics processor
    int layer = -1;
    kernel::OwnedFd drawn;  // readable when the graphics processor has finished
    ImportedPicture picture;
    capture::Frame frame;  // the picture's memory, kept as long as it is scanned out
  };

  /// Makes the buffers in the first pixel format that the plane takes unchanged from us and proves
  /// the whole by a TEST_ONLY commit. 0 or -errno. The card outlives the output at its place.
  static int create(Card& card, const Pipeline& pipeline, const drm_mode_modeinfo& mode,
                    std::unique_ptr<Output>& output);

  const Connector& connector() const { return pipeline_.connector; }
  const drm_mode_modeinfo& modeInfo() const { return mode_; }
  DisplayMode mode() const;

  /// Writes a picture into a buffer; what the picture does not cover is black.
  void draw(int buffer, const RgbaView& picture, PictureCopier& copier);
  /// Makes a captured picture known to the card and finds planes for it and a layer. 0 or -errno;
  /// what was refused once is refused at once the next time.
  int import(const DmaPicture& picture, ImportedPicture& imported);
  void drawLayer(int buffer, const LayerView& layer) { route_->draw(buffer, layer); }
  /// Has the graphics processor compose a picture into buffer shot.gpu of its own, if it can;
  /// `make` makes what does that. 0 or -errno; after a failure it is not tried again.
  int drawByGpu(const capture::Frame& frame, const LayerView& layer, GpuComposerMaker make,
                Shot& shot);
  /// The card takes no more shots of this kind.
  void refuse(const Shot& shot);

  /// Has it shown from the next vblank on, without waiting; an event with `serial` follows.
  /// `modeset`: lights the monitor in the mode too. 0 or -errno.
  int flip(const Shot& shot, bool modeset, std::uint64_t serial) const;

 private:
  int createBuffers(std::uint32_t fourcc);
  int commit(const Shot& shot, bool modeset, std::uint32_t flags, std::uint64_t serial) const;

  struct Buffer {
    DumbBuffer memory;
    Placement drawn;  // what of it is not black
  };
  Card* card_ = nullptr;
  Pipeline pipeline_;
  drm_mode_modeinfo mode_{};
  ModeBlob blob_;
  PixelLayout layout_ = PixelLayout::Bgrx32;
  std::array<Buffer, buffer_count> buffers_;
  std::unique_ptr<PlaneRoute> route_;
  std::optional<DmaPicture> refused_;  // a kind of picture that no planes take
  std::unique_ptr<GpuComposer> gpu_;
  bool gpu_refused_ = false;
};

}  // namespace depthscope::platform::kms
