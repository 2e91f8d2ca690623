#include "tests/fake_kernel/fake_kernel.hpp"

#include <algorithm>

namespace depthscope::fake {
namespace {

constexpr std::chrono::microseconds call_time(1);

}  // namespace

int FakeKernel::enter(const std::string& path) {
  now_ += call_time;
  counted_ = path.starts_with(plan_.under);
  if (!counted_) return 0;
  ++calls_;
  if (!plan_.hits(calls_)) return 0;
  if (plan_.kind == FaultPlan::Kind::Late) now_ += plan_.delay;
  return plan_.kind == FaultPlan::Kind::Error ? -plan_.error : 0;
}

std::string FakeKernel::pathOf(int fd) const {
  const auto found = opened_at_.find(fd);
  return found == opened_at_.end() ? "" : found->second;
}

int FakeKernel::install(std::unique_ptr<FakeFile> file) {
  files_[next_fd_] = std::move(file);
  return next_fd_++;
}

FakeFile* FakeKernel::file(int fd) const {
  const auto found = files_.find(fd);
  return found == files_.end() ? nullptr : found->second.get();
}

FakeFile* FakeKernel::required(int fd) {
  FakeFile* open_file = file(fd);
  if (open_file == nullptr) ++misuses_;
  return open_file;
}

int FakeKernel::open(const char* path, int flags) {
  if (const int error = enter(path)) return error;
  std::string target = path;
  for (int hops = 0; links_.contains(target); ++hops) {
    if (hops == 8) return -ELOOP;
    target = links_[target];
  }
  const auto device = devices_.find(target);
  if (device == devices_.end()) return -ENOENT;
  std::unique_ptr<FakeFile> opened;
  if (const int error = device->second->open(flags, opened)) return error;
  const int fd = install(std::move(opened));
  opened_at_[fd] = path;
  return fd;
}

int FakeKernel::close(int fd) {
  opened_at_.erase(fd);
  if (files_.erase(fd) == 1) return 0;
  ++misuses_;
  return -EBADF;
}

int FakeKernel::ioctl(int fd, unsigned long request, void* argument) {
  if (const int error = enter(fd)) return error;
  FakeFile* target = required(fd);
  return target == nullptr ? -EBADF : target->ioctl(request, argument);
}

void* FakeKernel::mmap(int fd, std::size_t length, bool /*writable*/, off_t offset, int& error) {
  error = enter(fd);
  if (error != 0) return nullptr;
  FakeFile* target = required(fd);
  if (target == nullptr) {
    error = -EBADF;
    return nullptr;
  }
  auto memory = target->map(length, offset, error);
  if (memory == nullptr) return nullptr;
  void* address = memory.get();
  mappings_.insert({address, {std::move(memory), length}});
  return address;
}

int FakeKernel::munmap(void* address, std::size_t length) {
  const auto found = mappings_.find(address);
  if (found == mappings_.end() || found->second.length != length) {
    ++misuses_;
    return -EINVAL;
  }
  mappings_.erase(found);
  return 0;
}

ssize_t FakeKernel::read(int fd, std::span<std::byte> into) {
  if (const int error = enter(fd)) return error;
  FakeFile* target = required(fd);
  if (target == nullptr) return -EBADF;
  return target->read(shortCall() ? into.first(into.size() / 2) : into);
}

ssize_t FakeKernel::write(int fd, std::span<const std::byte> from) {
  if (const int error = enter(fd)) return error;
  FakeFile* target = required(fd);
  if (target == nullptr) return -EBADF;
  return target->write(shortCall() ? from.first(from.size() / 2) : from);
}

int FakeKernel::readyDescriptors(std::span<pollfd> descriptors) {
  int ready = 0;
  for (pollfd& entry : descriptors) {
    entry.revents = 0;
    if (entry.fd < 0) continue;
    FakeFile* target = required(entry.fd);
    const short wanted = static_cast<short>(entry.events | POLLERR | POLLHUP);
    entry.revents = target == nullptr ? POLLNVAL : static_cast<short>(target->events() & wanted);
    if (entry.revents != 0) ++ready;
  }
  return ready;
}

Time FakeKernel::nextEvent(std::span<const pollfd> descriptors, Time limit) const {
  Time next = limit;
  for (const pollfd& entry : descriptors)
    if (FakeFile* target = file(entry.fd))
      if (const auto at = target->nextEvent()) next = std::min(next, *at);
  return std::max(next, now_);
}

int FakeKernel::poll(std::span<pollfd> descriptors, std::chrono::nanoseconds timeout) {
  if (const int error = enter(descriptors.empty() ? -1 : descriptors[0].fd)) return error;
  const Time limit = now_ + std::max(timeout, std::chrono::nanoseconds::zero());
  for (;;) {
    const int ready = readyDescriptors(descriptors);
    if (ready > 0 || now_ >= limit) return ready;
    // A moment that has come without an event of interest must not stop the clock.
    now_ = std::max(nextEvent(descriptors, limit), std::min(limit, now_ + call_time));
  }
}

int FakeKernel::waitForRing(const kernel::Bell& bell, std::uint32_t rings,
                            std::chrono::nanoseconds timeout) {
  if (const int error = enter("")) return error;
  const Time limit = now_ + std::max(timeout, std::chrono::nanoseconds::zero());
  std::vector<pollfd> everything;
  for (const auto& [fd, file] : files_) everything.push_back({fd, 0, 0});
  for (;;) {
    readyDescriptors(everything);
    if (bell.rings() != rings) return 0;
    if (now_ >= limit) return -ETIMEDOUT;
    now_ = std::max(nextEvent(everything, limit), std::min(limit, now_ + call_time));
  }
}

int FakeKernel::list(const char* directory, std::vector<std::string>& names) {
  names.clear();
  if (const int error = enter(directory)) return error;
  const std::string prefix = std::string(directory) + "/";
  const auto add = [&](const std::string& path) {
    if (path.starts_with(prefix))
      names.push_back(path.substr(prefix.size(), path.find('/', prefix.size()) - prefix.size()));
  };
  for (const auto& [path, device] : devices_) add(path);
  for (const auto& [path, target] : links_) add(path);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names.empty() ? -ENOENT : 0;
}

int FakeKernel::readLink(const char* path, std::string& target) {
  if (const int error = enter(path)) return error;
  const auto found = links_.find(path);
  if (found == links_.end()) return devices_.contains(path) ? -EINVAL : -ENOENT;
  target = found->second;
  return 0;
}

}  // namespace depthscope::fake
