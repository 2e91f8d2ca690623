// GPIO lines by libgpiod 1.6, the one of Debian 12. It speaks the kernel's first interface: no
// debouncing, and edges come without a count.
#include <fcntl.h>
#include <gpiod.h>

#include <cerrno>

#include "platform/footswitch/gpio.hpp"
#include "platform/footswitch/line_offset.hpp"

namespace depthscope::platform {
namespace {

constexpr const char* consumer = "depthscope";

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

int failure() {
  return errno != 0 ? -errno : -EIO;
}

/// Finds a line; closing its chip releases it.
int findLine(const GpioLineConfig& config, Chip& chip, gpiod_line*& line) {
  errno = 0;
  if (config.chip.empty()) {
    line = gpiod_line_find(config.line.c_str());
    if (line == nullptr) return errno != 0 ? -errno : -ENOENT;
    chip.reset(gpiod_line_get_chip(line));
    return 0;
  }
  chip.reset(gpiod_chip_open_lookup(config.chip.c_str()));
  if (chip == nullptr) return failure();
  const auto offset = lineOffset(config.line);
  line = offset ? gpiod_chip_get_line(chip.get(), *offset)
                : gpiod_chip_find_line(chip.get(), config.line.c_str());
  return line != nullptr ? 0 : failure();
}

int requestFlags(const GpioLineConfig& config) {
  int flags = config.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  switch (config.bias) {
    case GpioBias::AsIs:
      break;
    case GpioBias::Disabled:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
      break;
    case GpioBias::PullUp:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
      break;
    case GpioBias::PullDown:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
      break;
  }
  return flags;
}

class Input final : public GpioInput {
 public:
  Input(Chip chip, gpiod_line* line) : chip_(std::move(chip)), line_(line) {}
  int fd() const override { return gpiod_line_event_get_fd(line_); }
  int readEdge(GpioEdge& edge) override {
    gpiod_line_event event{};
    if (gpiod_line_event_read(line_, &event) != 0)
      return errno == EAGAIN || errno == EINTR ? 0 : failure();
    edge = {event.event_type == GPIOD_LINE_EVENT_RISING_EDGE,
            std::chrono::steady_clock::time_point(std::chrono::seconds(event.ts.tv_sec) +
                                                  std::chrono::nanoseconds(event.ts.tv_nsec)),
            std::nullopt};
    return 1;
  }
  int level() override {
    const int value = gpiod_line_get_value(line_);
    return value >= 0 ? value : failure();
  }
  bool debounced() const override { return false; }

 private:
  Chip chip_;
  gpiod_line* line_;
};

class Output final : public GpioOutput {
 public:
  Output(Chip chip, gpiod_line* line) : chip_(std::move(chip)), line_(line) {}
  int set(bool active) override {
    return gpiod_line_set_value(line_, active ? 1 : 0) == 0 ? 0 : failure();
  }

 private:
  Chip chip_;
  gpiod_line* line_;
};

class Chips final : public GpioChips {
 public:
  int openInput(const GpioLineConfig& config, std::chrono::microseconds,
                std::unique_ptr<GpioInput>& input) override {
    Chip chip;
    gpiod_line* line = nullptr;
    if (const int error = findLine(config, chip, line)) return error;
    if (gpiod_line_request_both_edges_events_flags(line, consumer, requestFlags(config)) != 0)
      return failure();
    const int fd = gpiod_line_event_get_fd(line);
    if (fd < 0 || ::fcntl(fd, F_SETFL, O_NONBLOCK) != 0) return failure();
    input = std::make_unique<Input>(std::move(chip), line);
    return 0;
  }

  int openOutput(const GpioLineConfig& config, std::unique_ptr<GpioOutput>& output) override {
    Chip chip;
    gpiod_line* line = nullptr;
    if (const int error = findLine(config, chip, line)) return error;
    if (gpiod_line_request_output_flags(line, consumer, requestFlags(config), 0) != 0)
      return failure();
    output = std::make_unique<Output>(std::move(chip), line);
    return 0;
  }

  std::vector<GpioLineInfo> list() override {
    std::vector<GpioLineInfo> lines;
    gpiod_chip_iter* chips = gpiod_chip_iter_new();
    if (chips == nullptr) return lines;
    gpiod_chip* chip = nullptr;
    gpiod_foreach_chip_noclose(chips, chip) {
      const Chip owner(chip);
      for (unsigned offset = 0; offset < gpiod_chip_num_lines(chip); ++offset) {
        gpiod_line* line = gpiod_chip_get_line(chip, offset);
        if (line == nullptr) continue;
        const char* name = gpiod_line_name(line);
        lines.push_back({gpiod_chip_name(chip), gpiod_chip_label(chip), offset,
                         name != nullptr ? name : "", gpiod_line_is_used(line)});
      }
    }
    gpiod_chip_iter_free_noclose(chips);
    return lines;
  }
};

}  // namespace

std::unique_ptr<GpioChips> makeGpioChips() {
  return std::make_unique<Chips>();
}

}  // namespace depthscope::platform
