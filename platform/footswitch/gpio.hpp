#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace depthscope::platform {

enum class GpioBias : std::uint8_t { AsIs, Disabled, PullUp, PullDown };

/// Which line, and how it is wired.
struct GpioLineConfig {
  std::string chip;  // path, name or label; empty: the line is looked for by name on all chips
  std::string line;  // name, or with a chip the line's offset on it
  GpioBias bias = GpioBias::AsIs;
  bool active_low = false;
};

/// A line went active or inactive.
struct GpioEdge {
  bool active = false;
  std::chrono::steady_clock::time_point at{};
  std::optional<std::uint64_t> sequence;  // counts the line's edges, where the library tells
};

/// An input line with edges, in logical levels. Released when destroyed.
class GpioInput {
 public:
  virtual ~GpioInput() = default;
  /// Readable when an edge waits.
  virtual int fd() const = 0;
  /// 1 and the next edge; 0: none waits; -errno. Never waits.
  virtual int readEdge(GpioEdge& edge) = 0;
  /// 1 active, 0 inactive, or -errno.
  virtual int level() = 0;
  /// Whether the kernel holds edges back until the line is steady.
  virtual bool debounced() const = 0;
};

/// An output line in logical levels; starts inactive. Released when destroyed.
class GpioOutput {
 public:
  virtual ~GpioOutput() = default;
  /// 0 or -errno.
  virtual int set(bool active) = 0;
};

/// A line as it is listed.
struct GpioLineInfo {
  std::string chip, label;  // of the chip
  unsigned offset = 0;
  std::string name;  // may be empty
  bool used = false;
};

/// The machine's GPIO chips. None of the functions throws.
class GpioChips {
 public:
  virtual ~GpioChips() = default;
  /// 0 or -errno. `debounce`: asked of the kernel where the library can; zero: none.
  virtual int openInput(const GpioLineConfig& config, std::chrono::microseconds debounce,
                        std::unique_ptr<GpioInput>& input) = 0;
  virtual int openOutput(const GpioLineConfig& config, std::unique_ptr<GpioOutput>& output) = 0;
  virtual std::vector<GpioLineInfo> list() = 0;
};

/// By libgpiod, 1.6 (edges without a count, no debouncing) or 2.x, whichever it was built with.
std::unique_ptr<GpioChips> makeGpioChips();

}  // namespace depthscope::platform
