#include "platform/daemon/ar_supervisor.hpp"

#include <fcntl.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "platform/daemon/settings_file.hpp"
#include "platform/log.hpp"

namespace depthscope::platform {
namespace {

// Where the AR process finds what it is handed; ours are kept clear of these numbers.
constexpr int child_memory_fd = 3, child_commands_fd = 4, child_settings_fd = 5;
constexpr int first_own_fd = 16;

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(s));
}

UniqueFd copyAbove(int fd) {
  UniqueFd copy(::fcntl(fd, F_DUPFD_CLOEXEC, first_own_fd));
  if (!copy.valid())
    throw std::system_error(errno, std::generic_category(), "descriptor cannot be copied");
  return copy;
}

}  // namespace

ArSupervisor::ArSupervisor(std::vector<std::string> command, const SharedMemory& memory,
                           const Settings& settings)
    : command_(std::move(command)),
      memory_(memory),
      settings_file_(makeSettingsFile(settings)),
      heartbeat_timeout_(seconds(settings.daemon.heartbeat_timeout_s)),
      nice_(settings.daemon.ar_nice),
      memory_bytes_(static_cast<std::uint64_t>(settings.daemon.ar_memory_mb) << 20),
      policy_(seconds(settings.daemon.restart_min_s), seconds(settings.daemon.restart_max_s)) {
  const auto option = [&](const char* name, int fd) {
    command_.insert(command_.end(), {name, std::to_string(fd)});
  };
  option("--shared-memory", child_memory_fd);
  option("--commands", child_commands_fd);
  command_.insert(command_.end(),
                  {"--config", "/proc/self/fd/" + std::to_string(child_settings_fd)});
}

void ArSupervisor::configure(const Settings& settings) {
  settings_file_ = makeSettingsFile(settings);
}

void ArSupervisor::tick(Clock::time_point now) {
  int status = 0;
  if (child_.ended(status))
    handleEnd(std::exchange(silenced_, false) ? "silent for too long" : describeEnd(status), now);
  if (child_.running())
    watchHeartbeat(now);
  else if (now >= next_start_)
    start(now);
}

void ArSupervisor::start(Clock::time_point now) {
  try {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0)
      throw std::system_error(errno, std::generic_category(), "socketpair");
    commands_ = UniqueFd(pair[0]);
    const UniqueFd theirs(pair[1]);
    const UniqueFd memory = copyAbove(memory_.fd()), commands = copyAbove(theirs.get()),
                   settings = copyAbove(settings_file_.get());
    const std::array<std::pair<int, int>, 3> descriptors{{{memory.get(), child_memory_fd},
                                                          {commands.get(), child_commands_fd},
                                                          {settings.get(), child_settings_fd}}};
    // What a predecessor left is of another map.
    PoseEstimate nothing_yet;
    nothing_yet.frame = 0;
    memory_.block().pose.write(encodePose(nothing_yet));
    memory_.block().labels.write(WireLabels{});
    policy_.started(now);
    child_ = ChildProcess(command_, descriptors);
    if (!child_.restrict(nice_, memory_bytes_))
      log(LogPriority::Warning, "AR process runs without its limits", {{"pid", child_.pid()}});
    last_beat_ = now;
    ++starts_;
    log(LogPriority::Info, "AR process started", {{"pid", child_.pid()}, {"restarts", restarts()}});
  } catch (const std::exception& error) {
    handleEnd(error.what(), now);
  }
}

void ArSupervisor::handleEnd(const std::string& how, Clock::time_point now) {
  next_start_ = policy_.ended(now);
  commands_.reset();
  log(LogPriority::Warning, "AR process ended, the picture goes on",
      {{"how", how}, {"restart_in_s", std::chrono::duration<double>(next_start_ - now).count()}});
}

void ArSupervisor::watchHeartbeat(Clock::time_point now) {
  WireArStatus status;
  if (memory_.block().status.read(status) && status.beats != beats_) {
    beats_ = status.beats;
    last_beat_ = now;
  }
  if (silenced_ || now - last_beat_ < heartbeat_timeout_) return;
  silenced_ = true;
  child_.signalKill();
}

bool ArSupervisor::send(const WireCommand& command) {
  const bool sent = child_.running() &&
                    ::send(commands_.get(), &command, sizeof command,
                           MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(sizeof command);
  if (sent) memory_.block().new_frame.ring();
  return sent;
}

}  // namespace depthscope::platform
