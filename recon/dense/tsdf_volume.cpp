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
  for (auto& middles : middles_) middles.reserve(capacity_);
}

void TsdfVolume::begin(float voxel_size, float truncation) {
  voxel_size_ = voxel_size;
  truncation_ = truncation;
  keys_.clear();
  for (auto& middles : middles_) middles.clear();
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
  for (std::size_t i = 0; i < 3; ++i)
    middles_[i].push_back(
        (static_cast<float>(key[static_cast<int>(i)] * kSide) + static_cast<float>(kSide - 1) / 2) *
        voxel_size_);
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

namespace {

/// One row of a depth map as voxels need it; factors from the map's units to theirs.
struct RowOfMap {
  const float *inverse_depth, *slant;
  const std::uint8_t *confidence, *agreeing;
  float scale, voxels_per_unit, precision;
};

DEPTHSCOPE_CLONES
void prepareRow(int width, const RowOfMap& row, float truncation,
                TsdfVolume::ViewPixels::Pixel* __restrict pixels, float* __restrict reach) {
  const float* __restrict inverse_depth = row.inverse_depth, * __restrict slants = row.slant;
  const std::uint8_t* __restrict confidence = row.confidence, * __restrict agreeing = row.agreeing;
  const float scale = row.scale, voxels = row.voxels_per_unit, precision = row.precision;
  for (int x = 0; x < width; ++x) {
    const float q = inverse_depth[x] * scale;
    const int votes = confidence[x] * agreeing[x];
    const bool known = (q > 0) & (votes > 0);
    const float depth = 1 / (known ? q : 1.f), slant = known ? slants[x] * voxels : 1.f;
    // Pixels of disparity per voxel along the normal: 1 / the standard deviation is a part of it.
    const float sure = slant * (known ? q * q : 0.f) / precision;
    pixels[x] = {known ? depth : 0.f, known ? slant : 0.f, sure * sure * static_cast<float>(votes)};
    reach[x] = known ? depth + truncation / slant : 0.f;
  }
}

}  // namespace

void TsdfVolume::prepare(const FusedView& view, const PinholeLevel& level, ViewPixels& out) const {
  const DepthMap& map = *view.map;
  out.pixels.resize(level.width, level.height);
  out.reach.resize(static_cast<std::size_t>(level.width));
  out.farthest.reset(level.width / kTile_px + 1, level.height / kTile_px + 1);
  for (int y = 0; y < level.height; ++y) {
    prepareRow(
        level.width,
        {map.inverse_depth.row(y), map.slant.row(y), map.confidence.row(y), view.agreeing.row(y),
         view.inverse_scale, 1 / voxel_size_, map.precision * view.inverse_scale},
        truncation_, out.pixels.row(y), out.reach.data());
    float* farthest = out.farthest.row(y / kTile_px);
    for (int x = 0; x < level.width; ++x)
      farthest[x / kTile_px] =
          std::max(farthest[x / kTile_px], out.reach[static_cast<std::size_t>(x)]);
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

/// Where a view sees the middles of blocks.
struct BlockMiddles {
  static constexpr int kMost = 64;
  std::array<float, kMost> u, v, depth;
  std::array<float, kMost> reach_px;  // that a block may cover around its middle
  std::array<std::uint8_t, kMost> in_picture;
};

struct BlockView {
  std::array<float, 9> R;  // world to camera, by rows
  std::array<float, 3> t;
  float radius;  // of blocks
};

DEPTHSCOPE_CLONES
void placeMiddles(int n, const float* __restrict x, const float* __restrict y,
                  const float* __restrict z, const BlockView& view, const PinholeLevel& level,
                  BlockMiddles& out) {
  const float f = level.f, cx = level.cx, cy = level.cy, radius = view.radius;
  const auto width = static_cast<float>(level.width), height = static_cast<float>(level.height);
  const auto& R = view.R;
  const auto& t = view.t;
  for (int i = 0; i < n; ++i) {
    const float px = R[0] * x[i] + R[1] * y[i] + R[2] * z[i] + t[0];
    const float py = R[3] * x[i] + R[4] * y[i] + R[5] * z[i] + t[1];
    const float pz = R[6] * x[i] + R[7] * y[i] + R[8] * z[i] + t[2];
    const bool before = pz > radius;
    const float depth = before ? pz : 1.f;
    const float reach = f * radius / (before ? pz - radius : 1.f);
    const float u = f * px / depth + cx, v = f * py / depth + cy;
    const bool in_picture =
        before & (u >= -reach) & (v >= -reach) & (u <= width + reach) & (v <= height + reach);
    out.u[static_cast<std::size_t>(i)] = u;
    out.v[static_cast<std::size_t>(i)] = v;
    out.depth[static_cast<std::size_t>(i)] = depth;
    out.reach_px[static_cast<std::size_t>(i)] = reach;
    out.in_picture[static_cast<std::size_t>(i)] = in_picture ? 1 : 0;
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

void TsdfVolume::integrate(const FusedView& view, const PinholeLevel& level, ViewPixels& scratch,
                           int first, int step) {
  prepare(view, level, scratch);
  const Eigen::Matrix3f R = view.T_camera_world.R.cast<float>();
  const Eigen::Vector3f t = view.T_camera_world.t.cast<float>();
  const float radius = std::sqrt(3.f) * static_cast<float>(kSide - 1) / 2 * voxel_size_;
  const BlockView block_view{
      {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)},
      {t.x(), t.y(), t.z()},
      radius};
  constexpr int kTogether = BlockMiddles::kMost;
  BlockMiddles middles;
  for (int begin = first * kTogether; begin < blocks(); begin += step * kTogether) {
    const int n = std::min(kTogether, blocks() - begin);
    placeMiddles(n, middles_[0].data() + begin, middles_[1].data() + begin,
                 middles_[2].data() + begin, block_view, level, middles);
    for (int i = 0; i < n; ++i) {
      const auto m = static_cast<std::size_t>(i);
      if (middles.in_picture[m] != 0 &&
          anyReaches(scratch.farthest, middles.u[m], middles.v[m], middles.reach_px[m] + 1,
                     middles.depth[m] - kRounding * radius))
        integrateBlock(begin + i, scratch, level, R, t);
    }
  }
}

void TsdfVolume::integrateBlock(int block, const ViewPixels& view, const PinholeLevel& level,
                                const Eigen::Matrix3f& R, const Eigen::Vector3f& t) {
  const Eigen::Vector3f first = R * (key(block).cast<float>() * (kSide * voxel_size_)) + t;
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
  return voxels_.capacity() * sizeof(Voxel) +
         keys_.capacity() * (sizeof(Key) + middles_.size() * sizeof(float)) +
         slots_.capacity() * sizeof(std::int32_t);
}

}  // namespace depthscope::recon
