#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace depthscope::platform {

/// A pedal that may come and go. Nothing throws; what is missing is looked for again by itself.
class Pedal {
 public:
  using Time = std::chrono::steady_clock::time_point;

  virtual ~Pedal() = default;
  /// To be polled for input; -1 while the pedal is not there.
  virtual int fd() const = 0;
  /// Takes in what happened; `events` are poll(2)'s of the descriptor. How often the pedal was
  /// pressed since the last call.
  virtual int service(Time now, short events) = 0;
  /// When to call service() again even though nothing happens on the descriptor.
  virtual std::optional<Time> wakeAt() const { return std::nullopt; }
  /// 0 when it is there, else -errno.
  virtual int error() const = 0;
  /// Signals that are known to have been lost.
  virtual std::uint64_t lost() const = 0;
  /// For the log, e.g. "gpio line FOOT".
  virtual std::string name() const = 0;
};

}  // namespace depthscope::platform
