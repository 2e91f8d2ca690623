#pragma once
#include <string_view>

#include "overlay/ink.hpp"

namespace depthscope::overlay {

/// What the mark can say. `Uncertain`: there is a pose, but too doubtful a one to draw by.
enum class Mark : std::uint8_t { NoAr, Initializing, Tracking, Uncertain, Lost, Stale, NoSignal };
inline constexpr int kMarks = 7;

std::string_view markText(Mark mark);

/// A symbol for the mark, `radius` px around `centre`: every one of another shape, for colour alone
/// tells nothing to one surgeon in twelve.
void drawMarkSymbol(Mark mark, const Eigen::Vector2f& centre, float radius, Ink& ink);

/// Symbol, text and message in a small pill whose top left corner is at `corner`. Returns what it
/// covers.
PixelRect drawStatusMark(Mark mark, const TextSpot& text, const TextSpot& message,
                         const Eigen::Vector2f& corner, Ink& ink);

}  // namespace depthscope::overlay
