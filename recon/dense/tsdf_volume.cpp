#include "recon/dense/tsdf_volume.hpp"

#include <bit>
#include <cmath>

namespace depthscope::recon {
namespace {

constexpr int kAllocationStride = 2;  // [px] between rays that make blocks

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

void TsdfVolume::integrate(const FusedView& view, const PinholeLevel& level) {
  const Eigen::Matrix3f R = view.T_camera_world.R.cast<float>();
  const Eigen::Vector3f t = view.T_camera_world.t.cast<float>();
  for (int b = 0; b < blocks(); ++b) integrateBlock(b, view, level, R, t);
}

void TsdfVolume::integrateBlock(int block, const FusedView& view, const PinholeLevel& level,
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

  const DepthMap& map = *view.map;
  const float limit = truncation_ * voxel_size_;
  const Eigen::Vector3f dx = R.col(0) * voxel_size_, dy = R.col(1) * voxel_size_,
                        dz = R.col(2) * voxel_size_;
  Voxel* voxel = voxels_.data() + static_cast<std::ptrdiff_t>(block) * kVoxels;
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j) {
      Eigen::Vector3f p = first + static_cast<float>(k) * dz + static_cast<float>(j) * dy;
      for (int i = 0; i < kSide; ++i, ++voxel, p += dx) {
        if (p.z() <= 0) continue;
        const float inverse = 1 / p.z();
        const float u = level.f * p.x() * inverse + level.cx + 0.5f;
        const float v = level.f * p.y() * inverse + level.cy + 0.5f;
        if (!(u >= 0 && v >= 0 && u < level.width && v < level.height)) continue;
        const int x = static_cast<int>(u), y = static_cast<int>(v);
        const float q = map.inverse_depth.at(x, y) * view.inverse_scale;
        const int agreeing = view.agreeing.at(x, y);
        if (agreeing == 0) continue;
        const float ahead = (1 / q - p.z()) * map.slant.at(x, y);
        if (ahead < -limit) continue;
        const float d = std::min(ahead, limit) / voxel_size_;
        const float sharpness = q * q / (map.precision * view.inverse_scale);
        const float w =
            sharpness * sharpness * static_cast<float>(map.confidence.at(x, y) * agreeing);
        const float total = voxel->weight + w, share = w / total;
        voxel->weight = total;
        voxel->distance += share * (d - voxel->distance);
        voxel->squared_distance += share * (d * d - voxel->squared_distance);
        voxel->views += ahead < limit ? 1.f : 0.f;
      }
    }
}

std::size_t TsdfVolume::bytes() const {
  return voxels_.capacity() * sizeof(Voxel) + keys_.capacity() * sizeof(Key) +
         slots_.capacity() * sizeof(std::int32_t);
}

}  // namespace depthscope::recon
