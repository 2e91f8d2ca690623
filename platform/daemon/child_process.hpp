#pragma once
#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace depthscope::platform {

/// A running child process, killed and reaped at the latest by the destructor.
class ChildProcess {
 public:
  ChildProcess() = default;
  /// Starts `arguments[0]` with the given descriptors at the given numbers, signals at their
  /// defaults. Throws std::system_error.
  ChildProcess(const std::vector<std::string>& arguments,
               std::span<const std::pair<int, int>> descriptors);
  ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess() { kill(); }

  /// What the child may take of the machine. `nice`: its CPU priority, nice(2). `memory_bytes`:
  /// private memory, beyond which its allocations fail; 0: no limit. When the whole machine runs
  /// out, the child goes first. False when the system did not allow one of them.
  bool restrict(int nice, std::uint64_t memory_bytes) const;

  bool running() const { return pid_ > 0; }
  pid_t pid() const { return pid_; }
  /// Reaps the child if it ended: true once, and `status` as waitpid(2) gives it.
  bool ended(int& status);
  /// SIGKILL; ended() tells when it has taken effect. A process that hangs in a driver may take its
  /// time to die, and nobody is to wait for that.
  void signalKill() const;
  /// SIGKILL and wait, for a few seconds at most: what has not ended by then is left behind.
  void kill();

 private:
  pid_t pid_ = -1;
};

/// "exit status 1", "signal 9".
std::string describeEnd(int wait_status);

}  // namespace depthscope::platform
