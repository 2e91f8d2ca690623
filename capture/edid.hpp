#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace depthscope::capture {

inline constexpr std::size_t kEdidBlock = 128;  // [bytes]

/// What the box says about itself to the tower when the card has nothing to say (VESA E-EDID 1.3
/// with one CTA-861 extension): 1920x1080 at 60 preferred, 1280x720 at 60, and the usual television
/// modes at 24 to 60 frames a second; RGB, no sound.
std::vector<std::uint8_t> builtinEdid();

/// Empty when `edid` is sound: a whole number of blocks, the number the first one announces, the
/// fixed header, every block's sum right. Else what is wrong.
std::string edidFault(std::span<const std::uint8_t> edid);

/// A binary EDID file. Throws InputError naming the file: unreadable, or not an EDID.
std::vector<std::uint8_t> loadEdid(const std::string& file);

}  // namespace depthscope::capture
