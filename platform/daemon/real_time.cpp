#include "platform/daemon/real_time.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <system_error>

#include "platform/log.hpp"

namespace depthscope::platform {

bool enterRealTime(int priority) {
  const sched_param parameter{.sched_priority = priority};
  const int code =
      pthread_setschedparam(pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &parameter);
  if (code == 0) return true;
  log(LogPriority::Warning, "no real-time priority for the video loop",
      {{"why", std::generic_category().message(code)}, {"needs", "CAP_SYS_NICE or LimitRTPRIO"}});
  return false;
}

bool lockMemory() {
  // Under a limit on locked memory the lock may succeed now and make a later allocation fail: not
  // worth it.
  rlimit limit{RLIM_INFINITY, RLIM_INFINITY};
  if (::setrlimit(RLIMIT_MEMLOCK, &limit) != 0) ::getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur == RLIM_INFINITY && ::mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0)
    return true;
  log(LogPriority::Warning, "memory is not locked",
      {{"needs", "CAP_IPC_LOCK or LimitMEMLOCK=infinity"}});
  return false;
}

}  // namespace depthscope::platform
