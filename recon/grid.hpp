#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace depthscope::recon {

/// A picture-like array of fixed size, rows packed.
template <class T>
struct Grid {
  int width = 0, height = 0;
  std::vector<T> cells;

  Grid() = default;
  Grid(int w, int h, T value = {}) { reset(w, h, value); }
  /// Another size and one value everywhere; storage is reused.
  void reset(int w, int h, T value = {}) {
    width = w;
    height = h;
    cells.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value);
  }
  /// Another size, values undefined; storage is reused.
  void resize(int w, int h) {
    width = w;
    height = h;
    cells.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  }
  std::size_t size() const { return cells.size(); }
  T* row(int y) { return cells.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const T* row(int y) const { return cells.data() + static_cast<std::ptrdiff_t>(y) * width; }
  T& at(int x, int y) { return row(y)[x]; }
  const T& at(int x, int y) const { return row(y)[x]; }
  /// The nearest cell inside.
  const T& clamped(int x, int y) const {
    return row(std::clamp(y, 0, height - 1))[std::clamp(x, 0, width - 1)];
  }
};

}  // namespace depthscope::recon
