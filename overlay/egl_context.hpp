#pragma once

namespace depthscope::overlay {

/// An OpenGL ES 3 context without window or surface, current on the thread that made it.
class EglContext {
 public:
  /// Throws InputError that names the step which failed.
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes it the calling thread's current context again; cheap when it is.
  bool makeCurrent() const;

 private:
  // EGLDisplay and EGLContext, kept as what they are so that EGL's headers (and X11's macros behind
  // them) stay out of ours.
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace depthscope::overlay
