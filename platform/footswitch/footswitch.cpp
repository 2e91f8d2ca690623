#include "platform/footswitch/footswitch.hpp"

#include <algorithm>
#include <system_error>

#include "platform/footswitch/gpio_pedal.hpp"
#include "platform/footswitch/keyboard_pedal.hpp"
#include "platform/log.hpp"

namespace depthscope::platform {

Footswitch::Footswitch(const FootswitchSettings& settings, GpioChips& chips,
                       kernel::SystemCalls& calls) {
  logged_error_.fill(1);
  if (!settings.line.empty()) {
    const std::chrono::duration<double, std::milli> debounce(settings.debounce_ms);
    pedals_.push_back(std::make_unique<GpioPedal>(
        chips, GpioLineConfig{settings.chip, settings.line, settings.bias, settings.active_low},
        std::chrono::duration_cast<std::chrono::microseconds>(debounce)));
  }
  if (!settings.keyboard.empty())
    pedals_.push_back(std::make_unique<KeyboardPedal>(calls, settings.keyboard, settings.key));
}

void Footswitch::addTo(std::span<pollfd> descriptors) const {
  for (std::size_t i = 0; i < pedals_.size(); ++i) descriptors[i] = {pedals_[i]->fd(), POLLIN, 0};
}

int Footswitch::waitAtMost(Time now, int ms) const {
  for (const auto& pedal : pedals_)
    if (const auto at = pedal->wakeAt()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(*at - now).count();
      ms = static_cast<int>(std::clamp<std::int64_t>(left, 0, ms));
    }
  return ms;
}

int Footswitch::service(Time now, std::span<const pollfd> descriptors) {
  int presses = 0;
  for (std::size_t i = 0; i < pedals_.size(); ++i) {
    presses += pedals_[i]->service(now, descriptors[i].revents);
    logChange(i);
  }
  presses_ += static_cast<std::uint64_t>(presses);
  return presses;
}

void Footswitch::logChange(std::size_t pedal) {
  const int error = pedals_[pedal]->error();
  if (error == logged_error_[pedal]) return;
  logged_error_[pedal] = error;
  if (error == 0)
    log(LogPriority::Info, "footswitch ready", {{"pedal", pedals_[pedal]->name()}});
  else
    log(LogPriority::Warning, "footswitch is not there, it is looked for again and again",
        {{"pedal", pedals_[pedal]->name()}, {"error", std::generic_category().message(-error)}});
}

std::string Footswitch::state() const {
  for (const auto& pedal : pedals_)
    if (pedal->error() != 0)
      return pedal->name() + ": " + std::generic_category().message(-pedal->error());
  return pedals_.empty() ? "off" : "ready";
}

std::uint64_t Footswitch::lost() const {
  std::uint64_t lost = 0;
  for (const auto& pedal : pedals_) lost += pedal->lost();
  return lost;
}

}  // namespace depthscope::platform
