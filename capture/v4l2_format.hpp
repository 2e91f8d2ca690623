#pragma once
#include <linux/videodev2.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/frame.hpp"
#include "capture/v4l2_node.hpp"
#include "capture/v4l2_settings.hpp"

namespace depthscope::capture {

/// Where a picture's planes lie in the memory of a V4L2 buffer.
struct V4l2Layout {
  __u32 fourcc = 0;
  FrameFormat format;             // of what is in a buffer: of one field where `field` is ALTERNATE
  bool jpeg = false;              // compressed: no planes to speak of
  __u32 field = V4L2_FIELD_NONE;  // v4l2_field, or whatever else a driver says
  int memory_planes = 1;          // separately mapped pieces of a buffer
  struct {
    int memory = 0;             // the piece it lies in
    std::size_t offset = 0;     // [bytes]
    std::ptrdiff_t stride = 0;  // [bytes]
  } planes[3];
  std::array<std::size_t, 3> needed{};  // [bytes] that a whole picture takes of each piece
};

/// "NV12" and the like, as v4l2-ctl shows it.
std::string fourccText(__u32 fourcc);
/// What the source can turn into a picture, the best first.
std::span<const __u32> preferredFormats();
/// What a card offers.
std::vector<v4l2_fmtdesc> offeredFormats(const V4l2Node& node);

/// How a driver's format is to be read; nothing when it is none of ours or its numbers do not fit
/// together. Colour as the driver says, its defaults resolved as videodev2.h defines them.
std::optional<V4l2Layout> layoutOf(const v4l2_format& format);

/// The request for the format that setBestFormat() would set.
int chooseFormat(const V4l2Node& node, const V4l2Settings& wanted, int width, int height,
                 v4l2_format& format, std::string& detail);

/// The format for a signal of `width` x `height` (0: the card's own), set in the driver: the
/// wanted one, else the best that comes uncompressed at a moving picture's rate, else MJPG. 0 or
/// -errno with the reason in `detail`; -EINVAL when there is none.
int setBestFormat(const V4l2Node& node, const V4l2Settings& wanted, int width, int height,
                  V4l2Layout& layout, std::string& detail);

/// Asks for the wanted rate, or with 0 for the highest, where the driver offers a choice; the rate
/// it tells then [1/s], 0 when it tells none.
double setFrameRate(const V4l2Node& node, const V4l2Layout& layout, double wanted);

}  // namespace depthscope::capture
