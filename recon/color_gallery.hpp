#pragma once
#include <cstdint>
#include <vector>

#include "recon/view_picture.hpp"

namespace depthscope::recon {

/// Small colour pictures of views, in a fixed number of slots. When these are full, the picture
/// goes whose view the last cloud no longer has; else the one whose neighbours in time are
/// nearest to each other, so that what is left stays spread over all that was seen.
class ColorGallery {
 public:
  /// Room for so many pictures of this size is made at once.
  ColorGallery(int pictures, const ColorReduction& size);

  void add(std::int64_t frame, const Grid<Rgb>& color);
  /// Learns which views the map has.
  void update(const std::vector<std::int64_t>& view_frames);
  /// The picture of a view, or null.
  const Grid<Rgb>* find(std::int64_t frame) const;

 private:
  struct Slot {
    std::int64_t frame = -1;  // -1: free
    Grid<Rgb> color;
  };
  Slot& claim(std::int64_t frame);
  bool culled(std::int64_t frame) const;

  std::vector<Slot> slots_;
  std::vector<Slot*> by_time_;        // scratch of claim()
  std::vector<std::int64_t> frames_;  // of the last cloud, sorted
};

}  // namespace depthscope::recon
