#include "kernel/bell.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace depthscope::kernel {

void Bell::ring() {
  rings_.fetch_add(1, std::memory_order_release);
  // Not FUTEX_PRIVATE_FLAG: who waits is another process.
  ::syscall(SYS_futex, &rings_, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

}  // namespace depthscope::kernel
