#include "overlay/view_mask.hpp"

#include <algorithm>

namespace depthscope::overlay {
namespace {

// Ends beyond the picture: any lens' picture is smaller, and differences stay exact.
constexpr float kFar = 65536;

}  // namespace

ViewMask::ViewMask() {
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
    ends[i] = {std::clamp(span.left, -kFar, kFar), std::clamp(span.right, -kFar, kFar)};
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
