#include "capture/image_header.hpp"

#include <algorithm>
#include <array>
#include <fstream>

namespace depthscope::capture {

namespace {

constexpr std::array<unsigned char, 8> kPngSignature{0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};

template <std::size_t N>
bool readBytes(std::istream& in, std::array<unsigned char, N>& bytes) {
  in.read(reinterpret_cast<char*>(bytes.data()), N);
  return in.gcount() == static_cast<std::streamsize>(N);
}

int bigEndian16(const unsigned char* p) {
  return p[0] << 8 | p[1];
}

/// PNG specification 11.2.2: the IHDR chunk comes first.
std::optional<ImageHeader> readPng(std::istream& in) {
  std::array<unsigned char, 24> b{};
  if (!readBytes(in, b) || !std::equal(kPngSignature.begin(), kPngSignature.end(), b.begin()))
    return std::nullopt;
  if (b[12] != 'I' || b[13] != 'H' || b[14] != 'D' || b[15] != 'R') return std::nullopt;
  const auto side = [&](int at) {
    return bigEndian16(&b[at]) << 15 << 1 | bigEndian16(&b[at + 2]);
  };
  if (b[16] > 0x7f || b[20] > 0x7f) return std::nullopt;
  return ImageHeader{ImageKind::Png, side(16), side(20)};
}

/// SOF0 to SOF15 without DHT (C4), JPG (C8) and DAC (CC).
bool isStartOfFrame(unsigned char marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// ITU-T T.81 annex B: segments are skipped until one starts a frame.
std::optional<ImageHeader> readJpeg(std::istream& in) {
  std::array<unsigned char, 2> soi{};
  if (!readBytes(in, soi) || soi[0] != 0xff || soi[1] != 0xd8) return std::nullopt;
  for (;;) {
    std::array<unsigned char, 4> segment{};
    if (!readBytes(in, segment) || segment[0] != 0xff) return std::nullopt;
    while (segment[1] == 0xff) {  // fill bytes may stand before a marker
      segment = {0xff, segment[2], segment[3], 0};
      const int byte = in.get();
      if (byte < 0) return std::nullopt;
      segment[3] = static_cast<unsigned char>(byte);
    }
    if (isStartOfFrame(segment[1])) {
      std::array<unsigned char, 5> frame{};  // precision, height, width
      if (!readBytes(in, frame)) return std::nullopt;
      return ImageHeader{ImageKind::Jpeg, bigEndian16(&frame[3]), bigEndian16(&frame[1])};
    }
    const int length = bigEndian16(&segment[2]);
    if (length < 2 || !in.seekg(length - 2, std::ios::cur)) return std::nullopt;
  }
}

}  // namespace

std::optional<ImageHeader> readImageHeader(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const int first = in.peek();
  std::optional<ImageHeader> header = first == kPngSignature[0] ? readPng(in) : readJpeg(in);
  if (header && (header->width < 1 || header->height < 1)) return std::nullopt;
  return header;
}

}  // namespace depthscope::capture
