#pragma once
#include <gpiod.h>

#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace depthscope::fake {

/// What stands behind libgpiod 2's functions in these tests: one chip and its lines.
struct FakeLibgpiod2 {
  struct Edge {
    bool rising;
    std::uint64_t time_ns;
    unsigned long number;
  };
  struct Line {
    std::string name;
    // As requested:
    bool requested = false, active_low = false;
    gpiod_line_direction direction = GPIOD_LINE_DIRECTION_AS_IS;
    gpiod_line_edge edges_wanted = GPIOD_LINE_EDGE_NONE;
    gpiod_line_bias bias = GPIOD_LINE_BIAS_AS_IS;
    unsigned long debounce_us = 0;
    gpiod_line_value value = GPIOD_LINE_VALUE_INACTIVE;
    std::string consumer;
    std::deque<Edge> edges;
  };

  static FakeLibgpiod2& instance();

  /// Which of the functions fails with `error`, by its name.
  bool fails(const char* function) const;

  std::string path = "/dev/null";  // of the chip; a file that is there everywhere
  std::string name = "gpiochip0", label = "pedals";
  std::map<unsigned, Line> lines;
  std::string failing;
  int error = 0;
  int objects = 0;  // handed out and not freed
};

}  // namespace depthscope::fake
