#include "capture/edid.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <numeric>

#include "types/error.hpp"

namespace depthscope::capture {
namespace {

using Block = std::array<std::uint8_t, kEdidBlock>;

constexpr std::array<std::uint8_t, 8> kHeader{0x00, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x00};
constexpr std::size_t kMostBlocks = 256;

/// A progressive mode with positive syncs; pixels and lines.
struct Mode {
  unsigned clock_10khz;
  unsigned width, h_front, h_sync, h_back;
  unsigned height, v_front, v_sync, v_back;
};
// CTA-861 table 1.
constexpr Mode k1080p60{14850, 1920, 88, 44, 148, 1080, 4, 5, 36};
constexpr Mode k720p60{7425, 1280, 110, 40, 220, 720, 5, 5, 20};

std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xff);
}
/// Two numbers' bits 8 to 11, as the two halves of a byte.
std::uint8_t high(unsigned left, unsigned right) {
  return static_cast<std::uint8_t>((left >> 8 & 0xf) << 4 | (right >> 8 & 0xf));
}

/// A detailed timing descriptor (E-EDID 3.10.2), without a physical size.
void putTiming(const Mode& m, std::uint8_t* at) {
  const unsigned h_blank = m.h_front + m.h_sync + m.h_back;
  const unsigned v_blank = m.v_front + m.v_sync + m.v_back;
  constexpr std::uint8_t kSeparateDigitalSyncs = 0x18, kPositive = 0x06;
  const std::array<std::uint8_t, 18> descriptor{
      low(m.clock_10khz),
      low(m.clock_10khz >> 8),
      low(m.width),
      low(h_blank),
      high(m.width, h_blank),
      low(m.height),
      low(v_blank),
      high(m.height, v_blank),
      low(m.h_front),
      low(m.h_sync),
      static_cast<std::uint8_t>((m.v_front & 0xf) << 4 | (m.v_sync & 0xf)),
      static_cast<std::uint8_t>((m.h_front >> 8 & 3) << 6 | (m.h_sync >> 8 & 3) << 4 |
                                (m.v_front >> 4 & 3) << 2 | (m.v_sync >> 4 & 3)),
      0,
      0,
      0,
      0,
      0,
      kSeparateDigitalSyncs | kPositive};
  std::copy(descriptor.begin(), descriptor.end(), at);
}

void putDescriptor(std::uint8_t tag, std::initializer_list<std::uint8_t> content,
                   std::uint8_t* at) {
  const std::array<std::uint8_t, 5> start{0, 0, 0, tag, 0};
  std::copy(start.begin(), start.end(), at);
  std::copy(content.begin(), content.end(), at + start.size());
}

void closeBlock(Block& block) {
  const auto sum = std::accumulate(block.begin(), block.end() - 1, 0u);
  block.back() = static_cast<std::uint8_t>(-sum);
}

Block baseBlock() {
  Block b{};
  std::copy(kHeader.begin(), kHeader.end(), b.begin());
  constexpr unsigned kMaker = ('D' - '@') << 10 | ('S' - '@') << 5 | ('C' - '@');
  b[8] = kMaker >> 8;
  b[9] = kMaker & 0xff;
  b[10] = 1;  // product
  b[17] = 2026 - 1990;
  b[18] = 1;
  b[19] = 3;
  b[20] = 0x80;  // digital
  b[23] = 120;   // gamma 2.2
  b[24] = 0x0a;  // RGB; the first timing is the preferred one
  constexpr std::array<std::uint8_t, 10> kSrgb{0xee, 0x91, 0xa3, 0x54, 0x4c,
                                               0x99, 0x26, 0x0f, 0x50, 0x54};
  std::copy(kSrgb.begin(), kSrgb.end(), b.begin() + 25);
  b[35] = 0x20;                                     // 640x480 at 60, which everything can
  std::fill(b.begin() + 38, b.begin() + 54, 0x01);  // no standard timings
  putTiming(k1080p60, &b[54]);
  putTiming(k720p60, &b[72]);
  putDescriptor(0xfc, {'D', 'e', 'p', 't', 'h', 's', 'c', 'o', 'p', 'e', '\n', ' ', ' '}, &b[90]);
  // Range: 23 to 61 Hz, 26 to 69 kHz, 150 MHz.
  putDescriptor(0xfd, {23, 61, 26, 69, 15, 0, '\n', ' ', ' ', ' ', ' ', ' ', ' '}, &b[108]);
  b[126] = 1;  // one more block
  closeBlock(b);
  return b;
}

Block ctaBlock() {
  // Video identification codes of CTA-861: 1080p at 60, 50, 30, 25, 24; 720p at 60, 50; 576p, 480p.
  constexpr std::array<std::uint8_t, 10> kModes{16, 31, 34, 33, 32, 4, 19, 18, 3, 1};
  // HDMI's vendor block with a physical address, by which a source knows that this is HDMI.
  constexpr std::array<std::uint8_t, 6> kHdmi{3 << 5 | 5, 0x03, 0x0c, 0x00, 0x10, 0x00};
  Block b{};
  b[0] = 0x02;
  b[1] = 0x03;
  b[2] = static_cast<std::uint8_t>(4 + 1 + kModes.size() + kHdmi.size());  // end of the blocks
  b[4] = static_cast<std::uint8_t>(2 << 5 | kModes.size());
  std::copy(kModes.begin(), kModes.end(), b.begin() + 5);
  std::copy(kHdmi.begin(), kHdmi.end(), b.begin() + 5 + kModes.size());
  closeBlock(b);
  return b;
}

}  // namespace

std::vector<std::uint8_t> builtinEdid() {
  std::vector<std::uint8_t> edid;
  for (const Block& block : {baseBlock(), ctaBlock()})
    edid.insert(edid.end(), block.begin(), block.end());
  return edid;
}

std::string edidFault(std::span<const std::uint8_t> edid) {
  if (edid.empty() || edid.size() % kEdidBlock != 0 || edid.size() > kMostBlocks * kEdidBlock)
    return std::to_string(edid.size()) + " bytes, expected a multiple of 128";
  if (!std::equal(kHeader.begin(), kHeader.end(), edid.begin()))
    return "does not begin as an EDID does";
  if (edid.size() / kEdidBlock != edid[126] + 1u)
    return "announces " + std::to_string(edid[126] + 1) + " blocks, but has " +
           std::to_string(edid.size() / kEdidBlock);
  for (std::size_t block = 0; block < edid.size() / kEdidBlock; ++block) {
    const auto bytes = edid.subspan(block * kEdidBlock, kEdidBlock);
    if (std::accumulate(bytes.begin(), bytes.end(), 0u) % 256 != 0)
      return "checksum of block " + std::to_string(block) + " is wrong";
  }
  return {};
}

std::vector<std::uint8_t> loadEdid(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<std::uint8_t> edid{std::istreambuf_iterator<char>(in), {}};
  if (!in.is_open()) throw InputError(file + ": cannot be read, expected a binary EDID");
  if (const std::string fault = edidFault(edid); !fault.empty())
    throw InputError(file + ": not an EDID: " + fault);
  return edid;
}

}  // namespace depthscope::capture
