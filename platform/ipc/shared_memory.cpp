#include "platform/ipc/shared_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr std::uint64_t magic = 0x65706f6373687470;  // "pthscope"
constexpr std::uint32_t layout_version = 4;
constexpr int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
// Bounds that no honest capacity exceeds and that keep sizes far from overflow.
constexpr std::uint32_t max_side_px = 16384;
constexpr std::uint32_t max_elements = 1u << 24;

std::size_t aligned(std::size_t bytes) {
  return (bytes + 63) / 64 * 64;
}

std::size_t lumaBytes(const SharedCapacity& c) {
  return aligned(static_cast<std::size_t>(c.width) * c.height);
}
std::size_t colorBytes(const SharedCapacity& c) {
  return aligned(ColorReduction(static_cast<int>(c.width), static_cast<int>(c.height)).pixels() *
                 sizeof(Rgb));
}
std::size_t pictureBytes(const SharedCapacity& c) {
  return lumaBytes(c) + colorBytes(c);
}
std::size_t vectorBytes(const SharedCapacity& c) {
  return aligned(static_cast<std::size_t>(c.max_vertices) * 12);
}
std::size_t scalarBytes(const SharedCapacity& c) {
  return aligned(static_cast<std::size_t>(c.max_vertices) * 4);
}
std::size_t observationBytes(const SharedCapacity& c) {
  return aligned(static_cast<std::size_t>(c.max_vertices) * sizeof(std::uint16_t));
}
std::size_t meshColorBytes(const SharedCapacity& c) {
  return aligned(static_cast<std::size_t>(c.max_vertices) * sizeof(Rgb));
}
std::size_t triangleBytes(const SharedCapacity& c) {
  return aligned(static_cast<std::size_t>(c.max_triangles) * 12);
}
std::size_t surfaceBytes(const SharedCapacity& c) {
  return 2 * vectorBytes(c) + scalarBytes(c) + observationBytes(c) + meshColorBytes(c) +
         triangleBytes(c);
}
std::size_t picturesOffset() {
  return aligned(sizeof(SharedBlock));
}
std::size_t surfacesOffset(const SharedCapacity& c) {
  return picturesOffset() + ring_slots * pictureBytes(c);
}
std::size_t totalBytes(const SharedCapacity& c) {
  return surfacesOffset(c) + 2 * surfaceBytes(c);
}

bool sensible(const SharedCapacity& c) {
  return c.width > 0 && c.height > 0 && c.width <= max_side_px && c.height <= max_side_px &&
         c.max_vertices > 0 && c.max_triangles > 0 && c.max_vertices <= max_elements &&
         c.max_triangles <= max_elements;
}

[[noreturn]] void throwErrno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void* map(int fd, std::size_t bytes) {
  void* mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (mapped == MAP_FAILED) throwErrno("shared memory cannot be mapped");
  return mapped;
}

}  // namespace

SharedMemory::SharedMemory(UniqueFd fd, const SharedCapacity& capacity, std::size_t bytes,
                           void* mapped)
    : fd_(std::move(fd)),
      capacity_(capacity),
      bytes_(bytes),
      block_(static_cast<SharedBlock*>(mapped)) {}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : fd_(std::move(other.fd_)),
      capacity_(other.capacity_),
      bytes_(other.bytes_),
      block_(std::exchange(other.block_, nullptr)) {}

SharedMemory::~SharedMemory() {
  if (block_ != nullptr) ::munmap(block_, bytes_);
}

SharedMemory SharedMemory::create(const SharedCapacity& capacity) {
  if (!sensible(capacity)) throw InputError("shared memory: capacity out of range");
  UniqueFd fd(::memfd_create("depthscope", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (!fd.valid()) throwErrno("memfd_create");
  const std::size_t bytes = totalBytes(capacity);
  if (::ftruncate(fd.get(), static_cast<off_t>(bytes)) != 0)
    throwErrno("shared memory cannot be sized");
  if (::fcntl(fd.get(), F_ADD_SEALS, seals) != 0) throwErrno("shared memory cannot be sealed");
  void* mapped = map(fd.get(), bytes);
  // The memory is all zero: every count says "nothing yet".
  auto* block = new (mapped) SharedBlock{};
  block->magic = magic;
  block->layout_version = layout_version;
  block->capacity = capacity;
  return {std::move(fd), capacity, bytes, mapped};
}

SharedMemory SharedMemory::attach(UniqueFd fd) {
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0 || info.st_size < static_cast<off_t>(sizeof(SharedBlock)))
    throw InputError("shared memory: too small, expected one made by depthscoped");
  if ((::fcntl(fd.get(), F_GET_SEALS) & seals) != seals)
    throw InputError("shared memory: not sealed, expected one made by depthscoped");
  const auto bytes = static_cast<std::size_t>(info.st_size);
  void* mapped = map(fd.get(), bytes);
  const auto* block = static_cast<const SharedBlock*>(mapped);
  const SharedCapacity capacity = block->capacity;
  if (block->magic != magic || block->layout_version != layout_version || !sensible(capacity) ||
      totalBytes(capacity) != bytes) {
    ::munmap(mapped, bytes);
    throw InputError("shared memory: layout not known, expected that of the same version");
  }
  return {std::move(fd), capacity, bytes, mapped};
}

seqlock::Word* SharedMemory::pixels(std::uint32_t slot) const {
  auto* base =
      reinterpret_cast<std::byte*>(block_) + picturesOffset() + slot * pictureBytes(capacity_);
  return reinterpret_cast<seqlock::Word*>(base);
}

seqlock::Word* SharedMemory::color(std::uint32_t slot) const {
  return pixels(slot) + lumaBytes(capacity_) / sizeof(seqlock::Word);
}

SurfaceArrays SharedMemory::surface(std::uint32_t slot) const {
  auto* base = reinterpret_cast<std::byte*>(block_) + surfacesOffset(capacity_) +
               slot * surfaceBytes(capacity_);
  const auto take = [&](std::size_t bytes) {
    auto* words = reinterpret_cast<seqlock::Word*>(base);
    base += bytes;
    return words;
  };
  const SharedCapacity& c = capacity_;
  return {.vertices = take(vectorBytes(c)),
          .normals = take(vectorBytes(c)),
          .confidence = take(scalarBytes(c)),
          .observations = take(observationBytes(c)),
          .colors = take(meshColorBytes(c)),
          .triangles = take(triangleBytes(c))};
}

}  // namespace depthscope::platform
