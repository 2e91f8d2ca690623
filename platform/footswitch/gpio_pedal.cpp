#include "platform/footswitch/gpio_pedal.hpp"

#include <poll.h>

#include <cerrno>

namespace depthscope::platform {
namespace {

constexpr auto retry_interval = std::chrono::milliseconds(300);
constexpr auto longest_wait = std::chrono::seconds(60);
constexpr int edges_a_turn = 64;  // a line that flutters must not hold the service up

}  // namespace

GpioPedal::GpioPedal(GpioChips& chips, GpioLineConfig config, std::chrono::microseconds debounce)
    : chips_(chips), config_(std::move(config)), debounce_(debounce) {}

int GpioPedal::service(Time now, short events) {
  if (!input_ && now >= next_try_) open(now);
  if (!input_) return 0;
  GpioEdge edge;
  int presses = 0, edges = 0, got = 0;
  for (; edges < edges_a_turn && (got = input_->readEdge(edge)) > 0; ++edges) {
    count(edge);
    // The edges may have waited for us: each counts from its own time on. (Kernels before 5.7 gave
    // the time of day instead.)
    const Time at = now - edge.at < longest_wait && edge.at <= now ? edge.at : now;
    presses += settle(at);
    contact_->feed(edge.active, at);
  }
  if (got < 0) return close(got, now), presses;
  compareLevel(now, edges > 0);
  if (input_ && (events & (POLLERR | POLLHUP | POLLNVAL)) != 0) close(-ENODEV, now);
  return input_ ? presses + settle(now) : presses;
}

/// 1 when the contact has just become steadily active.
int GpioPedal::settle(Time now) {
  return contact_->settle(now).value_or(false) ? 1 : 0;
}

void GpioPedal::open(Time now) {
  next_try_ = now + retry_interval;
  error_ = chips_.openInput(config_, debounce_, input_);
  if (error_ != 0) return;
  const int level = input_->level();
  if (level < 0) return close(level, now);
  // A pedal that is held down while it is found was not pressed for us.
  const auto period = input_->debounced() ? std::chrono::microseconds(0) : debounce_;
  contact_.emplace(period, level == 1);
  last_edge_.reset();
  mismatch_ = false;
}

void GpioPedal::close(int error, Time now) {
  input_.reset();
  error_ = error;
  next_try_ = now + retry_interval;
}

/// Edges of a line take turns and are counted one by one: what breaks that was lost in between (the
/// kernel keeps 16 of them).
void GpioPedal::count(const GpioEdge& edge) {
  if (last_edge_) {
    if (edge.sequence && last_edge_->sequence)
      lost_ += *edge.sequence - *last_edge_->sequence - 1;
    else if (edge.active == last_edge_->active)
      ++lost_;
  }
  last_edge_ = edge;
}

/// An edge that never came leaves us with the wrong level: the line itself is asked, and believed
/// when it says so twice with no edge in between.
void GpioPedal::compareLevel(Time now, bool edges_came) {
  const int level = input_->level();
  if (level < 0) return close(level, now);
  const bool differs = (level == 1) != contact_->level();
  if (differs && mismatch_ && !edges_came) {
    ++lost_;
    contact_->feed(level == 1, now);
    last_edge_ = GpioEdge{level == 1, now, std::nullopt};
    mismatch_ = false;
  } else {
    mismatch_ = differs;
  }
}

std::optional<Pedal::Time> GpioPedal::wakeAt() const {
  if (!input_) return next_try_;
  return contact_->settlesAt();
}

}  // namespace depthscope::platform
