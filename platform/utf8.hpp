#pragma once
#include <string_view>

namespace depthscope::platform {

/// Whether `text` is well-formed UTF-8 without control characters. Overlong forms and surrogates
/// are not.
bool isPrintableUtf8(std::string_view text);

/// The longest start of `text` of at most `bytes` bytes that does not cut a character.
std::string_view utf8Prefix(std::string_view text, std::size_t bytes);

}  // namespace depthscope::platform
