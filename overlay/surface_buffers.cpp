#include <cstddef>

#include "overlay/surface_pass.hpp"

namespace depthscope::overlay {
namespace {

template <class Vertex>
void attribute(GLuint location, GLint size, GLenum type, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, size, type, type == GL_FLOAT ? GL_FALSE : GL_TRUE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offset));
}

}  // namespace

SurfaceBuffers::SurfaceBuffers() {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
  attribute<SurfaceVertex>(0, 3, GL_FLOAT, offsetof(SurfaceVertex, position));
  attribute<SurfaceVertex>(1, 4, GL_UNSIGNED_BYTE, offsetof(SurfaceVertex, bary));
  glBindVertexArray(inset_array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, inset_vertices_.name());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, inset_indices_.name());
  attribute<InsetVertex>(0, 3, GL_FLOAT, offsetof(InsetVertex, position));
  attribute<InsetVertex>(1, 3, GL_BYTE, offsetof(InsetVertex, normal));
  attribute<InsetVertex>(2, 1, GL_UNSIGNED_BYTE, offsetof(InsetVertex, fade));
  glBindVertexArray(0);
}

void SurfaceBuffers::upload(const PreparedSurface& surface) {
  glBindVertexArray(array_.name());
  vertices_.fill(GL_ARRAY_BUFFER, std::as_bytes(std::span(surface.vertices)));
  indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span(surface.indices)));
  glBindVertexArray(inset_array_.name());
  inset_vertices_.fill(GL_ARRAY_BUFFER, std::as_bytes(std::span(surface.inset_vertices)));
  inset_indices_.fill(GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span(surface.inset_indices)));
  glBindVertexArray(0);
  count_ = static_cast<GLsizei>(surface.indices.size());
  inset_count_ = static_cast<GLsizei>(surface.inset_indices.size());
}

void SurfaceBuffers::draw() const {
  glBindVertexArray(array_.name());
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

void SurfaceBuffers::drawInset() const {
  glBindVertexArray(inset_array_.name());
  glDrawElements(GL_TRIANGLES, inset_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace depthscope::overlay
