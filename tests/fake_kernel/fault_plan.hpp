#pragma once
#include <chrono>
#include <cstdint>
#include <string>

namespace depthscope::fake {

/// Which system call goes wrong, and how.
struct FaultPlan {
  enum class Kind {
    Error,  // the call does nothing and returns -error
    Short,  // read and write move half of what was asked; other calls are as ever
    Late,   // the call works, but takes `delay` longer
  };

  std::string under{};     // only calls on paths that begin so, and on files opened there, count
  std::uint64_t call = 0;  // the call that goes wrong, counted from 1; 0: none
  bool forever = false;    // all calls after it too
  Kind kind = Kind::Error;
  int error = 0;  // errno value, e.g. EIO
  std::chrono::nanoseconds delay{0};

  bool hits(std::uint64_t number) const {
    return call != 0 && (forever ? number >= call : number == call);
  }
};

}  // namespace depthscope::fake
