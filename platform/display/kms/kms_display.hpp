#pragma once
#include <vector>

#include "platform/display/display.hpp"
#include "platform/display/kms/output.hpp"
#include "platform/display/kms/shown_pictures.hpp"

namespace depthscope::platform::kms {

/// A monitor on a DRM card, by atomic modesetting. Nothing waits for the monitor but present(), and
/// that for less than a picture's time. Whatever goes wrong, the card is tried again a few times a
/// second: a monitor that is plugged in, another one, or a card that comes back is lit by itself.
///
/// The monitor is never switched off. When the display ends, the CRTC gets back what it showed
/// before; when the process dies instead, the kernel does that as it closes the card (the console
/// comes back with the last user of the card). The terminal is left in text mode throughout: a
/// process that dies must leave nothing behind that only it could undo.
class KmsDisplay final : public Display {
 public:
  /// Throws InputError when display.mode cannot be read. The card is opened with the first picture.
  /// `fps`: of the pictures to come; 0: unknown. `make_gpu`: for display.route = "gpu".
  KmsDisplay(const DisplaySettings& settings, kernel::SystemCalls& calls, double fps,
             GpuComposerMaker make_gpu = makeGbmComposer);
  ~KmsDisplay() override;

  std::span<std::uint8_t> acquire(int width, int height) override;
  void present(std::int64_t index) override;
  bool takesFrame(const capture::Frame& frame) const override;
  const capture::Frame* presentFrame(capture::Frame& frame, const LayerView& layer,
                                     std::int64_t index) override;
  DisplayState state() const override { return state_; }
  DisplayMode mode() const override;
  std::optional<ShownPicture> takeShown() override;

 private:
  using Time = kernel::SystemCalls::Time;

  /// A picture that was handed to the driver and is not on screen yet.
  struct Flip {
    Output::Shot shot;
    bool retired;  // of the output before
    std::uint64_t serial;
    std::int64_t index;
    Time submitted, overdue;
  };
  /// A picture that is drawn and could not be handed to the driver yet.
  struct Waiting {
    Output::Shot shot;
    std::int64_t index;
  };

  bool start(Time now);
  int openCard();
  int openOneCard(const std::string& path);
  int lightOutput();
  bool changeOutput();
  bool monitorMayBeThere();
  void watchMonitor(Time now);

  int makeShot(const capture::Frame& frame, const LayerView& layer, Output::Shot& shot);
  void takeEvents();
  void completeFlip(Time shown);
  void waitForFlip();
  void submit();
  void strike(int error);
  void noteRoute(bool direct);
  int freeOf(int Output::Shot::*number) const;

  void fail(int error);
  void dropOutput();
  void dropCard();
  void restoreConsole();
  void report(DisplayState state, int error);

  DisplaySettings settings_;
  ModeRequest mode_request_;
  GpuComposerMaker make_gpu_;
  kernel::SystemCalls& calls_;
  double fps_;

  // A card stays at its place while buffers refer to it.
  std::unique_ptr<Card> card_;
  Connector connector_;
  std::optional<drm_mode_crtc> console_;  // what the CRTC showed before us
  std::unique_ptr<Output> output_;
  std::unique_ptr<Output>
      retired_;          // the one before: on screen until the new one's first picture is
  bool lit_ = false;     // the mode was set
  bool direct_ = false;  // the last picture was not composed by the processor

  PictureRate picture_;
  std::vector<std::uint8_t> memory_;  // of the picture that is made
  PictureCopier copier_;

  Output::Shot front_;          // on screen
  Output::Shot retired_front_;  // of the output before
  std::optional<Flip> flip_;
  std::optional<Waiting> waiting_;
  capture::Frame refused_frame_;  // that the planes would not take, to be given back at once
  std::uint64_t serial_ = 0;
  int strikes_ = 0;  // commits and flips that failed one after the other

  DisplayState state_ = DisplayState::Starting;
  int reported_error_ = 0;
  Time next_try_{}, next_watch_{};
  std::string status_path_;  // of the connector in sysfs

  ShownPictures shown_;
};

}  // namespace depthscope::platform::kms
