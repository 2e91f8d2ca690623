#include "platform/ipc/surface_mailbox.hpp"

#include <cmath>

namespace depthscope::platform {

static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12);

bool SurfaceMailboxWriter::publish(const SurfaceMesh& mesh) {
  const SharedCapacity& c = memory_.capacity();
  if (mesh.vertices.size() > c.max_vertices || mesh.triangles.size() > c.max_triangles)
    return false;
  if (mesh.normals.size() != mesh.vertices.size() || mesh.confidence.size() != mesh.vertices.size())
    return false;
  SharedBlock& block = memory_.block();
  // A writer that starts anew goes on from the count that its predecessor left; only readers need
  // to distrust it.
  const std::uint64_t next = block.surfaces_published.load(std::memory_order_relaxed) + 1;
  const auto slot = static_cast<std::uint32_t>(next % 2);
  const SurfaceArrays to = memory_.surface(slot);
  const WireSurfaceInfo info{mesh.map_id, mesh.version,
                             static_cast<std::uint32_t>(mesh.vertices.size()),
                             static_cast<std::uint32_t>(mesh.triangles.size())};
  SharedBlock::SurfaceSlot& head = block.surfaces[slot];
  seqlock::beginWrite(head.count);
  seqlock::store(head.info, &info, sizeof info);
  seqlock::store(to.vertices, mesh.vertices.data(), mesh.vertices.size() * 12);
  seqlock::store(to.normals, mesh.normals.data(), mesh.normals.size() * 12);
  seqlock::store(to.confidence, mesh.confidence.data(), mesh.confidence.size() * 4);
  seqlock::store(to.triangles, mesh.triangles.data(), mesh.triangles.size() * 12);
  seqlock::endWrite(head.count);
  block.surfaces_published.store(next, std::memory_order_release);
  return true;
}

bool isSound(const SurfaceMesh& mesh) {
  if (mesh.normals.size() != mesh.vertices.size() || mesh.confidence.size() != mesh.vertices.size())
    return false;
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
  if (info.vertices > c.max_vertices || info.triangles > c.max_triangles) {
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
  mesh.triangles.resize(info.triangles);
  seqlock::load(mesh.vertices.data(), from.vertices, mesh.vertices.size() * 12);
  seqlock::load(mesh.normals.data(), from.normals, mesh.normals.size() * 12);
  seqlock::load(mesh.confidence.data(), from.confidence, mesh.confidence.size() * 4);
  seqlock::load(mesh.triangles.data(), from.triangles, mesh.triangles.size() * 12);
  if (before == 0 || !seqlock::endRead(head.count, before)) return Result::Nothing;
  seen_ = published;
  return isSound(mesh) ? Result::Taken : Result::Rejected;
}

void reserve(SurfaceMesh& mesh, const SharedCapacity& capacity) {
  mesh.vertices.reserve(capacity.max_vertices);
  mesh.normals.reserve(capacity.max_vertices);
  mesh.confidence.reserve(capacity.max_vertices);
  mesh.triangles.reserve(capacity.max_triangles);
}

}  // namespace depthscope::platform
