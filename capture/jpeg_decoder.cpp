#include "capture/jpeg_decoder.hpp"

#include <jerror.h>
#include <jpeglib.h>

#include <array>
#include <csetjmp>
#include <cstddef>
#include <new>
#include <vector>

namespace depthscope::capture {
namespace {

constexpr std::size_t kArenaBytes = std::size_t{256} << 10;  // a decoder takes some 50 KiB
constexpr std::size_t kAlignment = 64;
constexpr int kMaxRows = 16;  // of a component that are decoded at a time, chroma halved both ways

using Arena = std::vector<std::byte>;

}  // namespace

/// libjpeg reports errors by a jump back to where a call into it was made, so the functions that
/// make such calls own nothing.
struct JpegDecoder::State {
  jpeg_decompress_struct decoder{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  bool damaged = false;    // data were missing or made no sense
  jpeg_memory_mgr heap{};  // libjpeg's own methods
  Arena arena = Arena(kArenaBytes + kAlignment);
  std::size_t used = 0;
  std::vector<std::uint8_t> surplus_row = std::vector<std::uint8_t>(FramePool::kMaxSide_px + 64);

  static State& of(j_common_ptr common) { return *static_cast<State*>(common->client_data); }
  void create();
  bool begin(std::span<const std::uint8_t> jpeg, FrameFormat& format);
  bool finish(Frame& frame);
  bool formatOf(FrameFormat& format) const;

  static void fail(j_common_ptr common) { std::longjmp(of(common).back, 1); }
  static void warn(j_common_ptr common, int level) {
    // Some cameras put stray bytes between the picture's data and its end marker.
    if (level < 0 && common->err->msg_code != JWRN_EXTRANEOUS_DATA) of(common).damaged = true;
  }
  static void say(j_common_ptr) {}
  static void* allocate(j_common_ptr common, int pool, std::size_t bytes) {
    State& state = of(common);
    const std::size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
    if (pool != JPOOL_IMAGE || rounded > kArenaBytes - state.used)
      return state.heap.alloc_large(common, pool, bytes);
    void* place = state.arena.data();
    std::size_t room = state.arena.size();
    auto* start = static_cast<std::byte*>(std::align(kAlignment, kArenaBytes, place, room));
    start += state.used;
    state.used += rounded;
    return start;
  }
  static void release(j_common_ptr common, int pool) {
    State& state = of(common);
    if (pool == JPOOL_IMAGE) state.used = 0;
    state.heap.free_pool(common, pool);
  }
};

void JpegDecoder::State::create() {
  decoder.err = jpeg_std_error(&errors);
  errors.error_exit = fail;
  errors.emit_message = warn;
  errors.output_message = say;
  decoder.client_data = this;
  if (setjmp(back) != 0) throw std::bad_alloc();  // all that can fail here
  jpeg_create_decompress(&decoder);
  heap = *decoder.mem;
  decoder.mem->alloc_small = allocate;
  decoder.mem->alloc_large = allocate;
  decoder.mem->free_pool = release;
}

bool JpegDecoder::State::formatOf(FrameFormat& format) const {
  format = {};
  format.range = YuvRange::Full;
  format.width = static_cast<int>(decoder.image_width);
  format.height = static_cast<int>(decoder.image_height);
  if (format.width > FramePool::kMaxSide_px || format.height > FramePool::kMaxSide_px) return false;
  if (decoder.num_components == 1) {
    format.pixel_format = PixelFormat::Gray8;
    return true;
  }
  const jpeg_component_info* c = decoder.comp_info;
  if (decoder.num_components != 3 || decoder.jpeg_color_space != JCS_YCbCr) return false;
  for (int i = 1; i < 3; ++i)
    if (c[i].h_samp_factor != 1 || c[i].v_samp_factor != 1) return false;
  const int across = c[0].h_samp_factor, down = c[0].v_samp_factor;
  if (across == 2 && down == 2)
    format.pixel_format = PixelFormat::Yuv420p;
  else if (across == 2 && down == 1)
    format.pixel_format = PixelFormat::Yuv422p;
  else if (across == 1 && down == 1)
    format.pixel_format = PixelFormat::Yuv444p;
  else
    return false;
  return true;
}

bool JpegDecoder::State::begin(std::span<const std::uint8_t> jpeg, FrameFormat& format) {
  damaged = false;
  if (setjmp(back) != 0) {
    jpeg_abort_decompress(&decoder);
    return false;
  }
  jpeg_abort_decompress(&decoder);  // what is left of a picture that was not decoded
  jpeg_mem_src(&decoder, jpeg.data(), jpeg.size());
  if (jpeg_read_header(&decoder, TRUE) != JPEG_HEADER_OK || damaged) return false;
  // Those of several scans need memory for a whole picture; no camera sends them.
  if (jpeg_has_multiple_scans(&decoder)) return false;
  return formatOf(format);
}

bool JpegDecoder::State::finish(Frame& frame) {
  if (setjmp(back) != 0) {
    jpeg_abort_decompress(&decoder);
    return false;
  }
  decoder.raw_data_out = TRUE;
  decoder.do_fancy_upsampling = FALSE;
  decoder.dct_method = JDCT_ISLOW;
  decoder.out_color_space = decoder.jpeg_color_space;
  jpeg_start_decompress(&decoder);
  std::array<std::array<JSAMPROW, kMaxRows>, 3> rows;
  std::array<JSAMPARRAY, 3> planes{rows[0].data(), rows[1].data(), rows[2].data()};
  const int lines = decoder.max_v_samp_factor * DCTSIZE;
  for (int group = 0; decoder.output_scanline < decoder.output_height; ++group) {
    for (int i = 0; i < decoder.num_components; ++i) {
      const PlaneSize size = planeSize(frame.format, i);
      const Plane& plane = frame.planes[static_cast<std::size_t>(i)];
      const int count = decoder.comp_info[i].v_samp_factor * DCTSIZE;
      for (int line = 0; line < count; ++line) {
        const int row = group * count + line;
        rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(line)] =
            row < size.rows ? plane.data + row * plane.stride : surplus_row.data();
      }
    }
    if (jpeg_read_raw_data(&decoder, planes.data(), static_cast<JDIMENSION>(lines)) == 0) break;
  }
  const bool whole = decoder.output_scanline >= decoder.output_height;
  if (whole) jpeg_finish_decompress(&decoder);
  jpeg_abort_decompress(&decoder);
  return whole && !damaged;
}

JpegDecoder::JpegDecoder() : state_(std::make_unique<State>()) {
  state_->create();
}

JpegDecoder::~JpegDecoder() {
  jpeg_destroy_decompress(&state_->decoder);
}

bool JpegDecoder::readHeader(std::span<const std::uint8_t> jpeg, FrameFormat& format) {
  return !jpeg.empty() && state_->begin(jpeg, format);
}

bool JpegDecoder::decode(Frame& frame) {
  FrameFormat format;
  return !frame.empty() && state_->formatOf(format) && format == frame.format &&
         state_->finish(frame);
}

}  // namespace depthscope::capture
