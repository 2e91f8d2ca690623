#include "overlay/egl_context.hpp"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <string>

#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

[[noreturn]] void fail(const char* step) {
  char code[16];
  std::snprintf(code, sizeof code, "0x%04x", static_cast<unsigned>(eglGetError()));
  throw InputError(std::string("overlay: ") + step + " failed (EGL error " + code +
                   "); expected Mesa's surfaceless EGL with OpenGL ES 3 (Debian: libegl1, "
                   "libgles2, libgl1-mesa-dri)");
}

}  // namespace

// The display is the process's own and stays initialized: EGL does not count its users, so that
// terminating it here would pull it away under every other context of the process.
EglContext::EglContext() {
  display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display_ == EGL_NO_DISPLAY) fail("eglGetPlatformDisplay(surfaceless)");
  if (!eglInitialize(display_, nullptr, nullptr)) fail("eglInitialize");
  if (!eglBindAPI(EGL_OPENGL_ES_API)) fail("eglBindAPI(OpenGL ES)");
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context_ == EGL_NO_CONTEXT) fail("eglCreateContext(OpenGL ES 3)");
  if (!makeCurrent()) {
    eglDestroyContext(display_, context_);
    fail("eglMakeCurrent(surfaceless)");
  }
}

EglContext::~EglContext() {
  if (eglGetCurrentContext() == context_)
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

bool EglContext::makeCurrent() const {
  if (eglGetCurrentContext() == context_) return true;
  return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
}

}  // namespace depthscope::overlay
