#pragma once
#include <linux/input.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <set>

#include "tests/fake_kernel/fake_kernel.hpp"

namespace depthscope::fake {

/// A keyboard of the kernel's input layer (evdev), with one client at a time in mind.
class FakeInputDevice final : public FakeDevice {
 public:
  static constexpr std::size_t queue_room = 64;

  FakeInputDevice(FakeKernel& kernel, std::string path, std::string name)
      : kernel_(kernel), path_(std::move(path)), name_(std::move(name)) {
    kernel_.plug(path_, *this);
  }
  ~FakeInputDevice() override { kernel_.unplug(path_); }

  int open(int, std::unique_ptr<FakeFile>& file) override {
    if (denied) return -EACCES;
    if (!present) return -ENODEV;
    events_.clear();
    file = std::make_unique<File>(*this);
    return 0;
  }
  /// A key goes down (1), comes up (0) or repeats (2).
  void key(int code, int value) {
    if (value == 1) down_.insert(code);
    if (value == 0) down_.erase(code);
    push(EV_KEY, code, value);
    push(EV_SYN, SYN_REPORT, 0);
  }
  /// Keys change while the client's queue overflows.
  void keyUnseen(int code, int value) {
    if (value == 1) down_.insert(code);
    if (value == 0) down_.erase(code);
    events_.clear();
    push(EV_SYN, SYN_DROPPED, 0);
    push(EV_SYN, SYN_REPORT, 0);
  }
  void setPresent(bool here) {
    present = here;
    if (here)
      kernel_.plug(path_, *this);
    else
      kernel_.unplug(path_);
  }
  bool grabbed() const { return grabbed_; }

  bool present = true;
  bool denied = false;            // opening answers EACCES
  bool grabbed_by_other = false;  // EVIOCGRAB answers EBUSY

 private:
  void push(int type, int code, int value) {
    input_event e{};
    e.type = static_cast<std::uint16_t>(type);
    e.code = static_cast<std::uint16_t>(code);
    e.value = value;
    events_.push_back(e);
  }
  static void setBits(void* bytes, const std::set<int>& bits) {
    for (const int b : bits) static_cast<std::uint8_t*>(bytes)[b / 8] |= 1u << b % 8;
  }

  struct File final : FakeFile {
    explicit File(FakeInputDevice& owner) : device(owner) {}
    ~File() override { device.grabbed_ = false; }
    int ioctl(unsigned long request, void* argument) override {
      if (!device.present) return -ENODEV;
      const unsigned size = _IOC_SIZE(request);
      if (request == EVIOCGRAB) {
        if (device.grabbed_by_other) return -EBUSY;
        device.grabbed_ = argument != nullptr;
        return 0;
      }
      if (request == EVIOCGNAME(size)) {
        std::snprintf(static_cast<char*>(argument), size, "%s", device.name_.c_str());
        return static_cast<int>(device.name_.size());
      }
      if (request == EVIOCGKEY(size)) return setBits(argument, device.down_), 0;
      if (request == EVIOCGBIT(EV_KEY, size)) return setBits(argument, {KEY_A, KEY_B}), 0;
      return -EINVAL;
    }
    ssize_t read(std::span<std::byte> into) override {
      if (!device.present) return -ENODEV;
      if (device.events_.empty()) return -EAGAIN;
      std::size_t at = 0;
      while (!device.events_.empty() && at + sizeof(input_event) <= into.size()) {
        std::memcpy(&into[at], &device.events_.front(), sizeof(input_event));
        at += sizeof(input_event);
        device.events_.pop_front();
      }
      return at > 0 ? static_cast<ssize_t>(at) : -EINVAL;
    }
    FakeInputDevice& device;
  };

  FakeKernel& kernel_;
  std::string path_, name_;
  std::deque<input_event> events_;
  std::set<int> down_;
  bool grabbed_ = false;
};

}  // namespace depthscope::fake
