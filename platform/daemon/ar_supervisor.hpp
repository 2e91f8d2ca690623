#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "platform/config/settings.hpp"
#include "platform/daemon/child_process.hpp"
#include "platform/daemon/restart_policy.hpp"
#include "platform/ipc/shared_memory.hpp"

namespace depthscope::platform {

/// Starts the AR process, starts it again when it ends or falls silent, and passes commands to it.
/// Used from the service's thread.
class ArSupervisor {
 public:
  using Clock = RestartPolicy::Clock;

  /// Program and arguments of the AR process. The memory outlives the supervisor.
  ArSupervisor(std::vector<std::string> command, const SharedMemory& memory,
               const Settings& settings);

  /// What AR processes started from now on are configured with. Throws std::system_error.
  void configure(const Settings& settings);

  /// To be called often: starts, reaps, kills what is silent for too long.
  void tick(Clock::time_point now);
  bool alive() const { return child_.running(); }
  pid_t pid() const { return child_.pid(); }
  int restarts() const { return starts_ > 0 ? starts_ - 1 : 0; }
  /// False when there is no AR process to take it.
  bool send(const WireCommand& command);

 private:
  void start(Clock::time_point now);
  void handleEnd(const std::string& how, Clock::time_point now);
  void watchHeartbeat(Clock::time_point now);

  std::vector<std::string> command_;
  const SharedMemory& memory_;
  UniqueFd settings_file_;
  std::chrono::nanoseconds heartbeat_timeout_;
  int nice_;
  std::uint64_t memory_bytes_;
  RestartPolicy policy_;
  ChildProcess child_;
  UniqueFd commands_;
  Clock::time_point next_start_{}, last_beat_{};
  std::uint64_t beats_ = 0;
  bool silenced_ = false;  // the child was killed for its silence and has yet to end
  int starts_ = 0;
};

}  // namespace depthscope::platform
