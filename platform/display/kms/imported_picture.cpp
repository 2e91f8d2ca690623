#include "platform/display/kms/imported_picture.hpp"

#include <algorithm>
#include <utility>

namespace depthscope::platform::kms {

int ImportedPicture::import(Card& card, const DmaPicture& picture, ImportedPicture& imported) {
  ImportedPicture made;
  made.card_ = &card;
  drm_mode_fb_cmd2 add{};
  add.width = static_cast<std::uint32_t>(picture.width);
  add.height = static_cast<std::uint32_t>(picture.height);
  add.pixel_format = picture.fourcc;
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i) {
    const DmaPicture::Plane& plane = picture.planes[i];
    drm_prime_handle prime{};
    prime.fd = plane.fd;
    if (const int error = card.ioctl(DRM_IOCTL_PRIME_FD_TO_HANDLE, &prime)) return error;
    // Planes in one DMABUF have one handle, to be given back once.
    auto& handles = made.handles_;
    if (std::find(handles.begin(), handles.end(), prime.handle) == handles.end())
      handles[i] = prime.handle;
    add.handles[i] = prime.handle;
    add.offsets[i] = plane.offset;
    add.pitches[i] = plane.pitch;
  }
  if (const int error = card.ioctl(DRM_IOCTL_MODE_ADDFB2, &add)) return error;
  made.framebuffer_ = add.fb_id;
  imported = std::move(made);
  return 0;
}

ImportedPicture& ImportedPicture::operator=(ImportedPicture&& other) noexcept {
  if (this != &other) {
    reset();
    card_ = other.card_;
    framebuffer_ = std::exchange(other.framebuffer_, 0);
    handles_ = std::exchange(other.handles_, {});
  }
  return *this;
}

void ImportedPicture::reset() {
  if (framebuffer_ != 0) {
    unsigned id = std::exchange(framebuffer_, 0);
    card_->release(DRM_IOCTL_MODE_RMFB, &id);
  }
  for (std::uint32_t& handle : handles_)
    if (handle != 0) {
      drm_gem_close close{std::exchange(handle, 0), 0};
      card_->release(DRM_IOCTL_GEM_CLOSE, &close);
    }
}

}  // namespace depthscope::platform::kms
