#pragma once
#include <array>
#include <limits>

namespace depthscope {

/// The part of the picture that shows anything, for most endoscopes show a round view in dark
/// surroundings: its left and right end in each of `bands` bands of rows of equal height. Between
/// the middles of two bands the ends run straight.
struct ViewOutline {
  static constexpr int bands = 128;
  static constexpr float beyond = std::numeric_limits<float>::max();

  /// Ends [px], 0 being the left edge of the picture's first column. An end at the picture's own
  /// border is -beyond or beyond; left >= right: nothing is seen in this band.
  struct Span {
    float left = -beyond, right = beyond;
    bool empty() const { return left >= right; }
    bool operator==(const Span&) const = default;
  };
  std::array<Span, bands> spans{};  // from the top; by default the whole picture

  bool operator==(const ViewOutline&) const = default;
};

}  // namespace depthscope
