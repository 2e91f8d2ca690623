#include "platform/footswitch/keyboard_pedal.hpp"

#include <fcntl.h>
#include <linux/input.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace depthscope::platform {
namespace {

constexpr auto retry_interval = std::chrono::milliseconds(300);
constexpr const char* input_folder = "/dev/input";
constexpr int reads_a_turn = 8;

using KeyBits = std::array<std::uint8_t, KEY_MAX / 8 + 1>;

bool bit(const KeyBits& bits, int i) {
  return (bits[static_cast<std::size_t>(i / 8)] >> (i % 8) & 1) != 0;
}

int openDevice(kernel::SystemCalls& calls, const std::string& path, kernel::OwnedFd& device) {
  device = kernel::OwnedFd(calls, kernel::retryInterrupted([&] {
                             return calls.open(path.c_str(), O_RDONLY | O_NONBLOCK);
                           }));
  return device.valid() ? 0 : device.get();
}

std::string deviceName(kernel::SystemCalls& calls, int fd) {
  std::array<char, 256> name{};
  if (calls.ioctl(fd, EVIOCGNAME(sizeof name - 1), name.data()) < 0) return {};
  return name.data();
}

std::vector<std::string> devicePaths(kernel::SystemCalls& calls) {
  std::vector<std::string> names, paths;
  calls.list(input_folder, names);
  for (const std::string& name : names)
    if (name.starts_with("event")) paths.push_back(std::string(input_folder) + "/" + name);
  return paths;
}

}  // namespace

KeyboardPedal::KeyboardPedal(kernel::SystemCalls& calls, std::string device, int key)
    : calls_(calls), wanted_(std::move(device)), key_(key) {}

int KeyboardPedal::service(Time now, short) {
  if (!device_.valid() && now >= next_try_) open(now);
  return device_.valid() ? read(now) : 0;
}

void KeyboardPedal::open(Time now) {
  next_try_ = now + retry_interval;
  kernel::OwnedFd device;
  error_ = wanted_.starts_with('/') ? openDevice(calls_, wanted_, device) : openByName(device);
  // The argument of EVIOCGRAB is the number itself.
  if (error_ == 0)
    error_ = kernel::retryInterrupted(
        [&] { return calls_.ioctl(device.get(), EVIOCGRAB, reinterpret_cast<void*>(1)); });
  if (error_ != 0) return;
  device_ = std::move(device);
  resync_ = false;
  down_ = anyKeyDown();  // a pedal that is held down while it is found was not pressed for us
}

int KeyboardPedal::openByName(kernel::OwnedFd& device) {
  int result = -ENOENT;
  for (const std::string& path : devicePaths(calls_)) {
    kernel::OwnedFd candidate;
    if (const int error = openDevice(calls_, path, candidate)) {
      result = error;
      continue;
    }
    if (deviceName(calls_, candidate.get()) != wanted_) continue;
    device = std::move(candidate);
    return 0;
  }
  return result;
}

void KeyboardPedal::close(int error, Time now) {
  device_.reset();
  error_ = error;
  next_try_ = now + retry_interval;
}

bool KeyboardPedal::anyKeyDown() {
  KeyBits bits{};
  if (calls_.ioctl(device_.get(), EVIOCGKEY(sizeof bits), bits.data()) < 0) return down_;
  if (key_ != 0) return bit(bits, key_);
  return std::any_of(bits.begin(), bits.end(), [](std::uint8_t b) { return b != 0; });
}

int KeyboardPedal::read(Time now) {
  int presses = 0;
  for (int turn = 0; turn < reads_a_turn; ++turn) {
    std::array<input_event, 32> events;
    const ssize_t got = kernel::retryInterrupted(
        [&] { return calls_.read(device_.get(), std::as_writable_bytes(std::span(events))); });
    if (got == -EAGAIN || got == -EINTR) return presses;
    if (got <= 0) return close(got == 0 ? -ENODEV : static_cast<int>(got), now), presses;
    for (std::size_t i = 0; i < static_cast<std::size_t>(got) / sizeof(input_event); ++i) {
      const input_event& e = events[i];
      if (e.type == EV_SYN && e.code == SYN_DROPPED) {
        ++lost_;
        resync_ = true;
      } else if (e.type == EV_SYN && e.code == SYN_REPORT && resync_) {
        // What was dropped is gone, but what holds now can be asked.
        resync_ = false;
        const bool was_down = std::exchange(down_, anyKeyDown());
        if (down_ && !was_down) ++presses;
      } else if (e.type == EV_KEY && !resync_ && (key_ == 0 || e.code == key_) && e.value != 2) {
        if (e.value == 1 && !down_) ++presses;
        down_ = e.value == 1;
      }
    }
  }
  return presses;
}

std::optional<Pedal::Time> KeyboardPedal::wakeAt() const {
  return device_.valid() ? std::nullopt : std::optional(next_try_);
}

std::vector<InputDevice> listKeyboards(kernel::SystemCalls& calls) {
  std::vector<InputDevice> found;
  for (const std::string& path : devicePaths(calls)) {
    kernel::OwnedFd device;
    KeyBits keys{};
    if (openDevice(calls, path, device) != 0 ||
        calls.ioctl(device.get(), EVIOCGBIT(EV_KEY, sizeof keys), keys.data()) < 0)
      continue;
    // Keys below the first button are those of keyboards; mice and lids have none.
    const auto first_button = keys.begin() + BTN_MISC / 8;
    if (std::any_of(keys.begin(), first_button, [](std::uint8_t b) { return b != 0; }))
      found.push_back({path, deviceName(calls, device.get())});
  }
  return found;
}

}  // namespace depthscope::platform
