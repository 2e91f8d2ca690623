#include "platform/daemon/child_process.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <system_error>
#include <thread>

extern char** environ;

namespace depthscope::platform {
namespace {

constexpr std::chrono::milliseconds kill_patience{3000}, kill_poll{1};

void check(int code, const char* what) {
  if (code != 0) throw std::system_error(code, std::generic_category(), what);
}

/// posix_spawn's two option objects, freed with the scope.
struct SpawnOptions {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  SpawnOptions() {
    check(posix_spawn_file_actions_init(&files), "posix_spawn");
    check(posix_spawnattr_init(&attributes), "posix_spawn");
  }
  ~SpawnOptions() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnOptions(const SpawnOptions&) = delete;
  SpawnOptions& operator=(const SpawnOptions&) = delete;
};

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments,
                           std::span<const std::pair<int, int>> descriptors) {
  SpawnOptions options;
  for (const auto& [ours, theirs] : descriptors)
    check(posix_spawn_file_actions_adddup2(&options.files, ours, theirs), "posix_spawn");
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  check(posix_spawnattr_setsigmask(&options.attributes, &none), "posix_spawn");
  check(posix_spawnattr_setsigdefault(&options.attributes, &all), "posix_spawn");
  check(
      posix_spawnattr_setflags(&options.attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF),
      "posix_spawn");
  std::vector<char*> words;
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  check(posix_spawn(&pid_, words[0], &options.files, &options.attributes, words.data(), environ),
        arguments[0].c_str());
}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    kill();
    pid_ = std::exchange(other.pid_, -1);
  }
  return *this;
}

bool ChildProcess::restrict(int nice, std::uint64_t memory_bytes) const {
  if (pid_ <= 0) return false;
  bool done = ::setpriority(PRIO_PROCESS, static_cast<id_t>(pid_), nice) == 0;
  if (memory_bytes > 0) {
    const rlimit limit{memory_bytes, memory_bytes};
    done &= ::prlimit(pid_, RLIMIT_DATA, &limit, nullptr) == 0;
  }
  const std::string path = "/proc/" + std::to_string(pid_) + "/oom_score_adj";
  std::ofstream score(path);
  score << 900 << std::flush;
  return done && score.good();
}

bool ChildProcess::ended(int& status) {
  if (pid_ <= 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return false;
  pid_ = -1;
  return true;
}

void ChildProcess::signalKill() const {
  if (pid_ > 0) ::kill(pid_, SIGKILL);
}

void ChildProcess::kill() {
  signalKill();
  int status = 0;
  for (auto left = kill_patience; running() && !ended(status) && left.count() > 0;
       left -= kill_poll)
    std::this_thread::sleep_for(kill_poll);
  pid_ = -1;
}

std::string describeEnd(int status) {
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return "exit status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace depthscope::platform
