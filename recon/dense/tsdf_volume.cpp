#include "recon/dense/tsdf_volume.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "types/vector_clones.hpp"

namespace depthscope::recon {
namespace {

// [px] between rays that make blocks: a third of a block's side apart. With 2 surfaces are the
// same, and take a twentieth longer.
constexpr int kAllocationStride = 3;
constexpr int kTile_px = 8;         // side of the tiles that a view's depths are bounded in
constexpr float kRounding = 1.01f;  // times the radius of a block

}  // namespace

TsdfVolume::TsdfVolume(int max_blocks)
    : capacity_(static_cast<std::size_t>(max_blocks)),
      voxels_(capacity_ * kVoxels),
      slots_(std::bit_ceil(2 * capacity_), kNone) {
  keys_.reserve(capacity_);
}

void TsdfVolume::begin(float voxel_size, float truncation) {
  voxel_size_ = voxel_size;
  truncation_ = truncation;
  keys_.clear();
  std::fill(slots_.begin(), slots_.end(), kNone);
}

std::size_t TsdfVolume::slotOf(const Key& key) const {
  // Teschner et al. 2003.
  const auto hash = (static_cast<std::uint32_t>(key.x()) * 73856093u) ^
                    (static_cast<std::uint32_t>(key.y()) * 19349669u) ^
                    (static_cast<std::uint32_t>(key.z()) * 83492791u);
  std::size_t slot = hash & (slots_.size() - 1);
  while (slots_[slot] != kNone && keys_[static_cast<std::size_t>(slots_[slot])] != key)
    slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

int TsdfVolume::find(const Key& key) const {
  return slots_[slotOf(key)];
}

bool TsdfVolume::insert(const Key& key) {
  const std::size_t slot = slotOf(key);
  if (slots_[slot] != kNone) return true;
  if (keys_.size() == capacity_) return false;
  slots_[slot] = static_cast<std::int32_t>(keys_.size());
  keys_.push_back(key);
  std::fill_n(voxels_.begin() + static_cast<std::ptrdiff_t>((keys_.size() - 1) * kVoxels), kVoxels,
              Voxel{});
  return true;
}

bool TsdfVolume::allocate(const FusedView& view, const PinholeLevel& level) {
  const Eigen::Matrix3f R_world_camera = view.T_camera_world.R.transpose().cast<float>();
  const Eigen::Vector3f centre = view.T_camera_world.inverse().t.cast<float>();
  const float block = voxel_size_ * kSide, reach = truncation_ * voxel_size_;
  const int steps = static_cast<int>(std::ceil(2 * reach / (block / 2)));
  Key last = Key::Constant(std::numeric_limits<int>::max());
  for (int y = 0; y < level.height; y += kAllocationStride)
    for (int x = 0; x < level.width; x += kAllocationStride) {
      const float q = view.map->inverse_depth.at(x, y) * view.inverse_scale;
      if (!(q > 0) || view.agreeing.at(x, y) == 0) continue;
      const Eigen::Vector3f ray =
          R_world_camera * Eigen::Vector3f((x - level.cx) / level.f, (y - level.cy) / level.f, 1);
      const Eigen::Vector3f hit = centre + ray / q, direction = ray.normalized();
      for (int i = 0; i <= steps; ++i) {
        const float along = -reach + 2 * reach * static_cast<float>(i) / static_cast<float>(steps);
        const Key key = ((hit + along * direction) / block).array().floor().cast<int>();
        if (key == last) continue;
        last = key;
        if (!insert(key)) return false;
      }
    }
  return true;
}

void TsdfVolume::integrate(const FusedView& view, const PinholeLevel& level, ViewPixels& scratch,
                           int first, int step) {
  prepare(view, level, scratch);
  const Eigen::Matrix3f R = view.T_camera_world.R.cast<float>();
  const Eigen::Vector3f t = view.T_camera_world.t.cast<float>();
  for (int b = first; b < blocks(); b += step) integrateBlock(b, scratch, level, R, t);
}

void TsdfVolume::prepare(const FusedView& view, const PinholeLevel& level, ViewPixels& out) const {
  const DepthMap& map = *view.map;
  out.pixels.reset(level.width, level.height);
  out.farthest.reset(level.width / kTile_px + 1, level.height / kTile_px + 1);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    const float q = map.inverse_depth.cells[i] * view.inverse_scale;
    ViewPixels::Pixel& pixel = out.pixels.cells[i];
    if (!(q > 0) || view.agreeing.cells[i] == 0) continue;
    const float slant = map.slant.cells[i];
    // Voxels per pixel of disparity, along the normal: the standard deviation is a part of it.
    const float deviation = map.precision * view.inverse_scale / (q * q * voxel_size_);
    pixel.depth = 1 / q;
    pixel.slant = slant / voxel_size_;
    pixel.weight = slant * slant / (deviation * deviation) *
                   static_cast<float>(map.confidence.cells[i] * view.agreeing.cells[i]);
    const auto x = static_cast<int>(i) % level.width, y = static_cast<int>(i) / level.width;
    float& farthest = out.farthest.at(x / kTile_px, y / kTile_px);
    farthest = std::max(farthest, pixel.depth + truncation_ / pixel.slant);
  }
}

namespace {

/// Where the voxels of a block lie in a picture, and how deep.
struct BlockPlaces {
  std::array<float, TsdfVolume::kVoxels> depth;
  std::array<std::int32_t, TsdfVolume::kVoxels> pixel;  // number of it, or -1
};

struct BlockFrame {
  std::array<float, 3> first, dx, dy, dz;  // of the voxels' grid in the camera's frame
};

DEPTHSCOPE_CLONES
void placeBlock(const BlockFrame& block, const PinholeLevel& level, BlockPlaces& out) {
  constexpr int n = TsdfVolume::kSide;
  const float f = level.f, cx = level.cx + 0.5f, cy = level.cy + 0.5f;
  const int width = level.width, height = level.height;
  for (int i = 0; i < TsdfVolume::kVoxels; ++i) {
    const auto x = static_cast<float>(i % n), y = static_cast<float>(i / n % n),
               z = static_cast<float>(i / (n * n));
    const float px = block.first[0] + x * block.dx[0] + y * block.dy[0] + z * block.dz[0];
    const float py = block.first[1] + x * block.dx[1] + y * block.dy[1] + z * block.dz[1];
    const float pz = block.first[2] + x * block.dx[2] + y * block.dy[2] + z * block.dz[2];
    const float u = f * px / pz + cx, v = f * py / pz + cy;
    // Beyond the picture by a pixel at most is enough for what is not in it.
    const float bu = u > 0 ? u : -1, bv = v > 0 ? v : -1;
    const int column = static_cast<int>(bu < 32767 ? bu : 32767);
    const int row = static_cast<int>(bv < 32767 ? bv : 32767);
    const bool inside = (pz > 0) & (u >= 0) & (v >= 0) & (column < width) & (row < height);
    out.depth[static_cast<std::size_t>(i)] = pz;
    out.pixel[static_cast<std::size_t>(i)] = inside ? row * width + column : -1;
  }
}

/// Whether a pixel up to `reach_px` from (u, v) may see a surface within the truncation of what is
/// `depth` away or farther.
bool anyReaches(const Grid<float>& farthest, float u, float v, float reach_px, float depth) {
  const auto tile = [](float at, int tiles) {
    return std::clamp(static_cast<int>(at) / kTile_px, 0, tiles - 1);
  };
  const int right = tile(u + reach_px, farthest.width), below = tile(v + reach_px, farthest.height);
  for (int y = tile(v - reach_px, farthest.height); y <= below; ++y)
    for (int x = tile(u - reach_px, farthest.width); x <= right; ++x)
      if (farthest.at(x, y) >= depth) return true;
  return false;
}

}  // namespace

void TsdfVolume::integrateBlock(int block, const ViewPixels& view, const PinholeLevel& level,
                                const Eigen::Matrix3f& R, const Eigen::Vector3f& t) {
  const Eigen::Vector3f corner = key(block).cast<float>() * (kSide * voxel_size_);
  const Eigen::Vector3f first = R * corner + t;
  const float half = static_cast<float>(kSide - 1) / 2 * voxel_size_;
  const Eigen::Vector3f middle = first + R * Eigen::Vector3f::Constant(half);
  const float radius = half * std::sqrt(3.f);
  if (middle.z() < radius) return;
  const float blur = level.f * radius / (middle.z() - radius);  // [px] that the block may cover
  const float mu = level.f * middle.x() / middle.z() + level.cx;
  const float mv = level.f * middle.y() / middle.z() + level.cy;
  if (mu < -blur || mv < -blur || mu > level.width + blur || mv > level.height + blur) return;
  if (!anyReaches(view.farthest, mu, mv, blur + 1, middle.z() - kRounding * radius)) return;

  const auto array = [](const Eigen::Vector3f& v) { return std::array{v.x(), v.y(), v.z()}; };
  BlockPlaces places;
  placeBlock({array(first), array(R.col(0) * voxel_size_), array(R.col(1) * voxel_size_),
              array(R.col(2) * voxel_size_)},
             level, places);
  Voxel* voxel = voxels_.data() + static_cast<std::ptrdiff_t>(block) * kVoxels;
  for (std::size_t i = 0; i < kVoxels; ++i, ++voxel) {
    if (places.pixel[i] < 0) continue;
    const ViewPixels::Pixel& pixel = view.pixels.cells[static_cast<std::size_t>(places.pixel[i])];
    const float ahead = (pixel.depth - places.depth[i]) * pixel.slant;
    if (pixel.weight == 0 || ahead < -truncation_) continue;
    const float d = std::min(ahead, truncation_);
    voxel->weight += pixel.weight;
    voxel->distance += pixel.weight * d;
    voxel->squared_distance += pixel.weight * d * d;
    voxel->views += ahead < truncation_ ? 1.f : 0.f;
  }
}

void TsdfVolume::finish() {
  for (std::size_t i = 0; i < keys_.size() * kVoxels; ++i) {
    Voxel& voxel = voxels_[i];
    if (voxel.weight == 0) continue;
    voxel.distance /= voxel.weight;
    voxel.squared_distance /= voxel.weight;
  }
}

std::size_t TsdfVolume::bytes() const {
  return voxels_.capacity() * sizeof(Voxel) + keys_.capacity() * sizeof(Key) +
         slots_.capacity() * sizeof(std::int32_t);
}

}  // namespace depthscope::recon
