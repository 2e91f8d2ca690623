#include "fake_libgpiod2.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>

using depthscope::fake::FakeLibgpiod2;

namespace depthscope::fake {

FakeLibgpiod2& FakeLibgpiod2::instance() {
  static FakeLibgpiod2 library;
  return library;
}

bool FakeLibgpiod2::fails(const char* function) const {
  if (failing != function) return false;
  errno = error;
  return true;
}

}  // namespace depthscope::fake

namespace {

FakeLibgpiod2& library() {
  return FakeLibgpiod2::instance();
}

template <class T>
T* make(const char* function) {
  if (library().fails(function)) return nullptr;
  ++library().objects;
  return new T{};
}

template <class T>
void release(T* object) {
  if (object != nullptr) --library().objects;
  delete object;
}

}  // namespace

struct gpiod_chip {};
struct gpiod_chip_info {};
struct gpiod_line_info {
  FakeLibgpiod2::Line line;
};
struct gpiod_line_settings {
  FakeLibgpiod2::Line line;
};
struct gpiod_line_config {
  unsigned offset = 0;
  FakeLibgpiod2::Line line;
};
struct gpiod_request_config {
  std::string consumer;
};
struct gpiod_line_request {
  unsigned offset = 0;
  int fd = -1;
};
struct gpiod_edge_event {
  FakeLibgpiod2::Edge edge;
};
struct gpiod_edge_event_buffer {
  gpiod_edge_event event;
};

extern "C" {

bool gpiod_is_gpiochip_device(const char* path) {
  return path == library().path;
}
gpiod_chip* gpiod_chip_open(const char* path) {
  if (path != library().path) return errno = ENOENT, nullptr;
  return make<gpiod_chip>("open");
}
void gpiod_chip_close(gpiod_chip* chip) {
  release(chip);
}
gpiod_chip_info* gpiod_chip_get_info(gpiod_chip*) {
  return make<gpiod_chip_info>("info");
}
void gpiod_chip_info_free(gpiod_chip_info* info) {
  release(info);
}
const char* gpiod_chip_info_get_name(gpiod_chip_info*) {
  return library().name.c_str();
}
const char* gpiod_chip_info_get_label(gpiod_chip_info*) {
  return library().label.c_str();
}
size_t gpiod_chip_info_get_num_lines(gpiod_chip_info*) {
  return library().lines.empty() ? 0 : library().lines.rbegin()->first + 1;
}
int gpiod_chip_get_line_offset_from_name(gpiod_chip*, const char* name) {
  for (const auto& [offset, line] : library().lines)
    if (line.name == name) return static_cast<int>(offset);
  return errno = ENOENT, -1;
}
gpiod_line_info* gpiod_chip_get_line_info(gpiod_chip*, unsigned int offset) {
  auto* info = make<gpiod_line_info>("line info");
  const auto found = library().lines.find(offset);
  if (info != nullptr && found != library().lines.end()) info->line = found->second;
  return info;
}
void gpiod_line_info_free(gpiod_line_info* info) {
  release(info);
}
const char* gpiod_line_info_get_name(gpiod_line_info* info) {
  return info->line.name.empty() ? nullptr : info->line.name.c_str();
}
bool gpiod_line_info_is_used(gpiod_line_info* info) {
  return info->line.requested;
}

gpiod_line_settings* gpiod_line_settings_new(void) {
  return make<gpiod_line_settings>("settings");
}
void gpiod_line_settings_free(gpiod_line_settings* settings) {
  release(settings);
}
int gpiod_line_settings_set_direction(gpiod_line_settings* s, gpiod_line_direction direction) {
  s->line.direction = direction;
  return 0;
}
int gpiod_line_settings_set_edge_detection(gpiod_line_settings* s, gpiod_line_edge edge) {
  s->line.edges_wanted = edge;
  return 0;
}
int gpiod_line_settings_set_bias(gpiod_line_settings* s, gpiod_line_bias bias) {
  s->line.bias = bias;
  return 0;
}
void gpiod_line_settings_set_active_low(gpiod_line_settings* s, bool active_low) {
  s->line.active_low = active_low;
}
void gpiod_line_settings_set_debounce_period_us(gpiod_line_settings* s, unsigned long period) {
  s->line.debounce_us = period;
}
int gpiod_line_settings_set_output_value(gpiod_line_settings* s, gpiod_line_value value) {
  s->line.value = value;
  return 0;
}

gpiod_line_config* gpiod_line_config_new(void) {
  return make<gpiod_line_config>("line config");
}
void gpiod_line_config_free(gpiod_line_config* config) {
  release(config);
}
int gpiod_line_config_add_line_settings(gpiod_line_config* config, const unsigned int* offsets,
                                        size_t num_offsets, gpiod_line_settings* settings) {
  if (library().fails("add settings") || num_offsets != 1) return -1;
  config->offset = offsets[0];
  config->line = settings->line;
  return 0;
}
gpiod_request_config* gpiod_request_config_new(void) {
  return make<gpiod_request_config>("request config");
}
void gpiod_request_config_free(gpiod_request_config* config) {
  release(config);
}
void gpiod_request_config_set_consumer(gpiod_request_config* config, const char* consumer) {
  config->consumer = consumer;
}

gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config* options,
                                             gpiod_line_config* config) {
  const auto found = library().lines.find(config->offset);
  if (found == library().lines.end()) return errno = EINVAL, nullptr;
  if (found->second.requested) return errno = EBUSY, nullptr;
  auto* request = make<gpiod_line_request>("request");
  if (request == nullptr) return nullptr;
  const std::string name = found->second.name;
  found->second = config->line;
  found->second.name = name;
  found->second.requested = true;
  found->second.consumer = options->consumer;
  request->offset = config->offset;
  request->fd = ::eventfd(0, EFD_CLOEXEC);
  return request;
}
void gpiod_line_request_release(gpiod_line_request* request) {
  library().lines[request->offset].requested = false;
  ::close(request->fd);
  release(request);
}
int gpiod_line_request_get_fd(gpiod_line_request* request) {
  return request->fd;
}
gpiod_line_value gpiod_line_request_get_value(gpiod_line_request* request, unsigned int offset) {
  if (offset != request->offset || library().fails("get value")) return GPIOD_LINE_VALUE_ERROR;
  return library().lines[offset].value;
}
int gpiod_line_request_set_value(gpiod_line_request* request, unsigned int offset,
                                 gpiod_line_value value) {
  if (offset != request->offset || library().fails("set value")) return -1;
  library().lines[offset].value = value;
  return 0;
}
int gpiod_line_request_read_edge_events(gpiod_line_request* request,
                                        gpiod_edge_event_buffer* buffer, size_t max_events) {
  if (library().fails("read")) return -1;
  auto& edges = library().lines[request->offset].edges;
  if (edges.empty() || max_events == 0) return errno = EAGAIN, -1;
  buffer->event.edge = edges.front();
  edges.pop_front();
  return 1;
}

gpiod_edge_event_buffer* gpiod_edge_event_buffer_new(size_t) {
  return make<gpiod_edge_event_buffer>("event buffer");
}
void gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* buffer) {
  release(buffer);
}
gpiod_edge_event* gpiod_edge_event_buffer_get_event(gpiod_edge_event_buffer* buffer,
                                                    unsigned long index) {
  return index == 0 ? &buffer->event : nullptr;
}
gpiod_edge_event_type gpiod_edge_event_get_event_type(gpiod_edge_event* event) {
  return event->edge.rising ? GPIOD_EDGE_EVENT_RISING_EDGE : GPIOD_EDGE_EVENT_FALLING_EDGE;
}
uint64_t gpiod_edge_event_get_timestamp_ns(gpiod_edge_event* event) {
  return event->edge.time_ns;
}
unsigned long gpiod_edge_event_get_line_seqno(gpiod_edge_event* event) {
  return event->edge.number;
}

}  // extern "C"
