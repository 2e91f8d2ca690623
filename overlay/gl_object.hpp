#pragma once
#include <GLES3/gl3.h>

namespace depthscope::overlay {

/// Owns one OpenGL object. The context it belongs to must be current where it is made and
/// destroyed.
template <void (*Generate)(GLsizei, GLuint*), void (*Delete)(GLsizei, const GLuint*)>
class GlObject {
 public:
  GlObject() { Generate(1, &name_); }
  ~GlObject() { Delete(1, &name_); }
  GlObject(const GlObject&) = delete;
  GlObject& operator=(const GlObject&) = delete;

  GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

using GlBuffer = GlObject<glGenBuffers, glDeleteBuffers>;
using GlTexture = GlObject<glGenTextures, glDeleteTextures>;
using GlFramebuffer = GlObject<glGenFramebuffers, glDeleteFramebuffers>;
using GlVertexArray = GlObject<glGenVertexArrays, glDeleteVertexArrays>;

}  // namespace depthscope::overlay
