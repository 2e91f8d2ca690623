#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/fake_kernel/fake_file.hpp"
#include "tests/fake_kernel/fault_plan.hpp"

namespace depthscope::fake {

/// A kernel in memory: devices under paths, a table of descriptors, mappings, and a clock that
/// moves only when a call takes its time. Fails calls on demand, and knows what was not given back.
/// From one thread.
class FakeKernel final : public kernel::SystemCalls {
 public:
  /// Puts a device, which outlives the kernel, under an absolute path. A path that is taken is
  /// replaced; files that are open stay so.
  void plug(const std::string& path, FakeDevice& device) { devices_[path] = &device; }
  void unplug(const std::string& path) { devices_.erase(path); }
  void link(const std::string& path, const std::string& target) { links_[path] = target; }

  /// Gives a file a descriptor, for drivers that hand descriptors out (DMABUF export, GPIO lines).
  int install(std::unique_ptr<FakeFile> file);
  /// The file behind a descriptor, or null.
  FakeFile* file(int fd) const;

  void inject(const FaultPlan& plan) { plan_ = plan; }
  /// Calls made so far that the plan's path concerns; clock readings are not counted.
  std::uint64_t calls() const { return calls_; }
  std::size_t openDescriptors() const { return files_.size(); }
  std::size_t mappings() const { return mappings_.size(); }
  /// Calls that named a descriptor or a mapping that was not open.
  std::uint64_t misuses() const { return misuses_; }

  void advance(std::chrono::nanoseconds time) { now_ += time; }

  int open(const char* path, int flags) override;
  int close(int fd) override;
  int ioctl(int fd, unsigned long request, void* argument) override;
  void* mmap(int fd, std::size_t length, bool writable, off_t offset, int& error) override;
  int munmap(void* address, std::size_t length) override;
  ssize_t read(int fd, std::span<std::byte> into) override;
  ssize_t write(int fd, std::span<const std::byte> from) override;
  int poll(std::span<pollfd> descriptors, std::chrono::nanoseconds timeout) override;
  /// Devices go on meanwhile: one of them may ring.
  int waitForRing(const kernel::Bell& bell, std::uint32_t rings,
                  std::chrono::nanoseconds timeout) override;
  int list(const char* directory, std::vector<std::string>& names) override;
  int readLink(const char* path, std::string& target) override;
  Time now() override { return now_; }

 private:
  /// Every call but close and munmap, which cannot be made to fail (their callers could do nothing
  /// about it), begins here: counts it, takes a microsecond, and gives -errno if it is to fail.
  int enter(const std::string& path);
  int enter(int fd) { return enter(pathOf(fd)); }
  std::string pathOf(int fd) const;
  bool shortCall() const {
    return counted_ && plan_.kind == FaultPlan::Kind::Short && plan_.hits(calls_);
  }
  FakeFile* required(int fd);
  int readyDescriptors(std::span<pollfd> descriptors);
  Time nextEvent(std::span<const pollfd> descriptors, Time limit) const;

  std::map<std::string, FakeDevice*> devices_;
  std::map<std::string, std::string> links_;
  std::map<int, std::unique_ptr<FakeFile>> files_;
  std::map<int, std::string> opened_at_;
  struct Mapped {
    std::shared_ptr<std::byte[]> memory;
    std::size_t length;
  };
  std::multimap<void*, Mapped> mappings_;
  FaultPlan plan_;
  std::uint64_t calls_ = 0, misuses_ = 0;
  bool counted_ = false;  // the call under way is one that the plan concerns
  int next_fd_ = 1000;
  Time now_{std::chrono::seconds(1000)};
};

}  // namespace depthscope::fake
