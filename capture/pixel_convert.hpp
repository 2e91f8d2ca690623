#pragma once
#include <cstdint>
#include <span>

#include "capture/frame.hpp"
#include "capture/pixel_rows.hpp"
#include "types/color.hpp"

namespace depthscope::capture {

/// Converts a whole frame to R G B A (A = 255) with one fixed-point formula per matrix and range;
/// the single definition of what a captured picture looks like, so that display, proof and file
/// agree bit for bit. `out`: height * width * 4 bytes, rows packed; an empty frame or a smaller
/// `out` is the caller's error and leaves `out` as it is. Chroma is taken from the nearest sample.
/// Does not allocate.
///
/// With K_r, K_b of the matrix, y = Y - 16 and scales 255/219, 255/224 (limited) or y = Y and 1, 1
/// (full): R = y' + 2 (1 - K_r) v', B = y' + 2 (1 - K_b) u', G by y' = K_r R + K_g G + K_b B, each
/// coefficient rounded to 16 fractional bits, the sum rounded half up and clamped (ITU-R
/// BT.601-7 2.5, BT.709-6 3, BT.2020-2 table 4). RGB of limited range is expanded by 255/219.
void toRgba(const Frame& frame, std::span<std::uint8_t> out);

/// The frame's luma, 8 bit, rows packed, width * height bytes. Gray and YUV: the Y plane as it is,
/// no range expanded; RGB: BT.601 weights, likewise. Does not allocate; sizes as for toRgba.
void toGray(const Frame& frame, std::span<std::uint8_t> out);

/// The small colour picture of a frame: each pixel is the mean, in toRgba()'s colours, of a run of
/// `factor` pixels, along the middle row of the square that it stands for. Only those rows are
/// converted, so it costs little beside toRgba(). `out`: ColorReduction::pixels() of the frame's
/// size; sizes as for toRgba. Does not allocate.
void toReducedRgb(const Frame& frame, std::span<Rgb> out);

/// The numbers in toRgba()'s formula, for whoever else has to make the same of a picture.
const YuvCoefficients& coefficientsOf(const FrameFormat& format);

}  // namespace depthscope::capture
