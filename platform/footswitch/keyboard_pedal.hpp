#pragma once
#include "kernel/owned_fd.hpp"
#include "platform/footswitch/pedal.hpp"

namespace depthscope::platform {

/// A USB pedal that is a keyboard to the kernel (evdev). It is grabbed, so that nobody else sees
/// its keys: on the console they would be typed.
class KeyboardPedal final : public Pedal {
 public:
  /// `device`: path under /dev/input, or the device's name. `key`: code of
  /// linux/input-event-codes.h; 0: any key. `calls` outlives the pedal.
  KeyboardPedal(kernel::SystemCalls& calls, std::string device, int key);

  int fd() const override { return device_.get(); }
  int service(Time now, short events) override;
  std::optional<Time> wakeAt() const override;
  int error() const override { return error_; }
  std::uint64_t lost() const override { return lost_; }
  std::string name() const override { return "keyboard " + wanted_; }

 private:
  void open(Time now);
  int openPath(const std::string& path, kernel::OwnedFd& device);
  int openByName(kernel::OwnedFd& device);
  void close(int error, Time now);
  int read(Time now);
  bool anyKeyDown();

  kernel::SystemCalls& calls_;
  std::string wanted_;
  int key_;
  kernel::OwnedFd device_;
  bool down_ = false;
  bool resync_ = false;  // events were lost: until the next report ends, none counts
  int error_ = -ENOENT;
  std::uint64_t lost_ = 0;
  Time next_try_{};
};

/// An input device as it is listed.
struct InputDevice {
  std::string path, name;
};

/// The machine's input devices that have keys and may be opened.
std::vector<InputDevice> listKeyboards(kernel::SystemCalls& calls);

}  // namespace depthscope::platform
