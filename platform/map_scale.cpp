#include "platform/map_scale.hpp"

#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "platform/surface_ray.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr double least_mm = 0.1, most_mm = 500;  // of a length that is picked
constexpr double picking_px = 1.5;               // standard deviation in x and in y, at each end
constexpr double most_uncertain = 0.25;
constexpr double nearest_mm = 1, farthest_mm = 500;  // from the scope to the tissue

std::string text(double value, int digits = 4) {
  std::array<char, 32> out;
  std::snprintf(out.data(), out.size(), "%.*g", digits, value);
  return out.data();
}

std::string text(const Eigen::Vector2d& pixel) {
  return text(pixel.x()) + "," + text(pixel.y());
}

std::optional<double> number(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<Eigen::Vector2d> point(std::string_view word) {
  const auto comma = word.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto x = number(word.substr(0, comma)), y = number(word.substr(comma + 1));
  if (!x || !y) return std::nullopt;
  return Eigen::Vector2d(*x, *y);
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(' '); at != std::string_view::npos;
       at = line.find_first_not_of(' ', at)) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// What was picked, in map units, for any two points near those that were picked.
class PickedLength {
 public:
  PickedLength(const SurfaceMesh& mesh, const CameraModel& camera, const Pose& T_camera_world,
               ScaleRequest::Kind kind)
      : mesh_(mesh), camera_(camera), T_camera_world_(T_camera_world), kind_(kind) {}

  struct Result {
    double length = 0, depth = 0;  // [map unit]; depth along the optical axis, in the middle
  };
  /// Nothing where a line of sight misses the surface.
  std::optional<Result> between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    const Ray ray_a = rayThrough(camera_, T_camera_world_, a);
    const Ray ray_b = rayThrough(camera_, T_camera_world_, b);
    if (kind_ == ScaleRequest::Kind::Diameter) {
      const auto z = depthAt((a + b) / 2);
      if (!z) return std::nullopt;
      return Result{(ray_a.at(*z) - ray_b.at(*z)).norm(), *z};
    }
    const auto z_a = firstHit(mesh_, ray_a), z_b = firstHit(mesh_, ray_b);
    if (!z_a || !z_b) return std::nullopt;
    return Result{(ray_a.at(*z_a) - ray_b.at(*z_b)).norm(), (*z_a + *z_b) / 2};
  }
  std::optional<double> depthAt(const Eigen::Vector2d& pixel) const {
    return firstHit(mesh_, rayThrough(camera_, T_camera_world_, pixel));
  }

 private:
  const SurfaceMesh& mesh_;
  const CameraModel& camera_;
  const Pose& T_camera_world_;
  ScaleRequest::Kind kind_;
};

[[noreturn]] void failOffSurface(const PickedLength& picked, const ScaleRequest& r) {
  const bool across = r.kind == ScaleRequest::Kind::Diameter;
  const Eigen::Vector2d off = across ? (r.a + r.b) / 2 : picked.depthAt(r.a) ? r.b : r.a;
  throw InputError("there is no surface at " + text(off) +
                   (across ? ", the middle between the points" : "") +
                   ", expected points on the surface that is shown");
}

/// Standard deviation of the length by that of the four coordinates.
double pickingError(const PickedLength& picked, const ScaleRequest& r, double length) {
  double variance = 0;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d step = Eigen::Vector4d::Zero();
    step[i] = picking_px;
    const auto fore = picked.between(r.a + step.head<2>(), r.b + step.tail<2>());
    const auto back = picked.between(r.a - step.head<2>(), r.b - step.tail<2>());
    if (!fore && !back)
      throw InputError("the surface ends at " + text(i < 2 ? r.a : r.b) +
                       ", expected points well on it");
    // At an edge of the surface, what one side says.
    const double change =
        fore && back ? (fore->length - back->length) / 2 : (fore ? fore : back)->length - length;
    variance += change * change;
  }
  return std::sqrt(variance);
}

}  // namespace

ScaleRequest parseScaleRequest(std::string_view line) {
  std::vector<std::string_view> words = wordsOf(line);
  ScaleRequest request;
  if (!words.empty() && words.front() == "diameter") {
    request.kind = ScaleRequest::Kind::Diameter;
    words.erase(words.begin());
  }
  const auto fail = [&](const std::string& expected) {
    throw InputError("scale \"" + std::string(line) + "\": expected " + expected);
  };
  if (words.size() != 3) fail("[diameter] MM X1,Y1 X2,Y2");
  const auto mm = number(words[0]);
  if (!mm || *mm < least_mm || *mm > most_mm)
    fail("a length from " + text(least_mm) + " to " + text(most_mm) + " mm");
  const auto a = point(words[1]), b = point(words[2]);
  if (!a || !b) fail("two points X,Y in pixels");
  request.mm = *mm;
  request.a = *a;
  request.b = *b;
  return request;
}

void requireInPicture(const ScaleRequest& request, const CameraModel& camera) {
  for (const Eigen::Vector2d& p : {request.a, request.b})
    if (p.x() < 0 || p.y() < 0 || p.x() >= camera.width || p.y() >= camera.height)
      throw InputError("scale: " + text(p) + " is outside the picture of " +
                       std::to_string(camera.width) + "x" + std::to_string(camera.height));
}

std::string toString(const ScaleRequest& request) {
  return text(request.mm) + (request.kind == ScaleRequest::Kind::Length
                                 ? " mm between two points"
                                 : " mm across an instrument");
}

std::string toString(const MapScale& scale) {
  return text(scale.mm_per_unit, 6) + " mm per unit +- " + text(scale.uncertainty_mm, 2);
}

MapScale measureScale(const SurfaceMesh& mesh, const CameraModel& camera,
                      const Pose& T_camera_world, const ScaleRequest& request) {
  const PickedLength picked(mesh, camera, T_camera_world, request.kind);
  const auto found = picked.between(request.a, request.b);
  if (!found) failOffSurface(picked, request);
  double error = found->length > 0 ? pickingError(picked, request, found->length) / found->length
                                   : most_uncertain * 2;
  // One radius of depth.
  if (request.kind == ScaleRequest::Kind::Diameter)
    error = std::hypot(error, found->length / 2 / found->depth);
  if (error > most_uncertain)
    throw InputError("the scale would be uncertain by " + text(100 * error, 2) +
                     " %, expected points farther apart, away from edges of the surface");
  MapScale scale{mesh.map_id, request.mm / found->length, 0, request};
  scale.uncertainty_mm = error * scale.mm_per_unit;
  const double distance_mm = found->depth * scale.mm_per_unit;
  if (distance_mm < nearest_mm || distance_mm > farthest_mm)
    throw InputError("by " + text(request.mm) + " mm the tissue would be " + text(distance_mm, 2) +
                     " mm away, expected " + text(nearest_mm) + " to " + text(farthest_mm) + " mm");
  return scale;
}

}  // namespace depthscope::platform
