// GPIO lines by libgpiod 2.x: the kernel debounces, and edges are counted.
#include <fcntl.h>
#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "platform/footswitch/gpio.hpp"
#include "platform/footswitch/line_offset.hpp"

namespace depthscope::platform {
namespace {

template <auto Function>
struct Free {
  template <class T>
  void operator()(T* object) const {
    Function(object);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Free<gpiod_chip_close>>;
using ChipInfo = std::unique_ptr<gpiod_chip_info, Free<gpiod_chip_info_free>>;
using LineInfo = std::unique_ptr<gpiod_line_info, Free<gpiod_line_info_free>>;
using LineSettings = std::unique_ptr<gpiod_line_settings, Free<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Free<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Free<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Free<gpiod_line_request_release>>;
using EventBuffer = std::unique_ptr<gpiod_edge_event_buffer, Free<gpiod_edge_event_buffer_free>>;

int failure() {
  return errno != 0 ? -errno : -EIO;
}

std::vector<std::string> chipPaths() {
  std::vector<std::string> paths;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored))
    if (gpiod_is_gpiochip_device(entry.path().c_str()) && !entry.is_symlink(ignored))
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool isCalled(gpiod_chip* chip, const std::string& wanted) {
  const ChipInfo info(gpiod_chip_get_info(chip));
  return info != nullptr && (wanted == gpiod_chip_info_get_name(info.get()) ||
                             wanted == gpiod_chip_info_get_label(info.get()));
}

int findOffset(gpiod_chip* chip, const GpioLineConfig& config) {
  const auto number = config.chip.empty() ? std::nullopt : lineOffset(config.line);
  return number ? static_cast<int>(*number)
                : gpiod_chip_get_line_offset_from_name(chip, config.line.c_str());
}

int findLine(const GpioLineConfig& config, Chip& chip, unsigned& offset) {
  const bool by_path = config.chip.starts_with('/');
  const auto paths = by_path ? std::vector<std::string>{config.chip} : chipPaths();
  int result = -ENOENT;
  for (const std::string& path : paths) {
    errno = 0;
    chip.reset(gpiod_chip_open(path.c_str()));
    if (chip == nullptr) {
      result = failure();
      continue;
    }
    if (!by_path && !config.chip.empty() && !isCalled(chip.get(), config.chip)) continue;
    const int found = findOffset(chip.get(), config);
    if (found < 0) continue;
    offset = static_cast<unsigned>(found);
    return 0;
  }
  return result;
}

gpiod_line_bias bias(GpioBias wanted) {
  switch (wanted) {
    case GpioBias::AsIs:
      break;
    case GpioBias::Disabled:
      return GPIOD_LINE_BIAS_DISABLED;
    case GpioBias::PullUp:
      return GPIOD_LINE_BIAS_PULL_UP;
    case GpioBias::PullDown:
      return GPIOD_LINE_BIAS_PULL_DOWN;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

int request(gpiod_chip* chip, unsigned offset, gpiod_line_settings* settings, Request& out) {
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig options(gpiod_request_config_new());
  if (lines == nullptr || options == nullptr) return -ENOMEM;
  gpiod_request_config_set_consumer(options.get(), "depthscope");
  errno = 0;
  if (gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings) != 0) return failure();
  out.reset(gpiod_chip_request_lines(chip, options.get(), lines.get()));
  return out != nullptr ? 0 : failure();
}

class Input final : public GpioInput {
 public:
  Input(Request request, unsigned offset, EventBuffer events, bool debounced)
      : request_(std::move(request)),
        events_(std::move(events)),
        offset_(offset),
        debounced_(debounced) {}
  int fd() const override { return gpiod_line_request_get_fd(request_.get()); }
  int readEdge(GpioEdge& edge) override {
    errno = 0;
    const int got = gpiod_line_request_read_edge_events(request_.get(), events_.get(), 1);
    if (got < 0) return errno == EAGAIN || errno == EINTR ? 0 : failure();
    if (got == 0) return 0;
    gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(events_.get(), 0);
    edge = {gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
            std::chrono::steady_clock::time_point(
                std::chrono::nanoseconds(gpiod_edge_event_get_timestamp_ns(event))),
            gpiod_edge_event_get_line_seqno(event)};
    return 1;
  }
  int level() override {
    errno = 0;
    const int value = gpiod_line_request_get_value(request_.get(), offset_);
    return value >= 0 ? value : failure();
  }
  bool debounced() const override { return debounced_; }

 private:
  Request request_;
  EventBuffer events_;
  unsigned offset_;
  bool debounced_;
};

class Output final : public GpioOutput {
 public:
  Output(Request request, unsigned offset) : request_(std::move(request)), offset_(offset) {}
  int set(bool active) override {
    errno = 0;
    const auto value = active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    return gpiod_line_request_set_value(request_.get(), offset_, value) == 0 ? 0 : failure();
  }

 private:
  Request request_;
  unsigned offset_;
};

class Chips final : public GpioChips {
 public:
  int openInput(const GpioLineConfig& config, std::chrono::microseconds debounce,
                std::unique_ptr<GpioInput>& input) override {
    Chip chip;
    unsigned offset = 0;
    if (const int error = findLine(config, chip, offset)) return error;
    const LineSettings settings(gpiod_line_settings_new());
    EventBuffer events(gpiod_edge_event_buffer_new(1));
    if (settings == nullptr || events == nullptr) return -ENOMEM;
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
    gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
    gpiod_line_settings_set_bias(settings.get(), bias(config.bias));
    gpiod_line_settings_set_active_low(settings.get(), config.active_low);
    gpiod_line_settings_set_debounce_period_us(settings.get(),
                                               static_cast<unsigned long>(debounce.count()));
    Request made;
    if (const int error = request(chip.get(), offset, settings.get(), made)) return error;
    if (::fcntl(gpiod_line_request_get_fd(made.get()), F_SETFL, O_NONBLOCK) != 0) return failure();
    input =
        std::make_unique<Input>(std::move(made), offset, std::move(events), debounce.count() > 0);
    return 0;
  }

  int openOutput(const GpioLineConfig& config, std::unique_ptr<GpioOutput>& output) override {
    Chip chip;
    unsigned offset = 0;
    if (const int error = findLine(config, chip, offset)) return error;
    const LineSettings settings(gpiod_line_settings_new());
    if (settings == nullptr) return -ENOMEM;
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
    gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
    gpiod_line_settings_set_active_low(settings.get(), config.active_low);
    Request made;
    if (const int error = request(chip.get(), offset, settings.get(), made)) return error;
    output = std::make_unique<Output>(std::move(made), offset);
    return 0;
  }

  std::vector<GpioLineInfo> list() override {
    std::vector<GpioLineInfo> lines;
    for (const std::string& path : chipPaths()) {
      const Chip chip(gpiod_chip_open(path.c_str()));
      if (chip == nullptr) continue;
      const ChipInfo info(gpiod_chip_get_info(chip.get()));
      if (info == nullptr) continue;
      for (unsigned i = 0; i < gpiod_chip_info_get_num_lines(info.get()); ++i) {
        const LineInfo line(gpiod_chip_get_line_info(chip.get(), i));
        if (line == nullptr) continue;
        const char* name = gpiod_line_info_get_name(line.get());
        lines.push_back({gpiod_chip_info_get_name(info.get()),
                         gpiod_chip_info_get_label(info.get()), i, name != nullptr ? name : "",
                         gpiod_line_info_is_used(line.get())});
      }
    }
    return lines;
  }
};

}  // namespace

std::unique_ptr<GpioChips> makeGpioChips() {
  return std::make_unique<Chips>();
}

}  // namespace depthscope::platform
