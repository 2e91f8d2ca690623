#include "platform/display/kms/dumb_buffer.hpp"

#include <algorithm>

namespace depthscope::platform::kms {

int DumbBuffer::create(Card& card, int width, int height, std::uint32_t fourcc,
                       DumbBuffer& buffer) {
  DumbBuffer made;
  made.card_ = &card;
  drm_mode_create_dumb create{};
  create.width = static_cast<std::uint32_t>(width);
  create.height = static_cast<std::uint32_t>(height);
  create.bpp = 32;
  if (const int error = card.ioctl(DRM_IOCTL_MODE_CREATE_DUMB, &create)) return error;
  made.handle_ = create.handle;
  made.pitch_ = create.pitch;

  drm_mode_fb_cmd2 add{};
  add.width = create.width;
  add.height = create.height;
  add.pixel_format = fourcc;
  add.handles[0] = create.handle;
  add.pitches[0] = create.pitch;
  if (const int error = card.ioctl(DRM_IOCTL_MODE_ADDFB2, &add)) return error;
  made.framebuffer_ = add.fb_id;

  drm_mode_map_dumb map{};
  map.handle = create.handle;
  if (const int error = card.ioctl(DRM_IOCTL_MODE_MAP_DUMB, &map)) return error;
  int error = 0;
  made.mapping_ = kernel::Mapping(card.calls(), card.fd(), create.size, true,
                                  static_cast<off_t>(map.offset), error);
  if (!made.mapping_.valid()) return error;
  const auto bytes = made.bytes();
  std::fill(bytes.begin(), bytes.end(), std::uint8_t{0});
  buffer = std::move(made);
  return 0;
}

DumbBuffer& DumbBuffer::operator=(DumbBuffer&& other) noexcept {
  if (this != &other) {
    reset();
    card_ = other.card_;
    handle_ = std::exchange(other.handle_, 0);
    framebuffer_ = std::exchange(other.framebuffer_, 0);
    pitch_ = other.pitch_;
    mapping_ = std::move(other.mapping_);
  }
  return *this;
}

void DumbBuffer::reset() {
  mapping_.reset();
  if (framebuffer_ != 0) {
    unsigned id = std::exchange(framebuffer_, 0);
    card_->release(DRM_IOCTL_MODE_RMFB, &id);
  }
  if (handle_ != 0) {
    drm_mode_destroy_dumb destroy{std::exchange(handle_, 0)};
    card_->release(DRM_IOCTL_MODE_DESTROY_DUMB, &destroy);
  }
}

}  // namespace depthscope::platform::kms
