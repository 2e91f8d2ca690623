#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "kernel/bell.hpp"
#include "platform/ipc/seqlock.hpp"
#include "platform/ipc/wire.hpp"
#include "platform/unique_fd.hpp"
#include "types/color.hpp"

namespace depthscope::platform {

/// What the shared memory has room for; fixed when it is made.
struct SharedCapacity {
  std::uint32_t width = 0, height = 0;  // [px] of the luma pictures; colour: ColorReduction
  std::uint32_t max_vertices = 0, max_triangles = 0;
  bool operator==(const SharedCapacity&) const = default;
};

inline constexpr std::uint32_t ring_slots = 4;

/// What belongs to a picture in the ring.
struct WireFrameInfo {
  std::int64_t frame;
  double timestamp_s;
};

struct WireSurfaceInfo {
  std::uint32_t map_id, version, vertices, triangles;
  std::uint32_t observations, colors;  // as many as vertices, or none
};

/// The part of the shared memory whose size does not depend on the capacity.
struct SharedBlock {
  std::uint64_t magic;
  std::uint32_t layout_version;
  SharedCapacity capacity;
  alignas(64) kernel::Bell new_frame;  // rung with every picture, and every command
  alignas(64) kernel::Bell new_pose;   // rung by the AR process with every pose
  alignas(64) seqlock::Word
      frames_published;  // ring slot of picture n (from 1): (n - 1) % ring_slots
  struct FrameSlot {
    alignas(64) seqlock::Word count;
    seqlock::Word info[seqlock::wordsFor(sizeof(WireFrameInfo))];
  } frames[ring_slots];
  alignas(64) SeqlockBox<WirePose> pose;
  alignas(64) SeqlockBox<WireLabels> labels;
  alignas(64) SeqlockBox<WireView> view;
  alignas(64) SeqlockBox<WireArStatus> status;
  alignas(64) seqlock::Word surfaces_published;  // buffer of surface n (from 1): n % 2
  struct SurfaceSlot {
    alignas(64) seqlock::Word count;
    seqlock::Word info[seqlock::wordsFor(sizeof(WireSurfaceInfo))];
  } surfaces[2];
};

/// Where one surface's arrays lie.
struct SurfaceArrays {
  seqlock::Word *vertices, *normals, *confidence, *observations, *colors, *triangles;
};

/// One sealed memfd, mapped: a SharedBlock, the ring's pictures, two surfaces. Who makes it decides
/// the capacity and never reads it back; who attaches checks it against the file's true size.
class SharedMemory {
 public:
  /// Throws std::system_error.
  static SharedMemory create(const SharedCapacity& capacity);
  /// Takes the descriptor over. Throws InputError when it is not such a memory: size, seals,
  /// version, capacity.
  static SharedMemory attach(UniqueFd fd);
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;
  ~SharedMemory();

  int fd() const { return fd_.get(); }
  const SharedCapacity& capacity() const { return capacity_; }
  SharedBlock& block() const { return *block_; }
  /// Pixels of a ring slot, rows packed.
  seqlock::Word* pixels(std::uint32_t slot) const;
  /// The small colour picture that belongs to it, rows packed.
  seqlock::Word* color(std::uint32_t slot) const;
  ColorReduction colorSize() const {
    return {static_cast<int>(capacity_.width), static_cast<int>(capacity_.height)};
  }
  SurfaceArrays surface(std::uint32_t slot) const;
  std::size_t bytes() const { return bytes_; }

 private:
  SharedMemory(UniqueFd fd, const SharedCapacity& capacity, std::size_t bytes, void* mapped);

  UniqueFd fd_;
  SharedCapacity capacity_;
  std::size_t bytes_ = 0;
  SharedBlock* block_ = nullptr;
};

}  // namespace depthscope::platform
