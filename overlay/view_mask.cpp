#include "overlay/view_mask.hpp"

#include <algorithm>

namespace depthscope::overlay {
namespace {

constexpr float kEdge = 0.012f;  // width of the soft edge, of the picture's height

}  // namespace

ViewMask::ViewMask(int width, int height)
    : width_(static_cast<float>(width)), edge_(kEdge * static_cast<float>(height)) {
  glBindTexture(GL_TEXTURE_2D, ends_.name());
  glTexStorage2D(GL_TEXTURE_2D, 1, GL_RG32F, ViewOutline::bands, 1);
  for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  set({});
}

void ViewMask::set(const ViewOutline& view) {
  std::array<std::array<float, 2>, ViewOutline::bands> ends;
  const auto emptyAt = [&](std::size_t i) { return i < ends.size() && view.spans[i].empty(); };
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const ViewOutline::Span& span = view.spans[i];
    // An end beyond the picture lies so far out that nothing is soft at the border, and no farther,
    // so that the edge runs on smoothly from where it leaves the picture.
    ends[i] = {std::max(span.left, -edge_), std::min(span.right, width_ + edge_)};
    // Where the view ends upwards or downwards it tapers off within its last band.
    if (emptyAt(i + 1) || emptyAt(i - 1)) ends[i].fill(0.5f * (ends[i][0] + ends[i][1]));
  }
  // The shader runs straight from band to band, and an empty band has no place of its own.
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (!emptyAt(i)) continue;
    if (i > 0 && !emptyAt(i - 1)) ends[i] = ends[i - 1];
    if (i + 1 < ends.size() && !emptyAt(i + 1)) ends[i] = ends[i + 1];
  }
  glBindTexture(GL_TEXTURE_2D, ends_.name());
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, ViewOutline::bands, 1, GL_RG, GL_FLOAT, ends.data());
}

void ViewMask::bind(GLuint unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, ends_.name());
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace depthscope::overlay
