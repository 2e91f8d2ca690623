#include "overlay/status_mark.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::overlay {
namespace {

using Eigen::Vector2f;

constexpr Color kPanel{0.04f, 0.05f, 0.07f, 0.62f};
constexpr Color kText{0.92f, 0.94f, 0.95f, 1};

Color markColor(Mark mark) {
  switch (mark) {
    case Mark::Tracking:
      return {0.45f, 0.86f, 0.66f, 1};
    case Mark::Initializing:
      return {0.62f, 0.80f, 0.98f, 1};
    case Mark::Uncertain:
    case Mark::Stale:
      return {0.99f, 0.80f, 0.36f, 1};
    case Mark::Lost:
    case Mark::NoSignal:
      return {1.00f, 0.50f, 0.38f, 1};
    case Mark::NoAr:
      break;
  }
  return {0.74f, 0.77f, 0.80f, 1};
}

}  // namespace

std::string_view markText(Mark mark) {
  switch (mark) {
    case Mark::NoAr:
      return "no AR";
    case Mark::Initializing:
      return "initializing";
    case Mark::Tracking:
      return "tracking";
    case Mark::Uncertain:
      return "tracking uncertain";
    case Mark::Lost:
      return "tracking lost";
    case Mark::Stale:
      return "AR is late";
    case Mark::NoSignal:
      return "no signal";
  }
  return "";
}

void drawMarkSymbol(Mark mark, const Vector2f& centre, float radius, Stamp& stamp) {
  const Color c = markColor(mark);
  const float r = radius, w = std::max(1.3f, 0.26f * radius);
  const auto at = [&](float x, float y) {
    return Vector2f(centre.x() + x * r, centre.y() + y * r);
  };
  switch (mark) {
    case Mark::Tracking:  // target
      stamp.ring(centre, r, w, c);
      stamp.disc(centre, 0.42f * r, c);
      break;
    case Mark::Initializing:  // three dots
      for (float x : {-0.75f, 0.0f, 0.75f}) stamp.disc(at(x, 0), 0.25f * r, c);
      break;
    case Mark::Uncertain:  // triangle
      stamp.line(at(0, -0.85f), at(0.9f, 0.7f), w, c);
      stamp.line(at(0.9f, 0.7f), at(-0.9f, 0.7f), w, c);
      stamp.line(at(-0.9f, 0.7f), at(0, -0.85f), w, c);
      break;
    case Mark::Stale:  // clock
      stamp.ring(centre, r, w, c);
      stamp.line(centre, at(0, -0.55f), w, c);
      stamp.line(centre, at(0.4f, 0.25f), w, c);
      break;
    case Mark::Lost:  // cross
      stamp.line(at(-0.7f, -0.7f), at(0.7f, 0.7f), 1.2f * w, c);
      stamp.line(at(-0.7f, 0.7f), at(0.7f, -0.7f), 1.2f * w, c);
      break;
    case Mark::NoSignal:  // screen, struck through
      stamp.box(centre, {r, 0.72f * r}, 0.2f * r, w, c);
      stamp.line(at(-0.9f, 0.95f), at(0.9f, -0.95f), w, c);
      break;
    case Mark::NoAr:  // empty ring
      stamp.ring(centre, 0.9f * r, w, c);
      break;
  }
}

Stamp makeMarkStamp(Mark mark, const TextBitmap& text, const TextBitmap& message) {
  const int h = text.height;
  const int pad = static_cast<int>(std::lround(0.32 * h));
  const int symbol = static_cast<int>(std::lround(0.30 * h));
  const int gap = message.width > 0 ? pad : 0;
  const int width = 3 * pad + 2 * symbol + text.width + gap + message.width;
  const int height = h + static_cast<int>(std::lround(0.2 * h));
  Stamp stamp(width, height);
  const Vector2f half(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height));
  stamp.box(half, half, half.y(), 0, kPanel);
  drawMarkSymbol(mark, {static_cast<float>(pad + symbol), half.y()}, static_cast<float>(symbol),
                 stamp);
  const int top = (height - h) / 2, left = 2 * pad + 2 * symbol;
  stamp.text({left, top}, text, kText);
  stamp.text({left + text.width + gap, top}, message, kText.withAlpha(0.8f));
  return stamp;
}

}  // namespace depthscope::overlay
