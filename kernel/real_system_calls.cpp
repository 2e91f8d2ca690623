#include <dirent.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <ctime>

#include "kernel/system_calls.hpp"

namespace depthscope::kernel {
namespace {

template <typename Result>
Result orError(Result result) {
  return result < 0 ? static_cast<Result>(-errno) : result;
}

timespec toTimespec(std::chrono::nanoseconds timeout) {
  const auto wait = std::max(timeout, std::chrono::nanoseconds::zero());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(wait);
  return {static_cast<time_t>(seconds.count()), static_cast<long>((wait - seconds).count())};
}

class RealSystemCalls final : public SystemCalls {
 public:
  int open(const char* path, int flags) override {
    return orError(::open(path, flags | O_CLOEXEC));
  }
  int close(int fd) override { return orError(::close(fd)); }
  int ioctl(int fd, unsigned long request, void* argument) override {
    return orError(::ioctl(fd, request, argument));
  }
  void* mmap(int fd, std::size_t length, bool writable, off_t offset, int& error) override {
    const int protection = writable ? PROT_READ | PROT_WRITE : PROT_READ;
    void* address = ::mmap(nullptr, length, protection, MAP_SHARED, fd, offset);
    if (address != MAP_FAILED) return address;
    error = -errno;
    return nullptr;
  }
  int munmap(void* address, std::size_t length) override {
    return orError(::munmap(address, length));
  }
  ssize_t read(int fd, std::span<std::byte> into) override {
    return orError(::read(fd, into.data(), into.size()));
  }
  ssize_t write(int fd, std::span<const std::byte> from) override {
    return orError(::write(fd, from.data(), from.size()));
  }
  int poll(std::span<pollfd> descriptors, std::chrono::nanoseconds timeout) override {
    const timespec limit = toTimespec(timeout);
    return orError(::ppoll(descriptors.data(), descriptors.size(), &limit, nullptr));
  }
  int waitForRing(const Bell& bell, std::uint32_t rings,
                  std::chrono::nanoseconds timeout) override {
    const timespec limit = toTimespec(timeout);
    const auto result =
        orError(::syscall(SYS_futex, &bell.word(), FUTEX_WAIT, rings, &limit, nullptr, 0));
    return result == -EAGAIN ? 0 : static_cast<int>(result);  // rung before the wait began
  }
  int list(const char* directory, std::vector<std::string>& names) override {
    names.clear();
    DIR* stream = ::opendir(directory);
    if (stream == nullptr) return -errno;
    while (const dirent* entry = ::readdir(stream)) {
      const std::string name = entry->d_name;
      if (name != "." && name != "..") names.push_back(name);
    }
    ::closedir(stream);
    std::sort(names.begin(), names.end());
    return 0;
  }
  int readLink(const char* path, std::string& target) override {
    std::array<char, PATH_MAX> text;
    const ssize_t length = ::readlink(path, text.data(), text.size());
    if (length < 0) return -errno;
    target.assign(text.data(), static_cast<std::size_t>(length));
    return 0;
  }
  Time now() override { return Clock::now(); }
};

}  // namespace

SystemCalls& realSystemCalls() {
  static RealSystemCalls calls;
  return calls;
}

}  // namespace depthscope::kernel
