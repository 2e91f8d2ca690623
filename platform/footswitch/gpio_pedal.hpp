#pragma once
#include "platform/footswitch/debouncer.hpp"
#include "platform/footswitch/gpio.hpp"
#include "platform/footswitch/pedal.hpp"

namespace depthscope::platform {

/// A switch on a GPIO line.
class GpioPedal final : public Pedal {
 public:
  /// `chips` outlives the pedal.
  GpioPedal(GpioChips& chips, GpioLineConfig config, std::chrono::microseconds debounce);

  int fd() const override { return input_ ? input_->fd() : -1; }
  int service(Time now, short events) override;
  std::optional<Time> wakeAt() const override;
  int error() const override { return error_; }
  std::uint64_t lost() const override { return lost_; }
  std::string name() const override { return "gpio line " + config_.line; }

 private:
  void open(Time now);
  void close(int error, Time now);
  int settle(Time now);
  void count(const GpioEdge& edge);
  void compareLevel(Time now, bool edges_came);

  GpioChips& chips_;
  GpioLineConfig config_;
  std::chrono::microseconds debounce_;
  std::unique_ptr<GpioInput> input_;
  std::optional<Debouncer> contact_;
  std::optional<GpioEdge> last_edge_;
  bool mismatch_ = false;  // the line was last seen at a level that no edge told of
  int error_ = -ENOENT;
  std::uint64_t lost_ = 0;
  Time next_try_{};
};

}  // namespace depthscope::platform
