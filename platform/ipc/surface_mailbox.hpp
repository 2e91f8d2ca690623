#pragma once
#include <cstdint>

#include "platform/ipc/shared_memory.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// Publishes surfaces into two buffers by turns, so that the newest stays readable while the next
/// is written.
class SurfaceMailboxWriter {
 public:
  explicit SurfaceMailboxWriter(const SharedMemory& memory) : memory_(memory) {}
  /// False when the mesh has no room or its arrays do not match.
  bool publish(const SurfaceMesh& mesh);

 private:
  const SharedMemory& memory_;
};

/// Whether every number is finite, every index in range, and the arrays are parallel.
bool isSound(const SurfaceMesh& mesh);

class SurfaceMailboxReader {
 public:
  explicit SurfaceMailboxReader(const SharedMemory& memory) : memory_(memory) {}

  enum class Result { Nothing, Taken, Rejected };
  /// Copies the newest surface into `mesh` if it was not taken before. After anything but Taken the
  /// mesh is not to be used. Does not allocate when the mesh has room for the memory's capacity.
  Result takeNewest(SurfaceMesh& mesh);

 private:
  const SharedMemory& memory_;
  std::uint64_t seen_ = 0;
};

/// Gives the mesh room for the largest surface that may come.
void reserve(SurfaceMesh& mesh, const SharedCapacity& capacity);

}  // namespace depthscope::platform
