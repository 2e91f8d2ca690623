#include "platform/display/mode_request.hpp"

#include <charconv>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

/// Reads a number at the start of `text` and cuts it off.
template <class T>
bool takeNumber(std::string_view& text, T min, T max, T& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc() || !(out >= min && out <= max)) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool takeChar(std::string_view& text, char c) {
  if (!text.starts_with(c)) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

ModeRequest parseModeRequest(const std::string& text) {
  ModeRequest request;
  if (text == "auto") return request;
  std::string_view rest = text;
  const bool ok = takeNumber(rest, 1, 16384, request.width) && takeChar(rest, 'x') &&
                  takeNumber(rest, 1, 16384, request.height) &&
                  (rest.empty() ||
                   (takeChar(rest, '@') && takeNumber(rest, 1.0, 1000.0, request.refresh_hz))) &&
                  rest.empty();
  if (!ok)
    throw InputError("display.mode = \"" + text +
                     "\": expected \"auto\", \"WIDTHxHEIGHT\" or \"WIDTHxHEIGHT@HZ\", e.g. "
                     "\"1920x1080@60\"");
  return request;
}

}  // namespace depthscope::platform
