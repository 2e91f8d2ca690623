#include "tests/fake_kernel/fake_kms_file.hpp"

#include <algorithm>
#include <cstring>

namespace depthscope::fake {
namespace {

/// A file that says whether a monitor is plugged in.
class StatusFile final : public FakeDevice {
 public:
  explicit StatusFile(const bool& connected) : connected_(connected) {}
  int open(int, std::unique_ptr<FakeFile>& file) override {
    file = std::make_unique<Text>(connected_ ? "connected\n" : "disconnected\n");
    return 0;
  }

 private:
  struct Text final : FakeFile {
    explicit Text(std::string t) : text(std::move(t)) {}
    ssize_t read(std::span<std::byte> into) override {
      const std::size_t bytes = std::min(into.size(), text.size());
      std::memcpy(into.data(), text.data(), bytes);
      text.erase(0, bytes);
      return static_cast<ssize_t>(bytes);
    }
    std::string text;
  };
  const bool& connected_;
};

/// Lays a pixel (0xAARRGGBB, premultiplied where the format has alpha) over another.
std::uint32_t over(std::uint32_t pixel, std::uint32_t format, std::uint32_t below) {
  const bool alpha = format == DRM_FORMAT_ARGB8888 || format == DRM_FORMAT_ABGR8888;
  if (!alpha) return pixel & 0xffffff;
  std::uint32_t out = 0;
  for (const int shift : {0, 8, 16}) {
    const std::uint32_t under = (below >> shift & 0xff) * (255 - (pixel >> 24)) / 255;
    out |= std::min(255u, (pixel >> shift & 0xff) + under) << shift;
  }
  return out;
}

std::string sysfsName(const std::string& card, const FakeKmsCard::Connector& c) {
  const char* type = c.type == DRM_MODE_CONNECTOR_HDMIA         ? "HDMI-A"
                     : c.type == DRM_MODE_CONNECTOR_DisplayPort ? "DP"
                                                                : "Virtual";
  return "/sys/class/drm/" + card + "-" + type + "-" + std::to_string(c.type_id) + "/status";
}

}  // namespace

drm_mode_modeinfo makeMode(int width, int height, double refresh_hz, bool preferred) {
  drm_mode_modeinfo m{};
  m.hdisplay = static_cast<std::uint16_t>(width);
  m.vdisplay = static_cast<std::uint16_t>(height);
  m.hsync_start = static_cast<std::uint16_t>(width + 40);
  m.hsync_end = static_cast<std::uint16_t>(width + 80);
  m.htotal = static_cast<std::uint16_t>(width + 200);
  m.vsync_start = static_cast<std::uint16_t>(height + 4);
  m.vsync_end = static_cast<std::uint16_t>(height + 9);
  m.vtotal = static_cast<std::uint16_t>(height + 30);
  m.clock = static_cast<std::uint32_t>(m.htotal * m.vtotal * refresh_hz / 1000 + 0.5);
  m.vrefresh = static_cast<std::uint32_t>(refresh_hz + 0.5);
  m.type = DRM_MODE_TYPE_DRIVER | (preferred ? DRM_MODE_TYPE_PREFERRED : 0u);
  std::snprintf(m.name, sizeof m.name, "%dx%d", width, height);
  return m;
}

FakeKmsCard::FakeKmsCard(FakeKernel& kernel, std::string name, std::vector<Connector> connectors,
                         std::vector<PlaneKind> planes)
    : kernel_(kernel),
      name_(std::move(name)),
      connectors_(std::move(connectors)),
      planes_(std::move(planes)) {
  state_[first_crtc] = {DRM_MODE_OBJECT_CRTC, 0, {{"ACTIVE", 0}, {"MODE_ID", 0}}};
  for (std::size_t i = 0; i < connectors_.size(); ++i) {
    state_[first_connector + static_cast<std::uint32_t>(i)] = {
        DRM_MODE_OBJECT_CONNECTOR, i, {{"CRTC_ID", 0}, {"link-status", 0}}};
    status_files_.push_back(std::make_unique<StatusFile>(connectors_[i].connected));
    kernel_.plug(sysfsName(name_, connectors_[i]), *status_files_.back());
  }
  for (std::size_t i = 0; i < planes_.size(); ++i)
    state_[first_plane + static_cast<std::uint32_t>(i)] = {DRM_MODE_OBJECT_PLANE,
                                                           i,
                                                           {{"type", planes_[i].type},
                                                            {"FB_ID", 0},
                                                            {"CRTC_ID", 0},
                                                            {"SRC_X", 0},
                                                            {"SRC_Y", 0},
                                                            {"SRC_W", 0},
                                                            {"SRC_H", 0},
                                                            {"CRTC_X", 0},
                                                            {"CRTC_Y", 0},
                                                            {"CRTC_W", 0},
                                                            {"CRTC_H", 0},
                                                            {"IN_FENCE_FD", no_fence}}};
  for (auto& [id, object] : state_) {
    if (object.type != DRM_MODE_OBJECT_PLANE) continue;
    const PlaneKind& kind = planes_[object.index];
    if (kind.zpos >= 0) object.values["zpos"] = static_cast<std::uint64_t>(kind.zpos);
    if (kind.has_colors) object.values["COLOR_ENCODING"] = object.values["COLOR_RANGE"] = 0;
  }
  console_mode_ = makeMode(640, 480, 60);
  console_framebuffer_ = next_id_++;
  framebuffers_[console_framebuffer_] = {0, 640, 480, 2560, DRM_FORMAT_XRGB8888, nullptr};
  showConsole();
  kernel_.plug("/dev/dri/" + name_, *this);
}

FakeKmsCard::~FakeKmsCard() {
  kernel_.unplug("/dev/dri/" + name_);
  for (const Connector& c : connectors_) kernel_.unplug(sysfsName(name_, c));
}

int FakeKmsCard::open(int, std::unique_ptr<FakeFile>& file) {
  if (!present_) return -ENODEV;
  auto client = std::make_unique<File>(*this);
  if (master_ == nullptr && !other_master) master_ = client.get();
  clients_.push_back(client.get());
  file = std::move(client);
  return 0;
}

void FakeKmsCard::setConnected(std::size_t connector, bool connected) {
  connectors_[connector].connected = connected;
}

void FakeKmsCard::setModes(std::size_t connector, std::vector<drm_mode_modeinfo> modes) {
  connectors_[connector].modes = std::move(modes);
}

void FakeKmsCard::setPresent(bool present) {
  present_ = present;
  if (!present) {
    kernel_.unplug("/dev/dri/" + name_);
    pending_.reset();
  } else {
    kernel_.plug("/dev/dri/" + name_, *this);
  }
}

/// The console lights the first connector in its own mode, as the kernel does when the last client
/// has gone.
void FakeKmsCard::showConsole() {
  state_[first_crtc].values["ACTIVE"] = 1;
  state_[first_crtc].values["MODE_ID"] = 0;
  for (auto& [id, object] : state_) {
    if (object.type == DRM_MODE_OBJECT_CONNECTOR)
      object.values["CRTC_ID"] = object.index == 0 ? first_crtc : 0;
    if (object.type == DRM_MODE_OBJECT_PLANE) {
      const bool primary = planes_[object.index].type == 1;
      object.values["FB_ID"] = primary ? console_framebuffer_ : 0;
      object.values["CRTC_ID"] = primary ? first_crtc : 0;
    }
  }
}

bool FakeKmsCard::consoleShown() const {
  for (const auto& [id, object] : state_)
    if (object.type == DRM_MODE_OBJECT_PLANE && object.values.at("FB_ID") == console_framebuffer_)
      return true;
  return false;
}

void FakeKmsCard::clientClosed(const File* client) {
  std::erase(clients_, client);
  if (master_ == client) master_ = nullptr;
  if (pending_ && pending_->client == client) pending_.reset();
  std::vector<std::uint32_t> ids;
  for (const auto& [id, fb] : framebuffers_)
    if (fb.owner == client) ids.push_back(id);
  for (const std::uint32_t id : ids) removeFramebuffer(id);
  std::erase_if(buffers_, [&](const auto& item) { return item.second.owner == client; });
  std::erase_if(blobs_, [&](const auto& item) { return item.second.owner == client; });
  if (clients_.empty()) showConsole();
}

/// A framebuffer that is on screen takes its plane with it, and the primary plane its CRTC.
void FakeKmsCard::removeFramebuffer(std::uint32_t id) {
  for (auto& [plane_id, plane] : state_) {
    if (plane.type != DRM_MODE_OBJECT_PLANE || plane.values["FB_ID"] != id) continue;
    if (planes_[plane.index].type == 1) {
      state_[static_cast<std::uint32_t>(plane.values["CRTC_ID"])].values["ACTIVE"] = 0;
      ++switched_off_;
    }
    plane.values["FB_ID"] = plane.values["CRTC_ID"] = 0;
  }
  framebuffers_.erase(id);
}

bool FakeKmsCard::lit(std::size_t connector) const {
  const auto& values = state_.at(first_connector + static_cast<std::uint32_t>(connector)).values;
  const auto crtc = static_cast<std::uint32_t>(values.at("CRTC_ID"));
  return crtc != 0 && state_.at(crtc).values.at("ACTIVE") == 1;
}

const drm_mode_modeinfo* FakeKmsCard::mode() const {
  const auto& values = state_.at(first_crtc).values;
  const auto blob = blobs_.find(static_cast<std::uint32_t>(values.at("MODE_ID")));
  if (values.at("ACTIVE") == 0) return nullptr;
  if (blob == blobs_.end()) return &console_mode_;
  return reinterpret_cast<const drm_mode_modeinfo*>(blob->second.bytes.data());
}

std::uint32_t FakeKmsCard::pixel(int x, int y) {
  settle();
  std::vector<const Object*> planes;
  for (const auto& [id, object] : screen_)
    if (object.type == DRM_MODE_OBJECT_PLANE) planes.push_back(&object);
  // Overlays lie above the primary plane unless told otherwise.
  const auto height = [&](const Object* o) {
    const PlaneKind& kind = planes_[o->index];
    return kind.zpos >= 0 ? kind.zpos : kind.type == 1 ? 0 : 1;
  };
  std::stable_sort(planes.begin(), planes.end(),
                   [&](const Object* a, const Object* b) { return height(a) < height(b); });
  std::uint32_t below = 0;
  for (const Object* plane : planes) {
    const auto fb = framebuffers_.find(static_cast<std::uint32_t>(plane->values.at("FB_ID")));
    if (fb == framebuffers_.end() || fb->second.buffer == 0) continue;
    const int u = x - static_cast<int>(plane->values.at("CRTC_X"));
    const int v = y - static_cast<int>(plane->values.at("CRTC_Y"));
    if (u < 0 || v < 0 || u >= static_cast<int>(fb->second.width) ||
        v >= static_cast<int>(fb->second.height))
      continue;
    below = over(framebufferPixel(fb->second, u, v), fb->second.format, below);
  }
  return below;
}

std::uint32_t FakeKmsCard::framebufferPixel(const Framebuffer& fb, int x, int y) const {
  std::uint32_t word = 0;
  std::memcpy(&word,
              buffers_.at(fb.buffer).memory.get() + static_cast<std::size_t>(y) * fb.pitch +
                  static_cast<std::size_t>(x) * 4,
              4);
  const bool swapped = fb.format == DRM_FORMAT_XBGR8888 || fb.format == DRM_FORMAT_ABGR8888;
  return swapped ? (word & 0xff00ff00) | (word & 0xff) << 16 | (word >> 16 & 0xff) : word;
}

std::uint64_t FakeKmsCard::planeValue(std::size_t plane, const std::string& name) const {
  return state_.at(first_plane + static_cast<std::uint32_t>(plane)).values.at(name);
}

Time FakeKmsCard::nextVblank() const {
  const drm_mode_modeinfo* m = mode();
  const double rate = m == nullptr ? 60 : m->clock * 1000.0 / (m->htotal * m->vtotal);
  const auto period = static_cast<std::int64_t>(1e9 / rate);
  const auto now = kernel_.now().time_since_epoch().count();
  return Time(std::chrono::nanoseconds((now / period + 1) * period));
}

/// Lets what the clock has brought about come to pass.
void FakeKmsCard::settle() {
  if (!pending_ || kernel_.now() < pending_->at || !vblanks) return;
  ++flips_;
  screen_ = state_;
  if (pending_->wants_event)
    for (File* client : clients_)
      if (client == pending_->client) {
        const auto us =
            std::chrono::duration_cast<std::chrono::microseconds>(pending_->at.time_since_epoch())
                .count();
        drm_event_vblank event{};
        event.base = {DRM_EVENT_FLIP_COMPLETE, sizeof event};
        event.user_data = pending_->user_data;
        event.tv_sec = static_cast<std::uint32_t>(us / 1000000);
        event.tv_usec = static_cast<std::uint32_t>(us % 1000000);
        client->events_.push_back(event);
      }
  pending_.reset();
}

std::uint32_t FakeKmsCard::propertyId(const std::string& name) {
  const auto found = std::find(properties_.begin(), properties_.end(), name);
  const auto index = found - properties_.begin();
  if (found == properties_.end()) properties_.push_back(name);
  return first_property + static_cast<std::uint32_t>(index);
}

std::string FakeKmsCard::propertyName(std::uint32_t id) const {
  const std::size_t index = id - first_property;
  return id >= first_property && index < properties_.size() ? properties_[index] : std::string();
}

}  // namespace depthscope::fake
