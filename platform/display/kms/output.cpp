#include "platform/display/kms/output.hpp"

#include <drm_fourcc.h>

#include <algorithm>

namespace depthscope::platform::kms {
namespace {

struct Format {
  std::uint32_t fourcc;  // names the bytes from the highest to the lowest of a little-endian word
  PixelLayout layout;
};

/// Ours first: then the copy into the buffer moves bytes and changes none.
constexpr Format formats[] = {{DRM_FORMAT_XBGR8888, PixelLayout::Rgbx32},
                              {DRM_FORMAT_ABGR8888, PixelLayout::Rgbx32},
                              {DRM_FORMAT_XRGB8888, PixelLayout::Bgrx32},
                              {DRM_FORMAT_ARGB8888, PixelLayout::Bgrx32}};

bool same(const Placement& a, const Placement& b) {
  return a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height;
}

}  // namespace

int ModeBlob::create(Card& card, const drm_mode_modeinfo& mode, ModeBlob& blob) {
  drm_mode_create_blob create{};
  create.data = reinterpret_cast<std::uintptr_t>(&mode);
  create.length = sizeof mode;
  if (const int error = card.ioctl(DRM_IOCTL_MODE_CREATEPROPBLOB, &create)) return error;
  blob = ModeBlob();
  blob.card_ = &card;
  blob.id_ = create.blob_id;
  return 0;
}

ModeBlob& ModeBlob::operator=(ModeBlob&& other) noexcept {
  std::swap(card_, other.card_);
  std::swap(id_, other.id_);
  return *this;
}

ModeBlob::~ModeBlob() {
  if (id_ == 0) return;
  drm_mode_destroy_blob destroy{id_};
  card_->release(DRM_IOCTL_MODE_DESTROYPROPBLOB, &destroy);
}

int Output::create(Card& card, const Pipeline& pipeline, const drm_mode_modeinfo& mode,
                   std::unique_ptr<Output>& output) {
  auto made = std::make_unique<Output>();
  made->card_ = &card;
  made->pipeline_ = pipeline;
  made->mode_ = mode;
  if (const int error = ModeBlob::create(card, mode, made->blob_)) return error;
  int error = -ENOTSUP;
  for (const Format& format : formats) {
    const auto& offered = pipeline.primary.formats;
    if (std::find(offered.begin(), offered.end(), format.fourcc) == offered.end()) continue;
    made->layout_ = format.layout;
    error = made->createBuffers(format.fourcc);
    Shot first;
    first.buffer = 0;
    if (error == 0) error = made->commit(first, true, DRM_MODE_ATOMIC_TEST_ONLY, 0);
    if (error == 0) {
      output = std::move(made);
      return 0;
    }
  }
  return error;
}

int Output::createBuffers(std::uint32_t fourcc) {
  for (Buffer& buffer : buffers_) {
    buffer.drawn = {};
    buffer.memory.reset();
    if (const int error =
            DumbBuffer::create(*card_, mode_.hdisplay, mode_.vdisplay, fourcc, buffer.memory))
      return error;
  }
  return 0;
}

DisplayMode Output::mode() const {
  return {mode_.hdisplay, mode_.vdisplay, refreshRate(mode_)};
}

void Output::draw(int buffer, const RgbaView& picture, PictureCopier& copier) {
  Buffer& target = buffers_[static_cast<std::size_t>(buffer)];
  const auto bytes = target.memory.bytes();
  const Placement place =
      placePicture(picture.width, picture.height, mode_.hdisplay, mode_.vdisplay);
  if (!same(place, target.drawn)) {
    std::fill(bytes.begin(), bytes.end(), std::uint8_t{0});
    target.drawn = place;
  }
  copier.copy(picture,
              {bytes.data(), mode_.hdisplay, mode_.vdisplay, target.memory.pitch(), layout_});
}

int Output::import(const DmaPicture& picture, ImportedPicture& imported) {
  if (refused_ && refused_->sameKind(picture)) return -ENOTSUP;
  const Placement place =
      placePicture(picture.width, picture.height, mode_.hdisplay, mode_.vdisplay);
  const bool fits = place.width == picture.width && place.height == picture.height;
  int error = fits ? ImportedPicture::import(*card_, picture, imported) : -ENOTSUP;
  if (error == 0 && !(route_ && route_->kind().sameKind(picture))) {
    route_.reset();
    error = PlaneRoute::find(*card_, pipeline_, picture, imported.framebuffer(), place.x, place.y,
                             route_);
  }
  // An error of the moment is no refusal: the next picture asks again.
  const bool momentary =
      error == -EINTR || error == -EAGAIN || error == -EBUSY || error == -ENOMEM || error == -EIO;
  if (error != 0 && !momentary) refused_ = picture;
  if (error != 0) imported.reset();
  return error;
}

int Output::drawByGpu(const capture::Frame& frame, const LayerView& layer, GpuComposerMaker make,
                      Shot& shot) {
  if (gpu_refused_) return -ENOTSUP;
  int error = gpu_ ? 0 : make(*card_, mode_.hdisplay, mode_.vdisplay, gpu_);
  if (error == 0 && !gpu_->takes(frame)) return -ENOTSUP;
  if (error == 0) error = gpu_->draw(shot.gpu, frame, layer, shot.drawn);
  // Its buffers stay where they are: one may be on screen.
  if (error != 0) gpu_refused_ = true;
  return error;
}

void Output::refuse(const Shot& shot) {
  if (shot.gpu >= 0) gpu_refused_ = true;
  if (shot.layer >= 0 && route_) refused_ = route_->kind();
}

int Output::flip(const Shot& shot, bool modeset, std::uint64_t serial) const {
  return commit(shot, modeset, DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT, serial);
}

int Output::commit(const Shot& shot, bool modeset, std::uint32_t flags,
                   std::uint64_t serial) const {
  AtomicRequest request;
  if (modeset) {
    flags |= DRM_MODE_ATOMIC_ALLOW_MODESET;
    pipeline_.light(request, blob_.id());
  }
  if (shot.layer >= 0) {
    route_->show(request, shot.picture.framebuffer(), shot.layer);
  } else {
    if (route_) route_->hide(request);
    const PlaneProperties& primary = pipeline_.primary.properties;
    const auto buffer = static_cast<std::size_t>(shot.buffer);
    primary.show(
        request, pipeline_.crtc,
        shot.gpu >= 0 ? gpu_->framebuffer(shot.gpu) : buffers_[buffer].memory.framebuffer(), 0, 0,
        mode_.hdisplay, mode_.vdisplay);
    if (shot.drawn.valid())
      request.add(primary.plane, primary.in_fence, static_cast<std::uint64_t>(shot.drawn.get()));
  }
  return request.commit(*card_, flags, serial);
}

}  // namespace depthscope::platform::kms
