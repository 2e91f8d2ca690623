#include "platform/daemon/heartbeat_line.hpp"

#include <cerrno>
#include <system_error>

#include "platform/log.hpp"

namespace depthscope::platform {
namespace {
constexpr std::chrono::seconds retry_interval{1};
}

HeartbeatLine::HeartbeatLine(const HeartbeatSettings& settings, GpioChips& chips)
    : config_{settings.chip, settings.line, GpioBias::AsIs, settings.active_low}, chips_(chips) {}

void HeartbeatLine::service(Time now, std::uint64_t presented) {
  if (config_.line.empty()) return;
  if (!output_ && now >= next_try_) open(now);
  if (!output_ || presented == presented_ || now - last_change_ < half_period) return;
  presented_ = presented;
  last_change_ = now;
  active_ = !active_;
  const int error = output_->set(active_);
  if (error == 0) return;
  output_.reset();
  next_try_ = now + retry_interval;
  note(error);
}

void HeartbeatLine::open(Time now) {
  next_try_ = now + retry_interval;
  active_ = false;
  note(chips_.openOutput(config_, output_));
}

void HeartbeatLine::note(int error) {
  if (noted_ && error == error_) return;
  noted_ = true;
  error_ = error;
  if (error == 0)
    log(LogPriority::Info, "heartbeat line ready", {{"line", config_.line}});
  else
    log(LogPriority::Warning, "heartbeat line cannot be driven, it is looked for again and again",
        {{"line", config_.line}, {"error", std::generic_category().message(-error)}});
}

}  // namespace depthscope::platform
