#include "platform/display/kms/plane_route.hpp"

#include <drm_fourcc.h>

#include <algorithm>

namespace depthscope::platform::kms {
namespace {

bool takes(const PlaneUnit& plane, std::uint32_t fourcc) {
  return std::find(plane.formats.begin(), plane.formats.end(), fourcc) != plane.formats.end();
}

/// Whether the plane can be told how to convert the picture. One that cannot be told may do it
/// wrong, and the colours would no longer be those that came in.
bool knowsColors(const PlaneUnit& plane, const DmaPicture& picture) {
  if (picture.encoding == DmaPicture::Encoding::Rgb) return true;
  return plane.encoding.id != 0 && plane.range.id != 0 &&
         plane.encoding.values[static_cast<std::size_t>(picture.encoding)].has_value() &&
         plane.range.values[picture.full_range ? 1 : 0].has_value();
}

/// Whether `upper` lies above `lower`. Without a "zpos" overlays lie above the primary plane, and
/// of each other nothing is known.
bool liesAbove(const PlaneUnit& upper, const PlaneUnit& lower) {
  if (upper.zpos && lower.zpos) return *upper.zpos > *lower.zpos;
  return lower.primary && !upper.primary;
}

}  // namespace

int PlaneRoute::find(Card& card, const Pipeline& pipeline, const DmaPicture& picture,
                     std::uint32_t framebuffer, int x, int y, std::unique_ptr<PlaneRoute>& route) {
  std::vector<const PlaneUnit*> units{&pipeline.primary};
  for (const PlaneUnit& unit : pipeline.others) units.push_back(&unit);
  int error = -ENOTSUP;
  for (const PlaneUnit* video : units)
    for (const PlaneUnit* layer : units) {
      // The primary plane has a part in it: many a driver shows nothing without it.
      if (video == layer || !(video->primary || layer->primary)) continue;
      if (!takes(*video, picture.fourcc) || !knowsColors(*video, picture)) continue;
      if (!liesAbove(*layer, *video)) continue;
      auto made = std::make_unique<PlaneRoute>();
      made->kind_ = picture;
      made->crtc_ = pipeline.crtc;
      made->primary_ = pipeline.primary.properties.plane;
      made->x_ = x;
      made->y_ = y;
      made->video_ = *video;
      made->overlay_ = *layer;
      error = made->createLayers(card, *layer);
      if (error != 0) continue;
      AtomicRequest request;
      made->show(request, framebuffer, 0);
      error = request.commit(card, DRM_MODE_ATOMIC_TEST_ONLY, 0);
      if (error != 0) continue;
      route = std::move(made);
      return 0;
    }
  return error;
}

int PlaneRoute::createLayers(Card& card, const PlaneUnit& plane) {
  const bool ours = takes(plane, DRM_FORMAT_ABGR8888);
  if (!ours && !takes(plane, DRM_FORMAT_ARGB8888)) return -ENOTSUP;
  layout_ = ours ? PixelLayout::Rgbx32 : PixelLayout::Bgrx32;
  for (Layer& layer : layers_)
    if (const int error =
            DumbBuffer::create(card, kind_.width, kind_.height,
                               ours ? DRM_FORMAT_ABGR8888 : DRM_FORMAT_ARGB8888, layer.memory))
      return error;
  return 0;
}

void PlaneRoute::draw(int buffer, const LayerView& layer) {
  Layer& target = layers_[static_cast<std::size_t>(buffer)];
  std::uint8_t* memory = target.memory.bytes().data();
  const auto at = [&](int x, int y) {
    return memory + static_cast<std::ptrdiff_t>(y) * target.memory.pitch() +
           static_cast<std::ptrdiff_t>(x) * 4;
  };
  const overlay::PixelRect& old = target.drawn;
  for (int y = old.y0; y < old.y1; ++y) std::fill_n(at(old.x0, y), old.width() * 4, 0);
  target.drawn = layer.rect;
  for (int y = layer.rect.y0; y < layer.rect.y1; ++y)
    copyRow(layer.pixels + (static_cast<std::ptrdiff_t>(y) * layer.width + layer.rect.x0) * 4,
            layer.rect.width(), layout_, at(layer.rect.x0, y));
}

void PlaneRoute::show(AtomicRequest& request, std::uint32_t framebuffer, int buffer) const {
  video_.properties.show(request, crtc_, framebuffer, x_, y_, kind_.width, kind_.height);
  addColors(request);
  overlay_.properties.show(request, crtc_,
                           layers_[static_cast<std::size_t>(buffer)].memory.framebuffer(), x_, y_,
                           kind_.width, kind_.height);
}

void PlaneRoute::addColors(AtomicRequest& request) const {
  if (kind_.encoding == DmaPicture::Encoding::Rgb) return;
  const auto value = video_.encoding.values[static_cast<std::size_t>(kind_.encoding)];
  request.add(video_.properties.plane, video_.encoding.id, value.value_or(0));
  request.add(video_.properties.plane, video_.range.id,
              video_.range.values[kind_.full_range ? 1 : 0].value_or(0));
}

void PlaneRoute::hide(AtomicRequest& request) const {
  for (const PlaneUnit* unit : {&video_, &overlay_})
    if (unit->properties.plane != primary_) unit->properties.hide(request);
}

}  // namespace depthscope::platform::kms
