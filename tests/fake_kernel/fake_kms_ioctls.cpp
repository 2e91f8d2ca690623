// What the fake card answers. The kernel's drm_mode_object.c, drm_connector.c, drm_atomic_uapi.c
// and drm_atomic_helper.c tell how the real one does.
#include <algorithm>

#include "tests/fake_kernel/fake_kms_file.hpp"

namespace depthscope::fake {
namespace {

template <class T>
T* pointer(std::uint64_t address) {
  return reinterpret_cast<T*>(static_cast<std::uintptr_t>(address));
}

/// Fills as many as there is room for and tells how many there are.
template <class T>
void putList(std::uint64_t address, std::uint32_t& count, const std::vector<T>& items) {
  for (std::size_t i = 0; i < std::min<std::size_t>(count, items.size()); ++i)
    pointer<T>(address)[i] = items[i];
  count = static_cast<std::uint32_t>(items.size());
}

/// Only master may change what is on screen.
bool needsMaster(unsigned long request) {
  return request == DRM_IOCTL_MODE_ATOMIC || request == DRM_IOCTL_MODE_SETCRTC;
}

}  // namespace

int FakeKmsCard::ioctl(File& client, unsigned long request, void* argument) {
  if (!present_) return -ENODEV;
  settle();
  if (needsMaster(request) && master_ != &client) return -EACCES;
  switch (request) {
    case DRM_IOCTL_SET_CLIENT_CAP: {
      const auto& cap = *static_cast<drm_set_client_cap*>(argument);
      if (cap.capability != DRM_CLIENT_CAP_ATOMIC) return 0;
      if (!atomic) return -EOPNOTSUPP;
      client.atomic_ = true;
      return 0;
    }
    case DRM_IOCTL_MODE_GETRESOURCES:
      return getResources(*static_cast<drm_mode_card_res*>(argument));
    case DRM_IOCTL_MODE_GETCONNECTOR:
      return getConnector(*static_cast<drm_mode_get_connector*>(argument));
    case DRM_IOCTL_MODE_GETENCODER:
      return getEncoder(*static_cast<drm_mode_get_encoder*>(argument));
    case DRM_IOCTL_MODE_GETCRTC:
      return getCrtc(*static_cast<drm_mode_crtc*>(argument));
    case DRM_IOCTL_MODE_SETCRTC:
      return setCrtc(*static_cast<drm_mode_crtc*>(argument));
    case DRM_IOCTL_MODE_GETPLANERESOURCES:
      return getPlanes(*static_cast<drm_mode_get_plane_res*>(argument));
    case DRM_IOCTL_MODE_GETPLANE:
      return getPlane(*static_cast<drm_mode_get_plane*>(argument));
    case DRM_IOCTL_MODE_OBJ_GETPROPERTIES:
      return getProperties(*static_cast<drm_mode_obj_get_properties*>(argument));
    case DRM_IOCTL_MODE_GETPROPERTY:
      return getProperty(*static_cast<drm_mode_get_property*>(argument));
    case DRM_IOCTL_MODE_CREATEPROPBLOB:
      return createBlob(client, *static_cast<drm_mode_create_blob*>(argument));
    case DRM_IOCTL_MODE_DESTROYPROPBLOB:
      return blobs_.erase(static_cast<drm_mode_destroy_blob*>(argument)->blob_id) ? 0 : -ENOENT;
    case DRM_IOCTL_MODE_CREATE_DUMB:
      return createDumb(client, *static_cast<drm_mode_create_dumb*>(argument));
    case DRM_IOCTL_MODE_MAP_DUMB: {
      auto& map = *static_cast<drm_mode_map_dumb*>(argument);
      map.offset = std::uint64_t{map.handle} << 12;
      return buffers_.contains(map.handle) ? 0 : -ENOENT;
    }
    case DRM_IOCTL_MODE_DESTROY_DUMB:
      return buffers_.erase(static_cast<drm_mode_destroy_dumb*>(argument)->handle) ? 0 : -EINVAL;
    case DRM_IOCTL_PRIME_FD_TO_HANDLE:
      return importDmabuf(client, *static_cast<drm_prime_handle*>(argument));
    case DRM_IOCTL_GEM_CLOSE:
      return buffers_.erase(static_cast<drm_gem_close*>(argument)->handle) ? 0 : -EINVAL;
    case DRM_IOCTL_MODE_ADDFB2:
      return addFramebuffer(client, *static_cast<drm_mode_fb_cmd2*>(argument));
    case DRM_IOCTL_MODE_RMFB: {
      const std::uint32_t id = *static_cast<unsigned*>(argument);
      if (!framebuffers_.contains(id)) return -ENOENT;
      removeFramebuffer(id);
      return 0;
    }
    case DRM_IOCTL_MODE_ATOMIC:
      return atomicCommit(client, *static_cast<drm_mode_atomic*>(argument));
    default:
      return -ENOTTY;
  }
}

int FakeKmsCard::getResources(drm_mode_card_res& r) {
  std::vector<std::uint32_t> connectors, encoders;
  for (std::uint32_t i = 0; i < connectors_.size(); ++i) {
    connectors.push_back(first_connector + i);
    encoders.push_back(first_encoder + i);
  }
  putList(r.crtc_id_ptr, r.count_crtcs, std::vector<std::uint32_t>{first_crtc});
  putList(r.connector_id_ptr, r.count_connectors, connectors);
  putList(r.encoder_id_ptr, r.count_encoders, encoders);
  return 0;
}

int FakeKmsCard::getConnector(drm_mode_get_connector& c) {
  const std::size_t index = c.connector_id - first_connector;
  if (index >= connectors_.size()) return -ENOENT;
  if (c.count_modes == 0) ++probes_;
  const Connector& connector = connectors_[index];
  const std::vector<drm_mode_modeinfo> none;
  const auto& modes = connector.connected ? connector.modes : none;
  const std::uint32_t encoder = first_encoder + static_cast<std::uint32_t>(index);
  if (c.count_modes >= modes.size()) putList(c.modes_ptr, c.count_modes, modes);
  c.count_modes = static_cast<std::uint32_t>(modes.size());
  putList(c.encoders_ptr, c.count_encoders, std::vector<std::uint32_t>{encoder});
  c.encoder_id = state_.at(c.connector_id).values.at("CRTC_ID") != 0 ? encoder : 0;
  c.connector_type = connector.type;
  c.connector_type_id = connector.type_id;
  c.connection = connector.connected ? 1 : 2;
  return 0;
}

int FakeKmsCard::getEncoder(drm_mode_get_encoder& e) {
  const std::uint32_t index = e.encoder_id - first_encoder;
  if (index >= connectors_.size()) return -ENOENT;
  e.crtc_id = static_cast<std::uint32_t>(state_.at(first_connector + index).values.at("CRTC_ID"));
  e.possible_crtcs = 1;
  return 0;
}

int FakeKmsCard::getCrtc(drm_mode_crtc& c) {
  if (c.crtc_id != first_crtc) return -ENOENT;
  const drm_mode_modeinfo* m = mode();
  c.mode_valid = m != nullptr;
  if (m != nullptr) c.mode = *m;
  for (const auto& [id, object] : state_)
    if (object.type == DRM_MODE_OBJECT_PLANE && planes_[object.index].type == 1 &&
        object.values.at("CRTC_ID") == c.crtc_id)
      c.fb_id = static_cast<std::uint32_t>(object.values.at("FB_ID"));
  return 0;
}

int FakeKmsCard::setCrtc(const drm_mode_crtc& c) {
  if (c.crtc_id != first_crtc || c.count_connectors != 1) return -EINVAL;
  if (!framebuffers_.contains(c.fb_id)) return -ENOENT;
  pending_.reset();  // the legacy call waits for what is under way
  if (c.fb_id == console_framebuffer_) showConsole();
  return 0;
}

int FakeKmsCard::getPlanes(drm_mode_get_plane_res& r) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 0; i < planes_.size(); ++i) ids.push_back(first_plane + i);
  putList(r.plane_id_ptr, r.count_planes, ids);
  return 0;
}

int FakeKmsCard::getPlane(drm_mode_get_plane& p) {
  const std::size_t index = p.plane_id - first_plane;
  if (index >= planes_.size()) return -ENOENT;
  const auto& values = state_.at(p.plane_id).values;
  p.crtc_id = static_cast<std::uint32_t>(values.at("CRTC_ID"));
  p.fb_id = static_cast<std::uint32_t>(values.at("FB_ID"));
  p.possible_crtcs = 1;
  putList(p.format_type_ptr, p.count_format_types, planes_[index].formats);
  return 0;
}

int FakeKmsCard::getProperties(drm_mode_obj_get_properties& p) {
  const auto found = state_.find(p.obj_id);
  if (found == state_.end() || found->second.type != p.obj_type) return -ENOENT;
  std::vector<std::uint32_t> ids;
  std::vector<std::uint64_t> values;
  for (const auto& [name, value] : found->second.values) {
    ids.push_back(propertyId(name));
    values.push_back(value);
  }
  std::uint32_t count = p.count_props;
  putList(p.prop_values_ptr, count, values);
  putList(p.props_ptr, p.count_props, ids);
  return 0;
}

int FakeKmsCard::getProperty(drm_mode_get_property& p) {
  const std::string name = propertyName(p.prop_id);
  if (name.empty()) return -ENOENT;
  std::snprintf(p.name, sizeof p.name, "%s", name.c_str());
  std::vector<drm_mode_property_enum> values;
  const auto add = [&](std::uint64_t value, const char* text) {
    drm_mode_property_enum& e = values.emplace_back();
    e.value = value;
    std::snprintf(e.name, sizeof e.name, "%s", text);
  };
  if (name == "COLOR_ENCODING") {
    add(4, "ITU-R BT.601 YCbCr");
    add(5, "ITU-R BT.709 YCbCr");
  } else if (name == "COLOR_RANGE") {
    add(7, "YCbCr limited range");
    add(8, "YCbCr full range");
  }
  putList(p.enum_blob_ptr, p.count_enum_blobs, values);
  return 0;
}

int FakeKmsCard::createBlob(const File& client, drm_mode_create_blob& b) {
  b.blob_id = next_id_++;
  const auto* data = pointer<const std::byte>(b.data);
  blobs_[b.blob_id] = {{data, data + b.length}, &client};
  return 0;
}

int FakeKmsCard::createDumb(const File& client, drm_mode_create_dumb& d) {
  d.handle = next_id_++;
  d.pitch = (d.width * d.bpp / 8 + 63) & ~63u;
  d.size = std::uint64_t{d.pitch} * d.height;
  // What was in it before is nobody's business to rely on.
  std::shared_ptr<std::byte[]> memory(new std::byte[d.size]);
  std::memset(memory.get(), 0xa5, d.size);
  buffers_[d.handle] = {std::move(memory), d.width, d.height, d.pitch, d.size, &client};
  return 0;
}

int FakeKmsCard::addFramebuffer(const File& client, drm_mode_fb_cmd2& f) {
  const auto buffer = buffers_.find(f.handles[0]);
  if (buffer == buffers_.end()) return -ENOENT;
  if (refused_framebuffer_formats.contains(f.pixel_format)) return -EINVAL;
  const std::uint32_t pixel_bytes = f.pixel_format == DRM_FORMAT_YUYV ? 2 : 4;
  if (f.pitches[0] < f.width * pixel_bytes ||
      std::uint64_t{f.pitches[0]} * f.height > buffer->second.size)
    return -EINVAL;
  f.fb_id = next_id_++;
  framebuffers_[f.fb_id] = {f.handles[0], f.width, f.height, f.pitches[0], f.pixel_format, &client};
  return 0;
}

int FakeKmsCard::importDmabuf(const File& client, drm_prime_handle& p) {
  const auto* dmabuf = dynamic_cast<const FakeDmabuf*>(kernel_.file(p.fd));
  if (dmabuf == nullptr) return -EBADF;
  p.handle = next_id_++;
  buffers_[p.handle] = {dmabuf->memory, 0, 0, 0, dmabuf->size, &client};
  return 0;
}

/// The state that a request asks for.
int FakeKmsCard::apply(const drm_mode_atomic& a, State& next) const {
  for (auto& [id, object] : next)  // a fence is for one commit
    if (object.type == DRM_MODE_OBJECT_PLANE) object.values["IN_FENCE_FD"] = no_fence;
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < a.count_objs; ++i) {
    const auto object = next.find(pointer<std::uint32_t>(a.objs_ptr)[i]);
    if (object == next.end()) return -ENOENT;
    for (std::uint32_t n = pointer<std::uint32_t>(a.count_props_ptr)[i]; n > 0; --n, ++at) {
      const auto value =
          object->second.values.find(propertyName(pointer<std::uint32_t>(a.props_ptr)[at]));
      if (value == object->second.values.end()) return -ENOENT;
      value->second = pointer<std::uint64_t>(a.prop_values_ptr)[at];
    }
  }
  return 0;
}

bool FakeKmsCard::needsModeset(const State& next) const {
  for (const auto& [id, object] : next) {
    const auto& now = state_.at(id).values;
    for (const char* name : {"ACTIVE", "MODE_ID"})
      if (object.type == DRM_MODE_OBJECT_CRTC && object.values.at(name) != now.at(name))
        return true;
    if (object.type == DRM_MODE_OBJECT_CONNECTOR &&
        object.values.at("CRTC_ID") != now.at("CRTC_ID"))
      return true;
  }
  return false;
}

int FakeKmsCard::checkPlane(const State& next, const Object& plane) const {
  const auto& v = plane.values;
  const auto fb_id = static_cast<std::uint32_t>(v.at("FB_ID"));
  if ((fb_id == 0) != (v.at("CRTC_ID") == 0)) return -EINVAL;
  const std::uint64_t fence = v.at("IN_FENCE_FD");
  if (fence != no_fence && kernel_.file(static_cast<int>(fence)) == nullptr) return -EINVAL;
  if (fb_id == 0 || fb_id == console_framebuffer_) return 0;
  const auto fb = framebuffers_.find(fb_id);
  if (fb == framebuffers_.end()) return -ENOENT;
  const auto& formats = planes_[plane.index].formats;
  if (std::find(formats.begin(), formats.end(), fb->second.format) == formats.end()) return -EINVAL;
  if (v.at("SRC_X") + v.at("SRC_W") > std::uint64_t{fb->second.width} << 16 ||
      v.at("SRC_Y") + v.at("SRC_H") > std::uint64_t{fb->second.height} << 16)
    return -ENOSPC;
  if (v.at("SRC_W") >> 16 != v.at("CRTC_W") || v.at("SRC_H") >> 16 != v.at("CRTC_H"))
    return -ERANGE;  // it cannot scale
  const auto blob =
      blobs_.find(static_cast<std::uint32_t>(next.at(first_crtc).values.at("MODE_ID")));
  if (blob == blobs_.end()) return -EINVAL;
  drm_mode_modeinfo m;
  std::memcpy(&m, blob->second.bytes.data(), sizeof m);
  if (m.hdisplay == refused_width) return -EINVAL;
  // A primary plane covers the whole screen.
  if (planes_[plane.index].type == 1 &&
      (v.at("CRTC_W") != m.hdisplay || v.at("CRTC_H") != m.vdisplay))
    return -EINVAL;
  return 0;
}

int FakeKmsCard::check(const State& next, bool allow_modeset) const {
  if (needsModeset(next) && !allow_modeset) return -EINVAL;
  bool connector_on = false;
  for (const auto& [id, object] : next)
    if (object.type == DRM_MODE_OBJECT_CONNECTOR)
      connector_on |= object.values.at("CRTC_ID") == first_crtc;
  int planes_on = 0;
  for (const auto& [id, object] : next)
    if (object.type == DRM_MODE_OBJECT_PLANE) planes_on += object.values.at("FB_ID") != 0;
  if (planes_on > 1 && !planes_work) return -EINVAL;
  const auto& crtc = next.at(first_crtc).values;
  if (crtc.at("ACTIVE") == 1 && !connector_on) return -EINVAL;
  for (const auto& [id, object] : next)
    if (object.type == DRM_MODE_OBJECT_PLANE)
      if (const int error = checkPlane(next, object)) return error;
  return 0;
}

int FakeKmsCard::atomicCommit(File& client, const drm_mode_atomic& a) {
  if (!client.atomic_) return -EINVAL;
  const bool test = (a.flags & DRM_MODE_ATOMIC_TEST_ONLY) != 0;
  const bool event = (a.flags & DRM_MODE_PAGE_FLIP_EVENT) != 0;
  if (test && event) return -EINVAL;
  State next = state_;
  if (const int error = apply(a, next)) return error;
  if (const int error = check(next, (a.flags & DRM_MODE_ATOMIC_ALLOW_MODESET) != 0)) return error;
  if (test) return refuse_test_of_modes && needsModeset(next) ? -EINVAL : 0;
  if (pending_) {
    if ((a.flags & DRM_MODE_ATOMIC_NONBLOCK) != 0) return -EBUSY;
    pending_.reset();
  }
  const bool modeset = needsModeset(next);
  if (state_.at(first_crtc).values["ACTIVE"] == 1 && next.at(first_crtc).values["ACTIVE"] == 0)
    ++switched_off_;
  state_ = std::move(next);
  if (modeset) ++modesets_;
  const auto modeset_time = std::chrono::milliseconds(modeset ? 40 : 0);
  pending_ = Pending{nextVblank() + modeset_time, event, a.user_data, &client};
  return 0;
}

}  // namespace depthscope::fake
