#pragma once
#include <optional>
#include <vector>

#include "recon/cloud_index.hpp"
#include "recon/color_gallery.hpp"
#include "recon/pinhole_view.hpp"
#include "types/camera_model.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// Gives surfaces the colours of the video: those of views, so that what was seen only long ago
/// has colour, too. Each vertex gets the mean over the views that see it, those most that look
/// at it straight and from near, where the scope's light is bright: weight (cos / distance^2)^2.
/// Highlights and the dark surroundings of a round view count only where nothing else was seen.
class SurfacePainter {
 public:
  /// Keeps the colours of at most `pictures` views.
  SurfacePainter(const CameraModel& camera, int pictures);

  void addPicture(const ViewPicture& picture);
  /// Fills `colors` of a mesh with normals, in the world frame of the cloud; leaves them empty
  /// where there is no picture of the cloud's views. A vertex that none of the chosen views
  /// sees has the mean colour of its neighbours in the mesh (black where these have none either).
  /// Neither time nor memory grow with the map: at most 24 views are looked at, those that see
  /// the map points best together.
  void paint(const CloudIndex& index, SurfaceMesh& mesh);

 private:
  struct Sum {
    float red = 0, green = 0, blue = 0, weight = 0;
  };
  struct Seen {
    std::int32_t cell;  // of the view; negative: not seen
    float depth;        // [map unit]
  };
  std::vector<std::size_t> chooseViews(const CloudIndex& index) const;
  void findVisible(const Pose& T_camera_world, const SurfaceMesh& mesh);
  void addView(const Pose& T_camera_world, const Grid<Rgb>& color, const SurfaceMesh& mesh);
  void fillGaps(const SurfaceMesh& mesh);

  ColorReduction size_;
  std::optional<PinholeView> view_;  // none for a camera without a size
  Grid<std::int32_t> pixel_;         // of the view's cells in a colour picture; negative: none
  ColorGallery gallery_;
  std::vector<Seen> seen_;  // of each vertex, in the view at hand
  Grid<float> nearest_;     // depth of the nearest vertex, in coarse cells of the view
  std::vector<Sum> sums_;   // of each vertex
};

}  // namespace depthscope::recon
