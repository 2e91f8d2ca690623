#include <drm_fourcc.h>
#include <gbm.h>

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>
// Needs the types of the one above.
#include <GLES2/gl2ext.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "overlay/gl_object.hpp"
#include "platform/display/gpu/gpu_composer.hpp"
#include "platform/display/gpu/picture_painter.hpp"
#include "platform/display/kms/card.hpp"
#include "platform/display/picture_copy.hpp"
#include "types/error.hpp"

namespace depthscope::platform::kms {
namespace {

void generateRenderbuffers(GLsizei count, GLuint* names) {
  glGenRenderbuffers(count, names);
}
void deleteRenderbuffers(GLsizei count, const GLuint* names) {
  glDeleteRenderbuffers(count, names);
}
using GlRenderbuffer = overlay::GlObject<generateRenderbuffers, deleteRenderbuffers>;

/// Whether a list of extensions, set apart by blanks, has this one.
bool has(const char* extensions, std::string_view wanted) {
  std::string_view rest = extensions != nullptr ? extensions : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == wanted) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

/// EGL on a card. Its display is the card's alone, so that it ends with this.
class GbmContext {
 public:
  GbmContext() = default;
  GbmContext(const GbmContext&) = delete;
  GbmContext& operator=(const GbmContext&) = delete;
  ~GbmContext() {
    if (display_ != EGL_NO_DISPLAY) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
      eglTerminate(display_);
    }
    if (device_ != nullptr) gbm_device_destroy(device_);
  }

  bool open(int card) {
    device_ = gbm_create_device(card);
    if (device_ == nullptr) return false;
    const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_GBM_KHR, device_, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return false;
    display_ = display;
    const char* extensions = eglQueryString(display_, EGL_EXTENSIONS);
    has_fences_ = has(extensions, "EGL_ANDROID_native_fence_sync");
    if (!eglBindAPI(EGL_OPENGL_ES_API)) return false;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    return context_ != EGL_NO_CONTEXT && makeCurrent() &&
           has(reinterpret_cast<const char*>(glGetString(GL_EXTENSIONS)), "GL_OES_EGL_image");
  }

  bool makeCurrent() const {
    return eglGetCurrentContext() == context_ ||
           eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
  }
  gbm_device* device() const { return device_; }
  EGLDisplay display() const { return display_; }
  bool hasFences() const { return has_fences_; }

 private:
  gbm_device* device_ = nullptr;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  bool has_fences_ = false;
};

/// A buffer that the graphics processor draws into and the card scans out.
class GbmBuffer {
 public:
  GbmBuffer() = default;
  GbmBuffer(const GbmBuffer&) = delete;
  GbmBuffer& operator=(const GbmBuffer&) = delete;
  ~GbmBuffer() {
    target_.reset();
    renderbuffer_.reset();
    if (image_ != EGL_NO_IMAGE) eglDestroyImage(context_->display(), image_);
    if (framebuffer_ != 0) card_->release(DRM_IOCTL_MODE_RMFB, &framebuffer_);
    if (memory_ != nullptr) gbm_bo_destroy(memory_);
  }

  int create(Card& card, const GbmContext& context, int width, int height) {
    card_ = &card;
    context_ = &context;
    memory_ = gbm_bo_create(context.device(), static_cast<std::uint32_t>(width),
                            static_cast<std::uint32_t>(height), GBM_FORMAT_XRGB8888,
                            GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING);
    if (memory_ == nullptr) return -ENOTSUP;
    if (const int error = addFramebuffer(width, height)) return error;
    return makeTarget() ? 0 : -ENOTSUP;
  }

  void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, target_->name()); }
  std::uint32_t framebuffer() const { return framebuffer_; }

 private:
  int addFramebuffer(int width, int height) {
    drm_mode_fb_cmd2 add{};
    add.width = static_cast<std::uint32_t>(width);
    add.height = static_cast<std::uint32_t>(height);
    add.pixel_format = DRM_FORMAT_XRGB8888;
    add.handles[0] = gbm_bo_get_handle(memory_).u32;
    add.pitches[0] = gbm_bo_get_stride(memory_);
    const int error = card_->ioctl(DRM_IOCTL_MODE_ADDFB2, &add);
    if (error == 0) framebuffer_ = add.fb_id;
    return error;
  }

  bool makeTarget() {
    const auto attach = reinterpret_cast<PFNGLEGLIMAGETARGETRENDERBUFFERSTORAGEOESPROC>(
        eglGetProcAddress("glEGLImageTargetRenderbufferStorageOES"));
    image_ = eglCreateImage(context_->display(), EGL_NO_CONTEXT, EGL_NATIVE_PIXMAP_KHR,
                            reinterpret_cast<EGLClientBuffer>(memory_), nullptr);
    if (attach == nullptr || image_ == EGL_NO_IMAGE) return false;
    renderbuffer_.emplace();
    target_.emplace();
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer_->name());
    attach(GL_RENDERBUFFER, image_);
    bind();
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                              renderbuffer_->name());
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }

  Card* card_ = nullptr;
  const GbmContext* context_ = nullptr;
  gbm_bo* memory_ = nullptr;
  unsigned framebuffer_ = 0;  // of the card
  EGLImage image_ = EGL_NO_IMAGE;
  std::optional<GlRenderbuffer> renderbuffer_;
  std::optional<overlay::GlFramebuffer> target_;
};

class GbmComposer final : public GpuComposer {
 public:
  GbmComposer(Card& card, int width, int height) : card_(card), width_(width), height_(height) {}
  ~GbmComposer() override { context_.makeCurrent(); }

  int open() {
    if (!context_.open(card_.fd())) return -ENOTSUP;
    for (GbmBuffer& buffer : buffers_)
      if (const int error = buffer.create(card_, context_, width_, height_)) return error;
    painter_.emplace();
    return 0;
  }

  bool takes(const capture::Frame& frame) const override {
    return frame.format.width <= width_ && frame.format.height <= height_ &&
           PicturePainter::takes(frame);
  }

  int draw(int buffer, const capture::Frame& frame, const LayerView& layer,
           kernel::OwnedFd& done) override {
    if (!context_.makeCurrent()) return -EIO;
    const Placement place = placePicture(frame.format.width, frame.format.height, width_, height_);
    buffers_[static_cast<std::size_t>(buffer)].bind();
    if (!painter_->paint(frame, layer, place.x, place.y, width_, height_)) return -EIO;
    done = fence();
    return 0;
  }

  std::uint32_t framebuffer(int buffer) const override {
    return buffers_[static_cast<std::size_t>(buffer)].framebuffer();
  }

 private:
  /// A file that is readable when all that was asked for is drawn; where there is no such thing it
  /// is waited for.
  kernel::OwnedFd fence() {
    if (context_.hasFences()) {
      const EGLSync sync =
          eglCreateSync(context_.display(), EGL_SYNC_NATIVE_FENCE_ANDROID, nullptr);
      glFlush();
      const auto duplicate = reinterpret_cast<PFNEGLDUPNATIVEFENCEFDANDROIDPROC>(
          eglGetProcAddress("eglDupNativeFenceFDANDROID"));
      const int fd = sync != EGL_NO_SYNC && duplicate != nullptr
                         ? duplicate(context_.display(), sync)
                         : EGL_NO_NATIVE_FENCE_FD_ANDROID;
      if (sync != EGL_NO_SYNC) eglDestroySync(context_.display(), sync);
      if (fd >= 0) return {card_.calls(), fd};
    }
    glFinish();
    return {};
  }

  Card& card_;
  int width_, height_;
  GbmContext context_;
  std::array<GbmBuffer, buffer_count> buffers_;
  std::optional<PicturePainter> painter_;
};

}  // namespace

int makeGbmComposer(Card& card, int width, int height, std::unique_ptr<GpuComposer>& composer) {
  auto made = std::make_unique<GbmComposer>(card, width, height);
  try {
    if (const int error = made->open()) return error;
  } catch (const InputError&) {  // its shaders are not for this driver
    return -ENOTSUP;
  }
  composer = std::move(made);
  return 0;
}

}  // namespace depthscope::platform::kms
