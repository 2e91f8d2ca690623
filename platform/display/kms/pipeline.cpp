#include "platform/display/kms/pipeline.hpp"

#include <drm_fourcc.h>

#include <algorithm>

namespace depthscope::platform::kms {
namespace {

constexpr std::uint64_t primary_plane = 1;  // of the "type" property: DRM_PLANE_TYPE_PRIMARY

std::uint32_t idOf(const Properties& properties, std::string_view name) {
  const auto found = properties.find(name);
  return found == properties.end() ? 0 : found->second.id;
}

std::uint64_t valueOf(const Properties& properties, std::string_view name) {
  const auto found = properties.find(name);
  return found == properties.end() ? 0 : found->second.value;
}

PlaneProperties planeProperties(std::uint32_t plane, const Properties& p) {
  return {plane,
          idOf(p, "FB_ID"),
          idOf(p, "CRTC_ID"),
          idOf(p, "SRC_X"),
          idOf(p, "SRC_Y"),
          idOf(p, "SRC_W"),
          idOf(p, "SRC_H"),
          idOf(p, "CRTC_X"),
          idOf(p, "CRTC_Y"),
          idOf(p, "CRTC_W"),
          idOf(p, "CRTC_H"),
          idOf(p, "IN_FENCE_FD")};
}

/// The CRTC that the connector is on, else one that is free, else any that it can have.
int findCrtc(const Card& card, const Connector& connector, std::uint32_t& crtc,
             std::uint32_t& index) {
  std::vector<std::uint32_t> crtcs;
  if (const int error = card.crtcs(crtcs)) return error;
  std::uint32_t possible = 0;
  for (const std::uint32_t id : connector.encoders) {
    drm_mode_get_encoder encoder;
    if (const int error = card.encoder(id, encoder)) return error;
    possible |= encoder.possible_crtcs;
    if (id == connector.encoder && encoder.crtc_id != 0) crtc = encoder.crtc_id;
  }
  bool is_free = crtc != 0;
  for (index = 0; index < crtcs.size() && !is_free; ++index) {
    if ((possible >> index & 1) == 0) continue;
    drm_mode_crtc state;
    if (const int error = card.crtc(crtcs[index], state)) return error;
    is_free = state.mode_valid == 0;
    if (is_free || crtc == 0) crtc = crtcs[index];
  }
  index = static_cast<std::uint32_t>(std::find(crtcs.begin(), crtcs.end(), crtc) - crtcs.begin());
  return crtc != 0 && index < crtcs.size() ? 0 : -ENOTSUP;
}

/// Reads which numbers the driver has for these names.
template <std::size_t Count>
int readEnum(const Card& card, const Properties& p, std::string_view property,
             const std::array<std::string_view, Count>& names, EnumProperty<Count>& out) {
  out.id = idOf(p, property);
  if (out.id == 0) return 0;
  std::vector<drm_mode_property_enum> offered;
  if (const int error = card.enumValues(out.id, offered)) return error;
  for (const drm_mode_property_enum& value : offered)
    for (std::size_t i = 0; i < Count; ++i)
      if (names[i] == value.name) out.values[i] = value.value;
  return 0;
}

int readPlane(const Card& card, Plane& plane, std::uint32_t crtc, PlaneUnit& unit) {
  Properties p;
  if (const int error = card.properties(plane.id, DRM_MODE_OBJECT_PLANE, p)) return error;
  unit.properties = planeProperties(plane.id, p);
  unit.primary = valueOf(p, "type") == primary_plane;
  unit.in_use = plane.crtc == crtc;
  unit.formats = std::move(plane.formats);
  if (p.contains("zpos")) unit.zpos = valueOf(p, "zpos");
  const int error = readEnum<4>(
      card, p, "COLOR_ENCODING",
      {"RGB", "ITU-R BT.601 YCbCr", "ITU-R BT.709 YCbCr", "ITU-R BT.2020 YCbCr"}, unit.encoding);
  if (error != 0) return error;
  return readEnum<2>(card, p, "COLOR_RANGE", {"YCbCr limited range", "YCbCr full range"},
                     unit.range);
}

int findPlanes(const Card& card, std::uint32_t crtc_index, Pipeline& out) {
  std::vector<Plane> planes;
  if (const int error = card.planes(planes)) return error;
  bool found = false;
  for (Plane& plane : planes) {
    const bool ours = plane.crtc == 0 || plane.crtc == out.crtc;
    if ((plane.possible_crtcs >> crtc_index & 1) == 0 || !ours) continue;
    PlaneUnit unit;
    if (const int error = readPlane(card, plane, out.crtc, unit)) return error;
    if (unit.primary && !found) {
      found = true;
      out.primary = std::move(unit);
    } else {
      out.others.push_back(std::move(unit));
    }
  }
  return found ? 0 : -ENOTSUP;
}

int findOtherConnectors(const Card& card, Pipeline& out) {
  std::vector<std::uint32_t> ids;
  if (const int error = card.connectors(ids)) return error;
  for (const std::uint32_t id : ids) {
    if (id == out.connector.id) continue;
    Properties p;
    if (const int error = card.properties(id, DRM_MODE_OBJECT_CONNECTOR, p)) return error;
    if (valueOf(p, "CRTC_ID") == out.crtc)
      out.connectors_in_use.emplace_back(id, idOf(p, "CRTC_ID"));
  }
  return 0;
}

}  // namespace

void PlaneProperties::show(AtomicRequest& request, std::uint32_t crtc_id, std::uint32_t framebuffer,
                           int x, int y, int width, int height) const {
  const auto fixed = [](int value) { return static_cast<std::uint64_t>(value) << 16; };
  request.add(plane, fb, framebuffer);
  request.add(plane, crtc, crtc_id);
  request.add(plane, src_x, 0);
  request.add(plane, src_y, 0);
  request.add(plane, src_w, fixed(width));
  request.add(plane, src_h, fixed(height));
  request.add(plane, crtc_x, static_cast<std::uint64_t>(static_cast<std::int64_t>(x)));
  request.add(plane, crtc_y, static_cast<std::uint64_t>(static_cast<std::int64_t>(y)));
  request.add(plane, crtc_w, static_cast<std::uint64_t>(width));
  request.add(plane, crtc_h, static_cast<std::uint64_t>(height));
}

void PlaneProperties::hide(AtomicRequest& request) const {
  request.add(plane, fb, 0);
  request.add(plane, crtc, 0);
}

void Pipeline::light(AtomicRequest& request, std::uint32_t mode_blob) const {
  constexpr std::uint64_t link_good = DRM_MODE_LINK_STATUS_GOOD;
  for (const auto& [other, property] : connectors_in_use) request.add(other, property, 0);
  for (const PlaneUnit& plane : others)
    if (plane.in_use) plane.properties.hide(request);
  request.add(connector.id, connector_crtc, crtc);
  request.add(connector.id, connector_link_status, link_good);
  request.add(crtc, crtc_mode, mode_blob);
  request.add(crtc, crtc_active, 1);
}

int findPipeline(const Card& card, const Connector& connector, Pipeline& out) {
  out = {};
  out.connector = connector;
  std::uint32_t index = 0;
  if (const int error = findCrtc(card, connector, out.crtc, index)) return error;
  Properties p;
  if (const int error = card.properties(connector.id, DRM_MODE_OBJECT_CONNECTOR, p)) return error;
  out.connector_crtc = idOf(p, "CRTC_ID");
  out.connector_link_status = idOf(p, "link-status");
  if (const int error = card.properties(out.crtc, DRM_MODE_OBJECT_CRTC, p)) return error;
  out.crtc_mode = idOf(p, "MODE_ID");
  out.crtc_active = idOf(p, "ACTIVE");
  if (const int error = findPlanes(card, index, out)) return error;
  return findOtherConnectors(card, out);
}

}  // namespace depthscope::platform::kms
