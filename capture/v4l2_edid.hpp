#pragma once
#include <cstdint>
#include <span>

#include "capture/v4l2_node.hpp"

namespace depthscope::capture {

/// Whether the card has an EDID memory for an input, with or without content.
bool hasEdid(const V4l2Node& node, int input);

/// Writes `edid` unless it is there already: a change makes the tower look again, which takes the
/// picture away for a second or two. With `only_where_missing`, whatever is there stays. 0 (also
/// for cards without EDID memory) or -errno.
int offerEdid(const V4l2Node& node, int input, std::span<const std::uint8_t> edid,
              bool only_where_missing);

}  // namespace depthscope::capture
