#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "platform/footswitch/footswitch.hpp"
#include "tests/fake_kernel/fake_gpio.hpp"
#include "tests/fake_kernel/fake_kernel.hpp"

namespace depthscope::platform {

/// A footswitch on lines and input devices of the fake kernel, and the service's loop around it.
class FootswitchTest : public ::testing::Test {
 protected:
  using Wire = fake::FakeGpio::Wire;
  using milliseconds = std::chrono::milliseconds;
  FootswitchTest() {
    gpio.addLine("gpiochip0", 3, "DOOR");
    gpio.addLine("gpiochip0", 4, "FOOT");
    gpio.addLine("gpiochip1", 4, "OTHER");
    settings.line = "FOOT";
  }
  void make() { footswitch.emplace(settings, gpio, kernel); }
  /// Time passes, with the service's loop turning as often as it asks to; presses meanwhile.
  int pass(milliseconds time) {
    const auto until = gpio.now + time;
    int presses = turn();
    while (gpio.now < until) {
      const int wait = footswitch->waitAtMost(gpio.now, 50);
      gpio.now += std::clamp<milliseconds>(milliseconds(wait), milliseconds(1),
                                           std::chrono::ceil<milliseconds>(until - gpio.now));
      presses += turn();
    }
    return presses;
  }
  int turn(short events = 0) {
    std::array<pollfd, Footswitch::max_pedals> descriptors{};
    footswitch->addTo(descriptors);
    for (pollfd& d : descriptors) d.revents = events;
    return footswitch->service(gpio.now, descriptors);
  }
  void bounce(Wire from, Wire to, int times) {
    for (int i = 0; i < times; ++i) {
      gpio.setWire("FOOT", to);
      gpio.now += std::chrono::microseconds(300);
      gpio.setWire("FOOT", from);
      gpio.now += std::chrono::microseconds(300);
    }
    gpio.setWire("FOOT", to);
  }

  fake::FakeKernel kernel;
  fake::FakeGpio gpio{fake::FakeGpio::Time(std::chrono::seconds(1000))};
  FootswitchSettings settings;
  std::optional<Footswitch> footswitch;
};

}  // namespace depthscope::platform
