#include "platform/display/kms/card.hpp"

#include <fcntl.h>

#include <algorithm>
#include <array>

namespace depthscope::platform::kms {
namespace {

constexpr const char* dri_folder = "/dev/dri";
constexpr int patience = 8;       // tries of a call that is interrupted
constexpr int growth_rounds = 4;  // of a list that grows while it is read

std::uint64_t pointer(const void* p) {
  return reinterpret_cast<std::uintptr_t>(p);
}

/// Reads a list whose length the kernel knows. `read(items, count)` fills at most `count` items
/// (none for 0) and sets `count` to how many there are; a list that grew meanwhile is read again.
template <class T, class Read>
int readList(std::vector<T>& items, std::uint32_t expected, const Read& read) {
  std::uint32_t count = expected;
  for (int round = 0; round < growth_rounds; ++round) {
    items.assign(count, T{});
    if (const int error = read(items.data(), count)) return error;
    if (count <= items.size()) {
      items.resize(count);
      return 0;
    }
  }
  return -EAGAIN;
}

/// The kernel's names (drm_connector.c), by DRM_MODE_CONNECTOR_...
std::string connectorName(std::uint32_t type, std::uint32_t number) {
  constexpr std::array names{"Unknown",   "VGA",  "DVI-I",     "DVI-D",   "DVI-A", "Composite",
                             "SVIDEO",    "LVDS", "Component", "DIN",     "DP",    "HDMI-A",
                             "HDMI-B",    "TV",   "eDP",       "Virtual", "DSI",   "DPI",
                             "Writeback", "SPI",  "USB"};
  return std::string(names[type < names.size() ? type : 0]) + "-" + std::to_string(number);
}

std::string baseName(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

}  // namespace

int Card::open(kernel::SystemCalls& calls, const std::string& path, Card& card) {
  Card opened;
  opened.calls_ = &calls;
  opened.fd_ = kernel::OwnedFd(calls, kernel::retryInterrupted([&] {
                                 return calls.open(path.c_str(), O_RDWR | O_NONBLOCK);
                               }));
  if (!opened.fd_.valid()) return opened.fd_.get();
  std::string target;  // paths in /dev/dri/by-path are links
  opened.name_ = baseName(calls.readLink(path.c_str(), target) == 0 ? target : path);
  for (const std::uint64_t capability :
       {std::uint64_t{DRM_CLIENT_CAP_UNIVERSAL_PLANES}, std::uint64_t{DRM_CLIENT_CAP_ATOMIC}}) {
    drm_set_client_cap wanted{capability, 1};
    if (const int error = opened.ioctl(DRM_IOCTL_SET_CLIENT_CAP, &wanted)) return error;
  }
  card = std::move(opened);
  return 0;
}

int Card::ioctl(unsigned long request, void* argument) const {
  int result = 0;
  for (int i = 0; i < patience; ++i) {
    result = calls_->ioctl(fd_.get(), request, argument);
    if (result != -EINTR && result != -EAGAIN) break;
  }
  return result < 0 ? result : 0;
}

void Card::release(unsigned long request, void* argument) {
  leaked_ |= ioctl(request, argument) != 0;
}

int Card::resources(std::vector<std::uint32_t>& crtc_ids,
                    std::vector<std::uint32_t>& connector_ids) const {
  for (int round = 0; round < growth_rounds; ++round) {
    drm_mode_card_res r{};
    r.crtc_id_ptr = pointer(crtc_ids.data());
    r.count_crtcs = static_cast<std::uint32_t>(crtc_ids.size());
    r.connector_id_ptr = pointer(connector_ids.data());
    r.count_connectors = static_cast<std::uint32_t>(connector_ids.size());
    if (const int error = ioctl(DRM_IOCTL_MODE_GETRESOURCES, &r)) return error;
    const bool complete =
        r.count_crtcs <= crtc_ids.size() && r.count_connectors <= connector_ids.size();
    crtc_ids.resize(r.count_crtcs);
    connector_ids.resize(r.count_connectors);
    if (complete) return 0;
  }
  return -EAGAIN;
}

int Card::crtcs(std::vector<std::uint32_t>& ids) const {
  std::vector<std::uint32_t> others;
  ids.clear();
  return resources(ids, others);
}

int Card::connectors(std::vector<std::uint32_t>& ids) const {
  std::vector<std::uint32_t> others;
  ids.clear();
  return resources(others, ids);
}

int Card::connector(std::uint32_t id, bool probe, Connector& out) const {
  // The kernel takes a request without room for modes as a request to probe: room comes after that.
  std::vector<drm_mode_modeinfo> modes(probe ? 0 : 1);
  std::vector<std::uint32_t> encoders;
  for (int round = 0; round < growth_rounds; ++round) {
    drm_mode_get_connector c{};
    c.connector_id = id;
    c.modes_ptr = pointer(modes.data());
    c.count_modes = static_cast<std::uint32_t>(modes.size());
    c.encoders_ptr = pointer(encoders.data());
    c.count_encoders = static_cast<std::uint32_t>(encoders.size());
    if (const int error = ioctl(DRM_IOCTL_MODE_GETCONNECTOR, &c)) return error;
    const bool complete = c.count_modes <= modes.size() && c.count_encoders <= encoders.size();
    modes.resize(complete ? c.count_modes : std::max(c.count_modes, 1u));
    encoders.resize(c.count_encoders);
    if (!complete) continue;
    out.id = id;
    out.name = connectorName(c.connector_type, c.connector_type_id);
    out.connected = c.connection == 1;  // enum drm_connector_status: 1 connected, 2 not, 3 unknown
    out.encoder = c.encoder_id;
    out.encoders = std::move(encoders);
    out.modes = std::move(modes);
    return 0;
  }
  return -EAGAIN;
}

int Card::encoder(std::uint32_t id, drm_mode_get_encoder& out) const {
  out = {};
  out.encoder_id = id;
  return ioctl(DRM_IOCTL_MODE_GETENCODER, &out);
}

int Card::crtc(std::uint32_t id, drm_mode_crtc& out) const {
  out = {};
  out.crtc_id = id;
  return ioctl(DRM_IOCTL_MODE_GETCRTC, &out);
}

int Card::planes(std::vector<Plane>& out) const {
  std::vector<std::uint32_t> ids;
  const int listed = readList(ids, 0, [&](std::uint32_t* items, std::uint32_t& count) {
    drm_mode_get_plane_res r{pointer(items), count};
    const int error = ioctl(DRM_IOCTL_MODE_GETPLANERESOURCES, &r);
    count = r.count_planes;
    return error;
  });
  if (listed != 0) return listed;
  out.clear();
  for (const std::uint32_t id : ids) {
    Plane& plane = out.emplace_back();
    const int error = readList(plane.formats, 0, [&](std::uint32_t* items, std::uint32_t& count) {
      drm_mode_get_plane p{};
      p.plane_id = id;
      p.format_type_ptr = pointer(items);
      p.count_format_types = count;
      const int failed = ioctl(DRM_IOCTL_MODE_GETPLANE, &p);
      count = p.count_format_types;
      plane.id = id;
      plane.crtc = p.crtc_id;
      plane.possible_crtcs = p.possible_crtcs;
      return failed;
    });
    if (error != 0) return error;
  }
  return 0;
}

int Card::properties(std::uint32_t object, std::uint32_t type, Properties& out) const {
  std::vector<std::uint64_t> values;
  std::vector<std::uint32_t> ids;
  const int listed = readList(ids, 0, [&](std::uint32_t* items, std::uint32_t& count) {
    values.assign(count, 0);
    drm_mode_obj_get_properties p{};
    p.obj_id = object;
    p.obj_type = type;
    p.props_ptr = pointer(items);
    p.prop_values_ptr = pointer(values.data());
    p.count_props = count;
    const int error = ioctl(DRM_IOCTL_MODE_OBJ_GETPROPERTIES, &p);
    count = p.count_props;
    return error;
  });
  if (listed != 0) return listed;
  out.clear();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    drm_mode_get_property property{};
    property.prop_id = ids[i];
    if (const int error = ioctl(DRM_IOCTL_MODE_GETPROPERTY, &property)) return error;
    property.name[sizeof property.name - 1] = '\0';
    out[property.name] = {ids[i], values[i]};
  }
  return 0;
}

int Card::enumValues(std::uint32_t property, std::vector<drm_mode_property_enum>& out) const {
  const int error = readList(out, 0, [&](drm_mode_property_enum* items, std::uint32_t& count) {
    drm_mode_get_property p{};
    p.prop_id = property;
    p.enum_blob_ptr = pointer(items);
    p.count_enum_blobs = count;
    const int failed = ioctl(DRM_IOCTL_MODE_GETPROPERTY, &p);
    count = p.count_enum_blobs;
    return failed;
  });
  for (drm_mode_property_enum& value : out) value.name[sizeof value.name - 1] = '\0';
  return error;
}

std::vector<std::string> cardPaths(kernel::SystemCalls& calls) {
  std::vector<std::string> names, paths;
  calls.list(dri_folder, names);
  for (const std::string& name : names)
    if (name.starts_with("card")) paths.push_back(std::string(dri_folder) + "/" + name);
  return paths;
}

}  // namespace depthscope::platform::kms
