#include "platform/ipc/surface_mailbox.hpp"

#include <cmath>

namespace depthscope::platform {

static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12 &&
              sizeof(Rgb) == 3);
namespace {

/// Bytes that the elements of an array take.
template <class T>
std::size_t bytesOf(const std::vector<T>& array) {
  return array.size() * sizeof(T);
}

/// Whether an array goes along with the vertices, or is left out.
bool parallelOrNone(std::size_t size, std::size_t vertices) {
  return size == 0 || size == vertices;
}

bool parallel(const SurfaceMesh& mesh) {
  const std::size_t vertices = mesh.vertices.size();
  return mesh.normals.size() == vertices && mesh.confidence.size() == vertices &&
         parallelOrNone(mesh.observations.size(), vertices) &&
         parallelOrNone(mesh.colors.size(), vertices);
}

}  // namespace

bool SurfaceMailboxWriter::publish(const SurfaceMesh& mesh) {
  const SharedCapacity& c = memory_.capacity();
  if (mesh.vertices.size() > c.max_vertices || mesh.triangles.size() > c.max_triangles)
    return false;
  if (!parallel(mesh)) return false;
  SharedBlock& block = memory_.block();
  // A writer that starts anew goes on from the count that its predecessor left; only readers need
  // to distrust it.
  const std::uint64_t next = block.surfaces_published.load(std::memory_order_relaxed) + 1;
  const auto slot = static_cast<std::uint32_t>(next % 2);
  const SurfaceArrays to = memory_.surface(slot);
  const WireSurfaceInfo info{mesh.map_id,
                             mesh.version,
                             static_cast<std::uint32_t>(mesh.vertices.size()),
                             static_cast<std::uint32_t>(mesh.triangles.size()),
                             static_cast<std::uint32_t>(mesh.observations.size()),
                             static_cast<std::uint32_t>(mesh.colors.size())};
  SharedBlock::SurfaceSlot& head = block.surfaces[slot];
  seqlock::beginWrite(head.count);
  seqlock::store(head.info, &info, sizeof info);
  seqlock::store(to.vertices, mesh.vertices.data(), bytesOf(mesh.vertices));
  seqlock::store(to.normals, mesh.normals.data(), bytesOf(mesh.normals));
  seqlock::store(to.confidence, mesh.confidence.data(), bytesOf(mesh.confidence));
  seqlock::store(to.observations, mesh.observations.data(), bytesOf(mesh.observations));
  seqlock::store(to.colors, mesh.colors.data(), bytesOf(mesh.colors));
  seqlock::store(to.triangles, mesh.triangles.data(), bytesOf(mesh.triangles));
  seqlock::endWrite(head.count);
  block.surfaces_published.store(next, std::memory_order_release);
  return true;
}

bool isSound(const SurfaceMesh& mesh) {
  if (!parallel(mesh)) return false;
  // Coordinates beyond 1e18 are none of ours, and squaring them would overflow.
  constexpr float largest = 1e18f;
  for (const Eigen::Vector3f& v : mesh.vertices)
    if (!(v.cwiseAbs().maxCoeff() < largest) || !v.allFinite()) return false;
  for (const Eigen::Vector3f& n : mesh.normals)
    if (!(n.squaredNorm() < 1.5f) || !n.allFinite()) return false;
  for (float c : mesh.confidence)
    if (!(c >= 0 && c <= 1)) return false;
  const std::size_t vertices = mesh.vertices.size();
  for (const auto& t : mesh.triangles)
    if (t[0] >= vertices || t[1] >= vertices || t[2] >= vertices) return false;
  return true;
}

SurfaceMailboxReader::Result SurfaceMailboxReader::takeNewest(SurfaceMesh& mesh) {
  const SharedCapacity& c = memory_.capacity();
  const SharedBlock& block = memory_.block();
  const std::uint64_t published = block.surfaces_published.load(std::memory_order_acquire);
  if (published == 0 || published == seen_) return Result::Nothing;
  const auto slot = static_cast<std::uint32_t>(published % 2);
  const SharedBlock::SurfaceSlot& head = block.surfaces[slot];
  const std::uint64_t before = seqlock::beginRead(head.count);
  WireSurfaceInfo info;
  seqlock::load(&info, head.info, sizeof info);
  if (info.vertices > c.max_vertices || info.triangles > c.max_triangles ||
      !parallelOrNone(info.observations, info.vertices) ||
      !parallelOrNone(info.colors, info.vertices)) {
    if (!seqlock::endRead(head.count, before))
      return Result::Nothing;  // torn: whole at the next look
    seen_ = published;
    return Result::Rejected;
  }
  const SurfaceArrays from = memory_.surface(slot);
  mesh.map_id = info.map_id;
  mesh.version = info.version;
  mesh.vertices.resize(info.vertices);
  mesh.normals.resize(info.vertices);
  mesh.confidence.resize(info.vertices);
  mesh.observations.resize(info.observations);
  mesh.colors.resize(info.colors);
  mesh.triangles.resize(info.triangles);
  seqlock::load(mesh.vertices.data(), from.vertices, bytesOf(mesh.vertices));
  seqlock::load(mesh.normals.data(), from.normals, bytesOf(mesh.normals));
  seqlock::load(mesh.confidence.data(), from.confidence, bytesOf(mesh.confidence));
  seqlock::load(mesh.observations.data(), from.observations, bytesOf(mesh.observations));
  seqlock::load(mesh.colors.data(), from.colors, bytesOf(mesh.colors));
  seqlock::load(mesh.triangles.data(), from.triangles, bytesOf(mesh.triangles));
  if (before == 0 || !seqlock::endRead(head.count, before)) return Result::Nothing;
  seen_ = published;
  return isSound(mesh) ? Result::Taken : Result::Rejected;
}

void reserve(SurfaceMesh& mesh, const SharedCapacity& capacity) {
  mesh.vertices.reserve(capacity.max_vertices);
  mesh.normals.reserve(capacity.max_vertices);
  mesh.confidence.reserve(capacity.max_vertices);
  mesh.observations.reserve(capacity.max_vertices);
  mesh.colors.reserve(capacity.max_vertices);
  mesh.triangles.reserve(capacity.max_triangles);
}

}  // namespace depthscope::platform
