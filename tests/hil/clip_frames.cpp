// clip_frames CLIP COUNT STEP FILE: COUNT pictures of a clip, every STEP-th from the first on, as
// the tower of the hardware tests sends them: YUYV, BT.601, limited range, rows packed. Each
// carries its number in the bottom left corner: 16 blocks of 8x8 pixels, the lowest bit first, the
// highest always set, white for 1 and black for 0.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "capture/file_source.hpp"

namespace {

using depthscope::capture::Frame;

constexpr int block_px = 8, bits = 16, mark = 1 << (bits - 1);
constexpr std::uint8_t black = 16, white = 235, neutral = 128;

std::vector<std::uint8_t> toYuyv(const Frame& frame) {
  const int width = frame.format.width, height = frame.format.height;
  std::vector<std::uint8_t> out;
  out.reserve(static_cast<std::size_t>(width * height * 2));
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* luma = frame.planes[0].data + y * frame.planes[0].stride;
    const std::uint8_t* u = frame.planes[1].data + y / 2 * frame.planes[1].stride;
    const std::uint8_t* v = frame.planes[2].data + y / 2 * frame.planes[2].stride;
    for (int x = 0; x < width; x += 2)
      out.insert(out.end(), {luma[x], u[x / 2], luma[x + 1], v[x / 2]});
  }
  return out;
}

void stampNumber(std::vector<std::uint8_t>& yuyv, int width, int height, int number) {
  for (int y = height - block_px; y < height; ++y)
    for (int x = 0; x < bits * block_px; ++x) {
      const std::size_t at = static_cast<std::size_t>(y * width + x) * 2;
      yuyv[at] = ((number | mark) >> (x / block_px)) & 1 ? white : black;
      yuyv[at + 1] = neutral;
    }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace depthscope::capture;
  if (argc != 5) return std::fputs("usage: clip_frames CLIP COUNT STEP FILE\n", stderr), 2;
  FileSourceSettings settings;
  settings.path = argv[1];
  const auto source = openFileSource(settings);
  std::ofstream out(argv[4], std::ios::binary);
  const int count = std::atoi(argv[2]), step = std::max(1, std::atoi(argv[3]));
  for (int i = 0; i < count * step; ++i) {
    const ReadResult read = source->read(std::chrono::seconds(10));
    if (read.status != SourceStatus::Ok || read.frame.format.pixel_format != PixelFormat::Yuv420p)
      return std::fputs("clip_frames: expected a longer clip in YUV 4:2:0\n", stderr), 1;
    if (i % step != 0) continue;
    auto yuyv = toYuyv(read.frame);
    stampNumber(yuyv, read.frame.format.width, read.frame.format.height, i / step);
    out.write(reinterpret_cast<const char*>(yuyv.data()),
              static_cast<std::streamsize>(yuyv.size()));
  }
  return out.flush() ? 0 : 1;
}
