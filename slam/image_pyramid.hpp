#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "slam/image_buffer.hpp"
#include "slam/simd_dispatch.hpp"

namespace depthscope::slam {

/// Shrinks pictures of one size by a fixed factor, bilinear, in fixed point: output pixel x shows
/// source position (x + 1/2) * factor - 1/2, so that pixel areas, not corners, coincide.
class BilinearShrink {
 public:
  /// `factor` in (1, 2].
  BilinearShrink(int source_width, int source_height, int width, int height, double factor);
  void operator()(const ImageBuffer& source, ImageBuffer& out, SimdPath path);

 private:
  struct Tap {
    int first;            // left or upper of the two source pixels
    std::uint8_t weight;  // of the other one, in 1/64
  };
  /// Eight output columns: they come from the 16 source bytes at `first`.
  struct ColumnGroup {
    int first;
    alignas(16) std::array<std::uint8_t, 16> select;  // byte pairs to interpolate between
    alignas(16) std::array<std::int8_t, 16> weights;  // of each byte, in 1/64
  };
  static Tap tapAt(int i, double factor, int source_size);
  void shrinkRow(std::uint8_t* out) const;

  std::vector<Tap> rows_;
  std::vector<ColumnGroup> columns_;
  std::vector<std::uint8_t> blended_;  // one source-wide row at the output's height
};

/// The picture at falling resolutions: level l is the picture shrunk by scale_factor^l.
class ImagePyramid {
 public:
  ImagePyramid(int width, int height, int levels, double scale_factor);
  /// Builds all levels from a picture of the size given at construction.
  void build(const GrayView& image, SimdPath path);

  int levels() const { return static_cast<int>(images_.size()); }
  const ImageBuffer& level(int l) const { return images_[l]; }
  /// Pixels of level 0 per pixel of level l.
  double scale(int l) const { return scales_[l]; }

 private:
  std::vector<ImageBuffer> images_;
  std::vector<BilinearShrink> shrinks_;  // [l - 1]: level l - 1 -> level l
  std::vector<double> scales_;
};

}  // namespace depthscope::slam
