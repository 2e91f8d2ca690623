#include "platform/interrupt.hpp"

#include <csignal>

namespace depthscope::platform {
namespace {
volatile std::sig_atomic_t caught = 0;
}

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { caught = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return caught != 0;
}

}  // namespace depthscope::platform
