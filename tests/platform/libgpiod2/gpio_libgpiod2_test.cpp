// The footswitch's wrapper of libgpiod 2, on a library in memory.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>

#include "fake_libgpiod2.hpp"
#include "platform/footswitch/gpio_pedal.hpp"

namespace depthscope::platform {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class Libgpiod2Test : public ::testing::Test {
 protected:
  Libgpiod2Test() {
    library = {};
    library.lines[3].name = "DOOR";
    library.lines[4].name = "FOOT";
    config.line = "FOOT";
  }
  void TearDown() override {
    input.reset();
    EXPECT_EQ(library.objects, 0);
  }
  fake::FakeLibgpiod2::Line& foot() { return library.lines[4]; }

  fake::FakeLibgpiod2& library = fake::FakeLibgpiod2::instance();
  std::unique_ptr<GpioChips> chips = makeGpioChips();
  GpioLineConfig config;
  std::unique_ptr<GpioInput> input;
};

TEST_F(Libgpiod2Test, AnInputIsRequestedAsItIsWired) {
  config.bias = GpioBias::PullUp;
  config.active_low = true;
  ASSERT_EQ(chips->openInput(config, milliseconds(20), input), 0);
  EXPECT_TRUE(foot().requested);
  EXPECT_EQ(foot().consumer, "depthscope");
  EXPECT_EQ(foot().direction, GPIOD_LINE_DIRECTION_INPUT);
  EXPECT_EQ(foot().edges_wanted, GPIOD_LINE_EDGE_BOTH);
  EXPECT_EQ(foot().bias, GPIOD_LINE_BIAS_PULL_UP);
  EXPECT_TRUE(foot().active_low);
  EXPECT_EQ(foot().debounce_us, 20000u);
  EXPECT_TRUE(input->debounced());
  EXPECT_TRUE(::fcntl(input->fd(), F_GETFL) & O_NONBLOCK);
  input.reset();
  EXPECT_FALSE(foot().requested);
}

TEST_F(Libgpiod2Test, ALineIsFoundByNameOrByChipAndOffset) {
  for (const char* chip : {"", "gpiochip0", "pedals", "/dev/null"})
    for (const char* line : {"FOOT", "4"}) {
      const bool named = std::string_view(line) == "FOOT";
      config.chip = chip;
      config.line = line;
      SCOPED_TRACE(config.chip + " " + line);
      EXPECT_EQ(chips->openInput(config, microseconds(0), input),
                named || !config.chip.empty() ? 0 : -ENOENT);
      EXPECT_EQ(foot().requested, input != nullptr);
      input.reset();
    }
  config = {"gpiochip7", "FOOT"};
  EXPECT_EQ(chips->openInput(config, microseconds(0), input), -ENOENT);
  config = {"gpiochip0", "99"};
  EXPECT_EQ(chips->openInput(config, microseconds(0), input), -EINVAL);
}

TEST_F(Libgpiod2Test, EdgesComeWithTimeAndNumber) {
  ASSERT_EQ(chips->openInput(config, microseconds(0), input), 0);
  EXPECT_FALSE(input->debounced());
  GpioEdge edge;
  EXPECT_EQ(input->readEdge(edge), 0);
  foot().edges = {{true, 1'500'000'000, 1}, {false, 1'700'000'000, 2}};
  ASSERT_EQ(input->readEdge(edge), 1);
  EXPECT_TRUE(edge.active);
  EXPECT_EQ(edge.at.time_since_epoch(), milliseconds(1500));
  EXPECT_EQ(edge.sequence, 1u);
  ASSERT_EQ(input->readEdge(edge), 1);
  EXPECT_FALSE(edge.active);
  EXPECT_EQ(input->readEdge(edge), 0);
  library.failing = "read";
  library.error = ENODEV;
  EXPECT_EQ(input->readEdge(edge), -ENODEV);
}

TEST_F(Libgpiod2Test, APedalCountsPressesAndWhatWasLostByTheLinesNumbers) {
  GpioPedal pedal(*chips, config, milliseconds(20));
  std::chrono::steady_clock::time_point now(std::chrono::seconds(100));
  EXPECT_EQ(pedal.service(now, 0), 0);
  const auto edge = [&](bool rising, unsigned long number) {
    now += milliseconds(200);
    const auto ns = std::chrono::nanoseconds(now.time_since_epoch()).count();
    foot().edges.push_back({rising, static_cast<std::uint64_t>(ns), number});
    foot().value = rising ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  };
  edge(true, 1);
  edge(false, 2);
  EXPECT_EQ(pedal.service(now, POLLIN), 1);
  EXPECT_EQ(pedal.lost(), 0u);
  edge(true, 5);  // two edges did not come
  EXPECT_EQ(pedal.service(now, POLLIN), 1);
  EXPECT_EQ(pedal.lost(), 2u);
}

TEST_F(Libgpiod2Test, AnOutputStartsInactiveAndIsSet) {
  std::unique_ptr<GpioOutput> output;
  ASSERT_EQ(chips->openOutput(config, output), 0);
  EXPECT_EQ(foot().direction, GPIOD_LINE_DIRECTION_OUTPUT);
  EXPECT_EQ(foot().value, GPIOD_LINE_VALUE_INACTIVE);
  EXPECT_EQ(output->set(true), 0);
  EXPECT_EQ(foot().value, GPIOD_LINE_VALUE_ACTIVE);
  library.failing = "set value";
  library.error = ENODEV;
  EXPECT_EQ(output->set(false), -ENODEV);
}

TEST_F(Libgpiod2Test, EveryLineIsListed) {
  library.lines[3].requested = true;
  library.lines[0];  // without a name
  const auto lines = chips->list();
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0].name, "");
  EXPECT_EQ(lines[3].name, "DOOR");
  EXPECT_TRUE(lines[3].used);
  EXPECT_EQ(lines[4].chip, "gpiochip0");
  EXPECT_EQ(lines[4].label, "pedals");
  EXPECT_EQ(lines[4].offset, 4u);
  EXPECT_FALSE(lines[4].used);
}

TEST_F(Libgpiod2Test, WhateverFailsIsSaidAndNothingIsLeft) {
  library.error = EACCES;
  std::unique_ptr<GpioOutput> output;
  for (const char* call : {"open", "settings", "line config", "request config", "add settings",
                           "request", "event buffer", "info", "line info"}) {
    SCOPED_TRACE(call);
    library.failing = call;
    config.chip = std::string_view(call) == "info" ? "gpiochip0" : "";
    const bool listing = std::string_view(call) == "line info";
    EXPECT_EQ(chips->openInput(config, microseconds(0), input) < 0, !listing);
    input.reset();
    const bool inputs_only = listing || std::string_view(call) == "event buffer";
    EXPECT_EQ(chips->openOutput(config, output) < 0, !inputs_only);
    output.reset();
    chips->list();
    EXPECT_EQ(library.objects, 0);
    EXPECT_FALSE(foot().requested);
  }
}

}  // namespace
}  // namespace depthscope::platform
