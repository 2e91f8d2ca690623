#include "overlay/status_painter.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace depthscope::overlay {
namespace {

constexpr std::uint8_t kFaultPixel[4] = {13, 15, 18, 255};
constexpr std::size_t kMostStamps = 64;  // more texts than anything here says in one size
constexpr Color kPanel{0.04f, 0.05f, 0.07f, 0.8f};
constexpr Color kText{0.92f, 0.94f, 0.95f, 1};

int markTextPx(int height) {
  return std::max(11, height / 40);
}
int noticeTextPx(int height) {
  return std::max(14, height / 22);
}
int margin(int height) {
  return height / 48;
}

}  // namespace

Mark markFor(const OverlayState& state, const OverlaySettings& settings, bool camera_size) {
  switch (state.status) {
    case Status::NoAr:
      return Mark::NoAr;
    case Status::Initializing:
      return Mark::Initializing;
    case Status::Lost:
      return Mark::Lost;
    case Status::Stale:
      return Mark::Stale;
    case Status::NoSignal:
      return Mark::NoSignal;
    case Status::Tracking:
      break;
  }
  if (!(state.age_ms < settings.max_age_ms)) return Mark::Stale;
  return camera_size && poseAlpha(state, settings) > 0 ? Mark::Tracking : Mark::Uncertain;
}

StatusPainter::StatusPainter(const std::string& font_file) : rasterizer_(font_file) {
  stamps_.reserve(kMostStamps);
}

void StatusPainter::prepare(int width, int height, std::span<const std::string_view> messages) {
  fit(width, height);
  for (int m = 0; m < kMarks; ++m) markStamp(static_cast<Mark>(m), {});
  for (std::string_view message : messages) noticeStamp(message);
}

void StatusPainter::fit(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  stamps_.clear();
}

const Stamp* StatusPainter::find(Kind kind, Mark mark, std::string_view message) const {
  for (const Entry& e : stamps_)
    if (e.kind == kind && e.mark == mark && e.message == message) return &e.stamp;
  return nullptr;
}

const Stamp& StatusPainter::markStamp(Mark mark, std::string_view message) {
  if (const Stamp* known = find(Kind::Mark, mark, message)) return *known;
  if (stamps_.size() == kMostStamps) stamps_.clear();
  TextBitmap text, beside;
  const int size = markTextPx(height_);
  rasterizer_.rasterize(markText(mark), size, width_ * 3 / 4, text);
  if (!message.empty()) rasterizer_.rasterize(message, size, width_ * 3 / 4, beside);
  stamps_.push_back({Kind::Mark, mark, std::string(message), makeMarkStamp(mark, text, beside)});
  return stamps_.back().stamp;
}

const Stamp& StatusPainter::noticeStamp(std::string_view message) {
  if (const Stamp* known = find(Kind::Notice, Mark::NoSignal, message)) return *known;
  if (stamps_.size() == kMostStamps) stamps_.clear();
  TextBitmap text;
  const int size = noticeTextPx(height_);
  rasterizer_.rasterize(message, size, width_ * 3 / 4, text);
  const int pad = size, width = std::max(text.width, 4 * size) + 2 * pad;
  const int height = 2 * size + text.height + 3 * pad;
  Stamp stamp(width, height);
  const Eigen::Vector2f half(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height));
  stamp.box(half, half, static_cast<float>(pad), 0, kPanel);
  drawMarkSymbol(Mark::NoSignal, {half.x(), static_cast<float>(pad + size)},
                 static_cast<float>(size), stamp);
  stamp.text({(width - text.width) / 2, 2 * pad + 2 * size}, text, kText);
  stamps_.push_back({Kind::Notice, Mark::NoSignal, std::string(message), std::move(stamp)});
  return stamps_.back().stamp;
}

PixelRect StatusPainter::markRect(int width, int height, Mark mark, std::string_view message) {
  fit(width, height);
  const Stamp& stamp = markStamp(mark, message);
  const int at = margin(height);
  return PixelRect{at, at, at + stamp.width(), at + stamp.height()}.clipped({0, 0, width, height});
}

void StatusPainter::paintMark(Mark mark, std::string_view message, std::span<std::uint8_t> picture,
                              int width, int height) {
  fit(width, height);
  markStamp(mark, message).overPicture(margin(height), margin(height), picture, width, height);
}

void StatusPainter::paintMarkOnLayer(Mark mark, std::string_view message, int width, int height,
                                     std::span<std::uint8_t> layer, const PixelRect& rect) {
  fit(width, height);
  markStamp(mark, message).overLayer(margin(height), margin(height), layer, rect);
}

void StatusPainter::paintFault(std::string_view message, std::span<std::uint8_t> picture, int width,
                               int height) {
  const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  for (std::size_t i = 0; i < bytes; i += 4) std::memcpy(picture.data() + i, kFaultPixel, 4);
  paintNotice(message, picture, width, height);
}

void StatusPainter::paintStale(std::string_view message, std::span<std::uint8_t> picture, int width,
                               int height) {
  const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  for (std::size_t i = 0; i < bytes; ++i)
    if (i % 4 != 3) picture[i] = static_cast<std::uint8_t>(picture[i] / 2);
  paintNotice(message, picture, width, height);
}

void StatusPainter::paintNotice(std::string_view message, std::span<std::uint8_t> picture,
                                int width, int height) {
  fit(width, height);
  const Stamp& stamp = noticeStamp(message);
  stamp.overPicture((width - stamp.width()) / 2, (height - stamp.height()) / 2, picture, width,
                    height);
}

}  // namespace depthscope::overlay
