#pragma once
#include <cstdint>
#include <span>

#include "capture/frame.hpp"

namespace depthscope::capture {

/// Converts a whole frame to R G B A (A = 255) with one fixed-point formula per matrix and range; the
/// single definition of what a captured picture looks like, so that display, proof and file agree bit
/// for bit. `out`: height * width * 4 bytes, rows packed. Chroma is taken from the nearest sample.
/// Does not allocate.
void toRgba(const Frame& frame, std::span<std::uint8_t> out);

/// The frame's luma, 8 bit, rows packed, width * height bytes. YUV: the Y plane expanded as it is;
/// RGB: BT.601 weights. Does not allocate.
void toGray(const Frame& frame, std::span<std::uint8_t> out);

}  // namespace depthscope::capture
