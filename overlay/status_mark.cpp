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
      return "uncertain";
    case Mark::Lost:
      return "lost";
    case Mark::Stale:
      return "stale";
    case Mark::NoSignal:
      return "no signal";
  }
  return "";
}

void drawMarkSymbol(Mark mark, const Vector2f& centre, float radius, Ink& ink) {
  const Color c = markColor(mark);
  const float r = radius, w = std::max(1.3f, 0.26f * radius);
  const auto at = [&](float x, float y) {
    return Vector2f(centre.x() + x * r, centre.y() + y * r);
  };
  switch (mark) {
    case Mark::Tracking:  // target
      ink.ring(centre, r, w, c);
      ink.disc(centre, 0.42f * r, c);
      break;
    case Mark::Initializing:  // three dots
      for (float x : {-0.75f, 0.0f, 0.75f}) ink.disc(at(x, 0), 0.25f * r, c);
      break;
    case Mark::Uncertain:  // triangle
      ink.line(at(0, -0.85f), at(0.9f, 0.7f), w, c);
      ink.line(at(0.9f, 0.7f), at(-0.9f, 0.7f), w, c);
      ink.line(at(-0.9f, 0.7f), at(0, -0.85f), w, c);
      break;
    case Mark::Stale:  // clock
      ink.ring(centre, r, w, c);
      ink.line(centre, at(0, -0.55f), w, c);
      ink.line(centre, at(0.4f, 0.25f), w, c);
      break;
    case Mark::Lost:  // cross
      ink.line(at(-0.7f, -0.7f), at(0.7f, 0.7f), 1.2f * w, c);
      ink.line(at(-0.7f, 0.7f), at(0.7f, -0.7f), 1.2f * w, c);
      break;
    case Mark::NoSignal:  // screen, struck through
      ink.box(centre, {r, 0.72f * r}, 0.2f * r, w, c);
      ink.line(at(-0.9f, 0.95f), at(0.9f, -0.95f), w, c);
      break;
    case Mark::NoAr:  // empty ring
      ink.ring(centre, 0.9f * r, w, c);
      break;
  }
}

PixelRect drawStatusMark(Mark mark, const TextSpot& text, const TextSpot& message,
                         const Vector2f& corner, Ink& ink) {
  const auto h = static_cast<float>(text.height);
  const float pad = std::round(0.32f * h), symbol = std::round(0.30f * h);
  const float gap = message.empty() ? 0.0f : pad;
  const float width = 3 * pad + 2 * symbol + static_cast<float>(text.width) + gap +
                      static_cast<float>(message.width);
  const float height = h + std::round(0.2f * h);
  const Vector2f half(0.5f * width, 0.5f * height);
  ink.box(corner + half, half, half.y(), 0, kPanel);
  drawMarkSymbol(mark, corner + Vector2f(pad + symbol, half.y()), symbol, ink);
  const float top = corner.y() + 0.5f * (height - h);
  const float left = corner.x() + 2 * pad + 2 * symbol;
  ink.text({left, top}, text, kText);
  ink.text({left + static_cast<float>(text.width) + gap, top}, message, kText.withAlpha(0.8f));
  return {static_cast<int>(corner.x()) - 1, static_cast<int>(corner.y()) - 1,
          static_cast<int>(corner.x() + width) + 2, static_cast<int>(corner.y() + height) + 2};
}

}  // namespace depthscope::overlay
