#pragma once
#include <charconv>
#include <optional>
#include <string_view>

namespace depthscope::platform {

/// A line given by its number on the chip; none when it is a name.
inline std::optional<unsigned> lineOffset(std::string_view line) {
  unsigned offset = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), offset);
  if (error != std::errc() || end != line.data() + line.size()) return std::nullopt;
  return offset;
}

}  // namespace depthscope::platform
