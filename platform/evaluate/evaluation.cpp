#include "platform/evaluate/evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "platform/camera_file.hpp"
#include "platform/png_reader.hpp"
#include "recon/mesh_geometry.hpp"
#include "recon/mesh_io.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMinTriangles = 50;
constexpr double kSamplesPerMm2 = 3;
constexpr double kMinSamples = 60000, kMaxSamples = 500000;
constexpr double kMinDepth_mm = 5, kMaxDepth_mm = 140;  // what counts as seen by an endoscope
constexpr int kDepthMargin_px = 20, kDepthStride_px = 4;
constexpr double kSeenVoxel_mm = 2;  // one point of what was seen in each

/// Files of `depth/`, in the order of their names; the name is the number of the frame.
std::vector<fs::path> depthFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::size_t frameNumber(const fs::path& file) {
  try {
    return std::stoul(file.stem().string());
  } catch (const std::exception&) {
    throw InputError(file.string() + ": expected a depth map named by its frame, as 000090.png");
  }
}

/// Points of one depth map in the world of the truth.
void addSeen(const fs::path& file, const CameraModel& camera, const StampedPose& pose,
             std::vector<Eigen::Vector3d>& seen) {
  const Gray16Picture depth = readGray16Png(file);
  if (depth.width != camera.width || depth.height != camera.height)
    throw InputError(file.string() + ": its size is not that of camera.yaml");
  const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
  for (int y = kDepthMargin_px; y < depth.height - kDepthMargin_px; y += kDepthStride_px)
    for (int x = kDepthMargin_px; x < depth.width - kDepthMargin_px; x += kDepthStride_px) {
      const double z = depth.at(x, y) / 100.;
      if (z <= kMinDepth_mm || z >= kMaxDepth_mm) continue;
      const Eigen::Vector2d ray = camera.unproject({x, y});
      seen.push_back(R * (Eigen::Vector3d(ray.x(), ray.y(), 1) * z) + pose.position);
    }
}

/// The first point of each voxel.
std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points) {
  std::set<std::array<int, 3>> taken;
  std::vector<Eigen::Vector3d> out;
  for (const auto& p : points) {
    const Eigen::Vector3i v = (p / kSeenVoxel_mm).array().floor().cast<int>();
    if (taken.insert({v.x(), v.y(), v.z()}).second) out.push_back(p);
  }
  return out;
}

/// What the camera saw while it was tracked.
std::vector<Eigen::Vector3d> seenPoints(const fs::path& sequence_dir,
                                        const Evaluation& evaluation) {
  const std::vector<fs::path> files = depthFiles(sequence_dir / "depth");
  if (files.empty()) return {};
  const CameraModel camera = loadCameraFile(sequence_dir / "camera.yaml");
  const std::set<std::size_t> tracked(evaluation.trajectory.truth_index.begin(),
                                      evaluation.trajectory.truth_index.end());
  std::vector<Eigen::Vector3d> seen;
  for (const auto& file : files) {
    const std::size_t frame = frameNumber(file);
    if (tracked.contains(frame)) addSeen(file, camera, evaluation.truth[frame], seen);
  }
  return thinned(seen);
}

void measureCompleteness(const std::vector<Eigen::Vector3d>& seen, const SurfaceSamples& samples,
                         SurfaceError& out) {
  out.has_completeness = !seen.empty();
  if (seen.empty()) return;
  const PointIndex index(samples.points);
  for (const auto& p : seen) {
    const float d = index.nearest(p.cast<float>()).distance;
    for (std::size_t i = 0; i < out.complete_mm.size(); ++i)
      out.complete_percent[i] += d < out.complete_mm[i];
  }
  for (double& percent : out.complete_percent) percent *= 100. / static_cast<double>(seen.size());
}

std::optional<SurfaceError> evaluateSurface(const fs::path& sequence_dir, const fs::path& run_dir,
                                            const Evaluation& evaluation) {
  SurfaceError out;
  out.mesh = recon::readPly(run_dir / "surface.ply");
  if (out.mesh.triangles.size() < kMinTriangles) return std::nullopt;
  const Similarity& T = evaluation.trajectory.T_truth_estimate;
  for (auto& v : out.mesh.vertices) v = (T * v.cast<double>()).cast<float>();
  recon::computeNormals(out.mesh);
  out.area_mm2 = surfaceArea(out.mesh);
  const SurfaceSamples samples =
      sampleSurface(out.mesh, static_cast<std::size_t>(std::clamp(kSamplesPerMm2 * out.area_mm2,
                                                                  kMinSamples, kMaxSamples)));
  if (samples.points.empty()) return std::nullopt;

  const TrueSurface truth(recon::readPly(sequence_dir / "scene.ply"));
  const auto distance = [&](const Eigen::Vector3f& p) { return truth.distance(p); };
  out.distance.resize(samples.points.size());
  std::transform(samples.points.begin(), samples.points.end(), out.distance.begin(), distance);
  out.vertex_distance.resize(out.mesh.vertices.size());
  std::transform(out.mesh.vertices.begin(), out.mesh.vertices.end(), out.vertex_distance.begin(),
                 distance);
  out.statistics = summarize(out.distance);
  measureCompleteness(seenPoints(sequence_dir, evaluation), samples, out);
  return out;
}

}  // namespace

Evaluation evaluateRun(const fs::path& sequence_dir, const fs::path& run_dir) {
  Evaluation out;
  out.truth = readTrajectory(sequence_dir / "groundtruth.txt");
  if (out.truth.empty())
    throw InputError((sequence_dir / "groundtruth.txt").string() + ": has no poses");
  out.trajectory = compareTrajectories(out.truth, readTrajectory(run_dir / "trajectory.txt"));
  if (fs::exists(run_dir / "trajectory_live.txt"))
    out.live = compareTrajectories(out.truth, readTrajectory(run_dir / "trajectory_live.txt"));
  const bool has_surfaces =
      fs::exists(run_dir / "surface.ply") && fs::exists(sequence_dir / "scene.ply");
  if (!out.trajectory.empty() && has_surfaces)
    out.surface = evaluateSurface(sequence_dir, run_dir, out);
  return out;
}

}  // namespace depthscope::platform
