#include "capture/fault_script.hpp"

#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "types/error.hpp"

namespace depthscope::capture {

namespace {

using Kind = FaultEvent::Kind;

constexpr int kMinSide_px = 16, kMaxSide_px = 16384;
constexpr double kMaxDelay_ms = 60000;

constexpr std::array<std::pair<std::string_view, Kind>, 5> kKinds{{
    {"signal-lost", Kind::SignalLost},
    {"resize", Kind::Resize},
    {"late", Kind::Late},
    {"damaged", Kind::Damaged},
    {"repeated", Kind::Repeated},
}};

std::optional<Kind> parseKind(std::string_view word) {
  for (const auto& [name, kind] : kKinds)
    if (name == word) return kind;
  return std::nullopt;
}

/// The whole word as a number, or nothing.
template <typename Number>
std::optional<Number> parseNumber(std::string_view word) {
  Number value{};
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return value;
}

bool parseSize(std::string_view word, FaultEvent& event) {
  const std::size_t x = word.find('x');
  if (x == std::string_view::npos) return false;
  const auto width = parseNumber<int>(word.substr(0, x));
  const auto height = parseNumber<int>(word.substr(x + 1));
  const auto inRange = [](int side) { return side >= kMinSide_px && side <= kMaxSide_px; };
  if (!width || !height || !inRange(*width) || !inRange(*height)) return false;
  event.width = *width;
  event.height = *height;
  return true;
}

bool parseDelay(std::string_view word, FaultEvent& event) {
  const auto delay = parseNumber<double>(word);
  // Written so that a NaN fails.
  if (!delay || !(*delay >= 0 && *delay <= kMaxDelay_ms)) return false;
  event.delay_ms = *delay;
  return true;
}

/// Empty when the words make an event, else what was expected.
std::string parseEvent(const std::vector<std::string>& words, FaultEvent& event) {
  const auto kind = parseKind(words[0]);
  if (!kind)
    return "expected signal-lost, resize, late, damaged or repeated, not '" + words[0] + "'";
  event.kind = *kind;
  const std::size_t arguments = *kind == Kind::Resize || *kind == Kind::Late ? 4 : 3;
  if (words.size() != arguments)
    return "expected " + words[0] + " FIRST COUNT" +
           (*kind == Kind::Resize ? " WIDTHxHEIGHT"
            : *kind == Kind::Late ? " DELAY_MS"
                                  : "");
  const auto first = parseNumber<std::int64_t>(words[1]);
  if (!first || *first < 0) return "FIRST: expected a frame number from 0, not '" + words[1] + "'";
  event.first = *first;
  const auto count = parseNumber<std::int64_t>(words[2]);
  if (!count || *count < 1) return "COUNT: expected 1 or more, not '" + words[2] + "'";
  event.count = *count;
  if (*kind == Kind::Resize && !parseSize(words[3], event))
    return "expected WIDTHxHEIGHT of 16 to 16384 pixels, not '" + words[3] + "'";
  if (*kind == Kind::Late && !parseDelay(words[3], event))
    return "expected a delay of 0 to 60000 ms, not '" + words[3] + "'";
  return {};
}

}  // namespace

std::vector<FaultEvent> loadFaultScript(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path))
    throw InputError(path.string() + ": cannot be read, expected a fault script");
  std::vector<FaultEvent> script;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream in(line.substr(0, line.find('#')));
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    if (words.empty()) continue;
    FaultEvent event;
    const std::string error = parseEvent(words, event);
    if (!error.empty())
      throw InputError(path.string() + ":" + std::to_string(number) + ": " + error);
    script.push_back(event);
  }
  return script;
}

FrameFaults faultsAt(std::span<const FaultEvent> script, std::int64_t frame) {
  FrameFaults faults;
  for (const FaultEvent& event : script) {
    // Subtracted, not added: first + count may be larger than the type holds.
    if (frame < event.first || frame - event.first >= event.count) continue;
    switch (event.kind) {
      case Kind::SignalLost:
        faults.signal_lost = true;
        break;
      case Kind::Resize:
        faults.resize = &event;
        break;
      case Kind::Late:
        faults.delay_ms = event.delay_ms;
        break;
      case Kind::Damaged:
        faults.damaged = true;
        break;
      case Kind::Repeated:
        faults.repeated = true;
        break;
    }
  }
  return faults;
}

}  // namespace depthscope::capture
