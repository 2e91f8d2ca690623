#pragma once
#include <vector>

#include "kernel/mapping.hpp"
#include "kernel/owned_fd.hpp"
#include "platform/display/display.hpp"
#include "platform/display/picture_copy.hpp"

namespace depthscope::platform::fbdev {

/// A Linux framebuffer, for boards whose display has no DRM driver. It has one mode, the one it is
/// in: the picture is centred in it. Where the driver has room for two screens, pictures are drawn
/// into the one that is not shown and panned to; else they are drawn where they are seen, which may
/// tear.
///
/// What was on the screen is put back when the display ends.
class FbdevDisplay final : public Display {
 public:
  /// The device is opened with the first picture.
  FbdevDisplay(const DisplaySettings& settings, kernel::SystemCalls& calls);
  ~FbdevDisplay() override;

  std::span<std::uint8_t> acquire(int width, int height) override;
  void present(std::int64_t index) override;
  DisplayState state() const override { return state_; }
  DisplayMode mode() const override;

 private:
  using Time = kernel::SystemCalls::Time;

  /// What the device is set to.
  struct Screen {
    int width = 0, height = 0, stride = 0;
    PixelLayout layout = PixelLayout::Bgrx32;
    bool operator==(const Screen&) const = default;
  };

  int open();
  int readScreen(Screen& screen);
  void askForTwoScreens();
  void watch(Time now);
  std::span<std::uint8_t> page(int index) const;
  int pan(int page);
  void fail(int error);
  void close();
  void report(DisplayState state, int error);

  std::string device_;
  kernel::SystemCalls& calls_;
  kernel::OwnedFd fd_;
  kernel::Mapping mapping_;
  Screen screen_;
  int pages_ = 1, shown_page_ = 0;
  bool open_ = false;
  std::vector<std::uint8_t> before_;  // what was on the screen
  std::vector<std::uint8_t> memory_;  // of the picture that is made
  PictureCopier copier_;
  int picture_width_ = 0, picture_height_ = 0;
  int drawn_width_ = 0, drawn_height_ = 0;  // size that the black around is made for
  int strikes_ = 0;
  DisplayState state_ = DisplayState::Starting;
  int reported_error_ = 0;
  Time next_try_{}, next_watch_{};
};

}  // namespace depthscope::platform::fbdev
