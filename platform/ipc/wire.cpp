#include "platform/ipc/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "platform/utf8.hpp"

namespace depthscope::platform {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// A rotation to within what rounding may do to it.
bool isRotation(const Eigen::Matrix3d& R) {
  return R.allFinite() &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         R.determinant() > 0;
}

void putText(char (&to)[max_label_bytes], std::string_view text) {
  const std::string_view cut = utf8Prefix(text, max_label_bytes - 1);
  std::memset(to, 0, sizeof to);
  std::memcpy(to, cut.data(), cut.size());
}

/// The text, or an empty view if it does not end or is not printable UTF-8.
std::string_view takeText(const char (&from)[max_label_bytes]) {
  const void* end = std::memchr(from, 0, sizeof from);
  if (end == nullptr) return {};
  const std::string_view text(from, static_cast<std::size_t>(static_cast<const char*>(end) - from));
  return isPrintableUtf8(text) ? text : std::string_view();
}

}  // namespace

WirePose encodePose(const PoseEstimate& e) {
  WirePose wire{};
  wire.frame = e.frame;
  wire.timestamp_s = e.timestamp_s;
  Eigen::Map<RowMajor>(wire.R) = e.T_camera_world.R;
  Eigen::Map<Eigen::Vector3d>(wire.t) = e.T_camera_world.t;
  wire.confidence = e.confidence;
  wire.map_id = e.map_id;
  wire.inliers = e.inliers;
  wire.state = static_cast<std::uint32_t>(e.state);
  return wire;
}

bool decodePose(const WirePose& wire, PoseEstimate& estimate) {
  if (wire.state > static_cast<std::uint32_t>(TrackingState::Lost)) return false;
  if (wire.frame < 0 || !std::isfinite(wire.timestamp_s) || wire.inliers < 0) return false;
  if (!(wire.confidence >= 0 && wire.confidence <= 1)) return false;
  PoseEstimate e;
  e.state = static_cast<TrackingState>(wire.state);
  if (e.state == TrackingState::Tracking) {
    e.T_camera_world.R = Eigen::Map<const RowMajor>(wire.R);
    e.T_camera_world.t = Eigen::Map<const Eigen::Vector3d>(wire.t);
    if (!isRotation(e.T_camera_world.R) || !e.T_camera_world.t.allFinite()) return false;
  }
  e.frame = wire.frame;
  e.timestamp_s = wire.timestamp_s;
  e.confidence = wire.confidence;
  e.map_id = wire.map_id;
  e.inliers = wire.inliers;
  estimate = e;
  return true;
}

WireLabels encodeLabels(std::span<const Label> labels) {
  WireLabels wire{};
  wire.count = static_cast<std::uint32_t>(std::min(labels.size(), max_wire_labels));
  for (std::size_t i = 0; i < wire.count; ++i) {
    WireLabel& to = wire.labels[i];
    to.id = labels[i].id;
    to.map_id = labels[i].map_id;
    Eigen::Map<Eigen::Vector3f>(to.anchor) = labels[i].anchor;
    putText(to.text, labels[i].text);
  }
  return wire;
}

bool decodeLabels(const WireLabels& wire, std::vector<Label>& labels) {
  if (wire.count > max_wire_labels) return false;
  for (std::size_t i = 0; i < wire.count; ++i) {
    const WireLabel& from = wire.labels[i];
    if (!Eigen::Map<const Eigen::Vector3f>(from.anchor).allFinite() || takeText(from.text).empty())
      return false;
  }
  labels.resize(wire.count);
  for (std::size_t i = 0; i < wire.count; ++i) {
    const WireLabel& from = wire.labels[i];
    labels[i].id = from.id;
    labels[i].map_id = from.map_id;
    labels[i].anchor = Eigen::Map<const Eigen::Vector3f>(from.anchor);
    labels[i].text = takeText(from.text);
  }
  return true;
}

WireView encodeView(const ViewOutline& view) {
  WireView wire{};
  for (std::size_t i = 0; i < view.spans.size(); ++i) {
    wire.ends[i][0] = view.spans[i].left;
    wire.ends[i][1] = view.spans[i].right;
  }
  return wire;
}

bool decodeView(const WireView& wire, ViewOutline& view) {
  for (const auto& ends : wire.ends)
    if (!std::isfinite(ends[0]) || !std::isfinite(ends[1])) return false;
  for (std::size_t i = 0; i < view.spans.size(); ++i)
    view.spans[i] = {wire.ends[i][0], wire.ends[i][1]};
  return true;
}

bool plausible(const WireArStatus& s) {
  const auto time = [](double ms) { return std::isfinite(ms) && ms >= 0; };
  return s.keyframes >= 0 && s.map_points >= 0 && s.maps >= 0 && s.lost_events >= 0 &&
         s.relocalizations >= 0 && s.loops_closed >= 0 && s.tracked_frames >= 0 &&
         s.dropped_frames >= 0 && s.surfaces >= 0 && time(s.track_p50_ms) && time(s.track_p95_ms) &&
         time(s.reconstruct_p50_ms) && time(s.readout_ms) && s.keyframe_capacity >= 0 &&
         s.map_point_capacity >= 0 && s.slam_bytes >= 0;
}

WireCommand encodeCommand(WireCommand::Kind kind, const LabelRequest& label) {
  WireCommand wire{};
  wire.kind = kind;
  wire.x = static_cast<float>(label.pixel.x());
  wire.y = static_cast<float>(label.pixel.y());
  putText(wire.text, label.text);
  return wire;
}

WireCommand encodeSurfacePeriod(double period_s) {
  WireCommand wire{};
  wire.kind = WireCommand::SurfacePeriod;
  wire.x = static_cast<float>(period_s);
  return wire;
}

bool decodeCommand(const WireCommand& wire, WireCommand::Kind& kind, LabelRequest& label) {
  if (wire.kind < WireCommand::Reconstruct || wire.kind > WireCommand::SurfacePeriod) return false;
  if (wire.kind == WireCommand::Label) {
    const std::string_view text = takeText(wire.text);
    if (text.empty() || !std::isfinite(wire.x) || !std::isfinite(wire.y)) return false;
    label = {std::string(text), {wire.x, wire.y}};
  }
  if (wire.kind == WireCommand::SurfacePeriod && !(std::isfinite(wire.x) && wire.x >= 0))
    return false;
  kind = static_cast<WireCommand::Kind>(wire.kind);
  return true;
}

}  // namespace depthscope::platform
