#pragma once
#include <poll.h>

#include <cerrno>
#include <deque>
#include <map>

#include "platform/footswitch/gpio.hpp"
#include "platform/footswitch/line_offset.hpp"

namespace depthscope::fake {

/// GPIO chips as libgpiod shows them: lines with a wire, bias and active-low, edges kept in a queue
/// of 16 that drops what does not fit. Acts as libgpiod 1.6 unless told to debounce and to count.
class FakeGpio final : public platform::GpioChips {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t queue_room = 16;

  /// What is connected to the line: a switch that is open (bias decides) or drives it.
  enum class Wire { Open, Low, High };
  struct Line {
    std::string chip;
    unsigned offset = 0;
    Wire wire = Wire::Open;
    bool requested = false, output = false;
    platform::GpioLineConfig config;
    std::deque<platform::GpioEdge> edges;
    std::uint64_t sequence = 0;
  };

  explicit FakeGpio(Time start) : now(start) {}

  void addLine(const std::string& chip, unsigned offset, const std::string& name) {
    lines[name].chip = chip;
    lines[name].offset = offset;
  }
  /// The switch moves at `now`.
  void setWire(const std::string& name, Wire wire) {
    Line& line = lines.at(name);
    const bool before = active(line);
    line.wire = wire;
    if (!line.requested || line.output || active(line) == before) return;
    ++line.sequence;
    if (line.edges.size() < queue_room && !drop_edges)
      line.edges.push_back(
          {!before, now, counts_edges ? std::optional(line.sequence) : std::nullopt});
  }
  bool active(const Line& line) const {
    using platform::GpioBias;
    const bool pulled_up = line.config.bias == GpioBias::PullUp;
    const bool high = line.wire == Wire::Open ? pulled_up : line.wire == Wire::High;
    return high != line.config.active_low;
  }

  int openInput(const platform::GpioLineConfig& config, std::chrono::microseconds debounce,
                std::unique_ptr<platform::GpioInput>& input) override {
    ++tries;
    Line* line = nullptr;
    if (const int error = request(config, line)) return error;
    line->output = false;
    input = std::make_unique<Input>(*this, *line, debounces && debounce.count() > 0);
    return 0;
  }
  int openOutput(const platform::GpioLineConfig& config,
                 std::unique_ptr<platform::GpioOutput>& output) override {
    Line* line = nullptr;
    if (const int error = request(config, line)) return error;
    line->output = true;
    line->wire = config.active_low ? Wire::High : Wire::Low;
    output = std::make_unique<Output>(*this, *line);
    return 0;
  }
  std::vector<platform::GpioLineInfo> list() override {
    std::vector<platform::GpioLineInfo> all;
    for (const auto& [name, line] : lines)
      all.push_back({line.chip, line.chip, line.offset, name, line.requested});
    return all;
  }

  std::map<std::string, Line> lines;
  Time now;
  bool present = true;        // false: the chips are gone, open lines answer ENODEV
  bool denied = false;        // opening answers EACCES
  bool debounces = false;     // libgpiod 2.x
  bool counts_edges = false;  // libgpiod 2.x
  bool drop_edges = false;    // edges get lost
  int tries = 0;

 private:
  int request(const platform::GpioLineConfig& config, Line*& line) {
    if (denied) return -EACCES;
    if (!present) return -ENOENT;
    const auto offset = platform::lineOffset(config.line);
    for (auto& [name, candidate] : lines)
      if ((config.chip.empty() || candidate.chip == config.chip) &&
          (name == config.line || (!config.chip.empty() && offset == candidate.offset)))
        line = &candidate;
    if (line == nullptr) return -ENOENT;
    if (line->requested) return -EBUSY;
    line->requested = true;
    line->config = config;
    line->edges.clear();
    line->sequence = 0;
    return 0;
  }

  class Input final : public platform::GpioInput {
   public:
    Input(FakeGpio& gpio, Line& line, bool debounced)
        : gpio_(gpio), line_(line), debounced_(debounced) {}
    ~Input() override { line_.requested = false; }
    int fd() const override { return 77; }
    int readEdge(platform::GpioEdge& edge) override {
      if (!gpio_.present) return -ENODEV;
      if (line_.edges.empty()) return 0;
      edge = line_.edges.front();
      line_.edges.pop_front();
      return 1;
    }
    int level() override { return gpio_.present ? gpio_.active(line_) : -ENODEV; }
    bool debounced() const override { return debounced_; }

   private:
    FakeGpio& gpio_;
    Line& line_;
    bool debounced_;
  };
  class Output final : public platform::GpioOutput {
   public:
    Output(FakeGpio& gpio, Line& line) : gpio_(gpio), line_(line) {}
    ~Output() override { line_.requested = false; }
    int set(bool active) override {
      if (!gpio_.present) return -ENODEV;
      line_.wire = active != line_.config.active_low ? Wire::High : Wire::Low;
      return 0;
    }

   private:
    FakeGpio& gpio_;
    Line& line_;
  };
};

}  // namespace depthscope::fake
