#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "capture/v4l2_node.hpp"

namespace depthscope::capture {

/// What the card's EDID memory holds for an input; nothing where it has no such memory.
std::vector<std::uint8_t> readEdid(const V4l2Node& node, int input);

/// Writes `edid` unless it is there already: a change makes the tower look again, which takes the
/// picture away for a second or two. With `only_where_missing`, whatever is there stays. 0 (also
/// for cards without EDID memory) or -errno.
int offerEdid(const V4l2Node& node, int input, std::span<const std::uint8_t> edid,
              bool only_where_missing);

}  // namespace depthscope::capture
