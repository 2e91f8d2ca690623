#pragma once
#include <cstdint>
#include <vector>

#include "slam/cell_distance.hpp"
#include "slam/image_area.hpp"
#include "slam/image_buffer.hpp"
#include "slam/image_pyramid.hpp"
#include "types/view_outline.hpp"

namespace depthscope::slam {

/// The part of the picture that shows anything: most endoscopes show a round view in dark
/// surroundings, whose edge stands still in the picture and must not be taken for tissue.
class FieldOfView {
 public:
  /// For pictures of the size of `pyramid`.
  explicit FieldOfView(const ImagePyramid& pyramid);

  /// Finds the view in the coarsest level: surroundings are what is dark and connected to the
  /// picture's border through dark; of the rest the largest piece is the view (towers write text
  /// into the corners).
  /// Pixels at or below `dark_threshold` may be surroundings.
  void update(const ImagePyramid& pyramid, int dark_threshold);

  /// Distance [px] at full resolution from (x, y) to the surroundings, to within about 7 px.
  double distance(double x, double y) const { return surroundings_.at(x, y); }
  /// The smallest area that holds the view [px of full resolution].
  const Area& bounds() const { return bounds_; }
  /// The view's ends in every band of rows, looked up in the full resolution of the picture that
  /// update() was given last; a few pixels inside, for optics and compression blur the edge.
  ViewOutline outline(const ImagePyramid& pyramid) const;

 private:
  void classify(const ImageBuffer& coarse);
  bool floodSurroundings();
  void keepLargestPiece();
  void markSurroundings();
  ViewOutline::Span spanAt(const std::uint8_t* row, double y) const;
  /// Turns the cells that are `from` and connected to (column, row) into `to`; returns their
  /// number.
  int flood(int column, int row, std::uint8_t from, std::uint8_t to);

  int width_, height_, dark_threshold_ = 0;
  double cell_;  // [px of full resolution]
  CellDistance surroundings_;
  Area bounds_;
  std::vector<std::uint8_t> region_;   // what each cell is
  std::vector<std::int32_t> visited_;  // workspace of flood
};

}  // namespace depthscope::slam
