#pragma once
#include <cstdint>
#include <string_view>

#include "overlay/stamp.hpp"

namespace depthscope::overlay {

/// What the mark can say. `Uncertain`: there is a pose, but too doubtful a one to draw by.
enum class Mark : std::uint8_t { NoAr, Initializing, Tracking, Uncertain, Lost, Stale, NoSignal };
inline constexpr int kMarks = 7;

std::string_view markText(Mark mark);

/// A symbol for the mark, `radius` px around `centre`: every one of another shape, for colour alone
/// tells nothing to one surgeon in twelve.
void drawMarkSymbol(Mark mark, const Eigen::Vector2f& centre, float radius, Stamp& stamp);

/// Symbol, text and message in a small pill. `message` may be empty.
Stamp makeMarkStamp(Mark mark, const TextBitmap& text, const TextBitmap& message);

}  // namespace depthscope::overlay
