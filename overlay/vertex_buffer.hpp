#pragma once
#include <algorithm>
#include <cstddef>
#include <span>

#include "overlay/gl_object.hpp"

namespace depthscope::overlay {

/// A buffer of vertices or indices whose storage stays when its content is replaced, and grows by
/// doubling: a driver that is made to allocate for every new surface need not give all of it back
/// (Mesa's llvmpipe was seen to lose 33 kB a surface).
class VertexBuffer {
 public:
  GLuint name() const { return buffer_.name(); }
  /// Binds it to `target` and replaces its content.
  void fill(GLenum target, std::span<const std::byte> bytes) {
    glBindBuffer(target, buffer_.name());
    if (bytes.size() > capacity_) {
      capacity_ = std::max(bytes.size(), 2 * capacity_);
      glBufferData(target, static_cast<GLsizeiptr>(capacity_), nullptr, GL_DYNAMIC_DRAW);
    }
    if (!bytes.empty())
      glBufferSubData(target, 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
  }

 private:
  GlBuffer buffer_;
  std::size_t capacity_ = 0;  // [bytes]
};

}  // namespace depthscope::overlay
