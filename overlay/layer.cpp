#include "overlay/layer.hpp"

#include <initializer_list>

namespace depthscope::overlay {
namespace {

void allocate(GLuint texture, GLenum internal, GLenum format, GLenum type, int width, int height) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), width, height, 0, format, type,
               nullptr);
  for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
}

}  // namespace

bool Layer::resize(int width, int height) {
  if (width == width_ && height == height_) return true;
  width_ = height_ = 0;
  allocate(color_.name(), GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width, height);
  allocate(depth_.name(), GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, width, height);
  bool complete = true;
  for (const GlFramebuffer* target : {&solid_, &flat_}) {
    glBindFramebuffer(GL_FRAMEBUFFER, target->name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_.name(), 0);
    if (target == &solid_)
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.name(), 0);
    complete &= glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }
  if (!complete) return false;
  width_ = width;
  height_ = height;
  return true;
}

void Layer::beginSolid() {
  glBindFramebuffer(GL_FRAMEBUFFER, solid_.name());
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClearDepthf(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Layer::beginFlat() {
  glBindFramebuffer(GL_FRAMEBUFFER, flat_.name());
  glViewport(0, 0, width_, height_);
  glDisable(GL_DEPTH_TEST);
}

void Layer::read(const PixelRect& rect, std::uint8_t* rgba) {
  glBindFramebuffer(GL_FRAMEBUFFER, flat_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(rect.x0, rect.y0, rect.width(), rect.height(), GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

}  // namespace depthscope::overlay
