#include "capture/v4l2_stream.hpp"

#include <fcntl.h>

#include <algorithm>
#include <bit>

namespace depthscope::capture {
namespace {

using std::chrono::seconds;

constexpr int kMostBuffers = 32;
/// A driver's clock that is off by more cannot be meant seriously.
constexpr auto kCredibleAge = seconds(10);

v4l2_buffer blankBuffer(const V4l2Node& node, int slot, v4l2_plane* planes) {
  v4l2_buffer buffer{};
  buffer.type = node.bufferType();
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = static_cast<__u32>(slot);
  if (node.multiplanar()) {
    buffer.m.planes = planes;
    buffer.length = VIDEO_MAX_PLANES;
  }
  return buffer;
}

}  // namespace

V4l2Stream::V4l2Stream(kernel::SystemCalls& calls, const V4l2Node& node, const V4l2Layout& layout)
    : calls_(calls), node_(node), layout_(layout), last_sign_(calls.now()) {}

std::shared_ptr<V4l2Stream> V4l2Stream::start(kernel::SystemCalls& calls, const V4l2Node& node,
                                              const V4l2Layout& layout, int buffers, int& error,
                                              const char*& step) {
  std::shared_ptr<V4l2Stream> stream(new V4l2Stream(calls, node, layout));
  error = stream->request(buffers, step);
  for (int slot = 0; error == 0 && slot < stream->count_; ++slot) error = stream->map(slot, step);
  if (error != 0) return nullptr;
  if (!layout.jpeg && layout.field == V4L2_FIELD_NONE) stream->exportDma();
  step = "QBUF";
  for (int slot = 0; error == 0 && slot < stream->count_; ++slot) error = stream->queue(slot);
  if (error != 0) return nullptr;
  step = "STREAMON";
  int type = node.bufferType();
  error = node.ask(VIDIOC_STREAMON, type);
  stream->last_sign_ = calls.now();
  return error < 0 ? nullptr : stream;
}

int V4l2Stream::request(int buffers, const char*& step) {
  step = "REQBUFS";
  v4l2_requestbuffers request{};
  request.count = static_cast<__u32>(buffers);
  request.type = node_.bufferType();
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = node_.ask(VIDIOC_REQBUFS, request); error < 0) return error;
  if (request.count <= kKept || request.count > kMostBuffers) return -ENOMEM;
  count_ = static_cast<int>(request.count);
  memory_.reserve(static_cast<std::size_t>(count_ * layout_.memory_planes));
  return 0;
}

int V4l2Stream::map(int slot, const char*& step) {
  step = "QUERYBUF";
  v4l2_plane planes[VIDEO_MAX_PLANES]{};
  v4l2_buffer buffer = blankBuffer(node_, slot, planes);
  if (const int error = node_.ask(VIDIOC_QUERYBUF, buffer); error < 0) return error;
  step = "mmap";
  for (int piece = 0; piece < layout_.memory_planes; ++piece) {
    const bool multi = node_.multiplanar();
    const std::size_t length = multi ? planes[piece].length : buffer.length;
    const __u32 offset = multi ? planes[piece].m.mem_offset : buffer.m.offset;
    if (!layout_.jpeg && length < layout_.needed[piece]) return -EMSGSIZE;
    int error = 0;
    memory_.emplace_back(calls_, node_.fd(), length, true, static_cast<off_t>(offset), error);
    if (error != 0) return error;
  }
  return 0;
}

/// A card that cannot export does without: the picture is then copied by whoever wants it.
void V4l2Stream::exportDma() {
  for (int slot = 0; slot < count_; ++slot)
    for (int piece = 0; piece < layout_.memory_planes; ++piece) {
      v4l2_exportbuffer request{};
      request.type = node_.bufferType();
      request.index = static_cast<__u32>(slot);
      request.plane = static_cast<__u32>(piece);
      request.flags = O_CLOEXEC | O_RDONLY;
      if (node_.ask(VIDIOC_EXPBUF, request) < 0) return dma_.clear();
      dma_.emplace_back(calls_, request.fd);
    }
}

int V4l2Stream::queue(int slot) {
  v4l2_plane planes[VIDEO_MAX_PLANES]{};
  v4l2_buffer buffer = blankBuffer(node_, slot, planes);
  if (node_.multiplanar()) buffer.length = static_cast<__u32>(layout_.memory_planes);
  const int error = node_.ask(VIDIOC_QBUF, buffer);
  if (error == 0) ++queued_;
  return error;
}

void V4l2Stream::takeBack(int slot) {
  returned_.fetch_or(std::uint64_t{1} << slot, std::memory_order_release);
}

/// Acquire pairs with the release in takeBack(): the last owner's accesses are over.
int V4l2Stream::queueReturned() {
  std::uint64_t slots = returned_.exchange(0, std::memory_order_acquire);
  for (; slots != 0; slots &= slots - 1)
    if (const int error = queue(std::countr_zero(slots)); error < 0) return error;
  return 0;
}

int V4l2Stream::dequeue(Filled& filled) {
  v4l2_plane planes[VIDEO_MAX_PLANES]{};
  v4l2_buffer buffer = blankBuffer(node_, 0, planes);
  const int error = node_.ask(VIDIOC_DQBUF, buffer);
  if (error < 0) return error;
  if (buffer.index >= static_cast<__u32>(count_)) return -EPROTO;
  --queued_;
  last_sign_ = calls_.now();
  filled.slot = static_cast<int>(buffer.index);
  filled.field = buffer.field;
  setTime(buffer, filled);
  judge(buffer, planes, filled);
  return 0;
}

/// Whether the picture is whole, and what its number says about those before it.
void V4l2Stream::judge(const v4l2_buffer& buffer, const v4l2_plane* planes, Filled& filled) {
  filled.sound = !(buffer.flags & V4L2_BUF_FLAG_ERROR);
  filled.bytes = buffer.bytesused;
  for (int piece = 0; piece < layout_.memory_planes; ++piece) {
    std::size_t used = buffer.bytesused, offset = 0;
    if (node_.multiplanar()) {
      offset = planes[piece].data_offset;
      used = planes[piece].bytesused - std::min<std::size_t>(offset, planes[piece].bytesused);
      if (piece == 0) filled.bytes = used;
    }
    const std::size_t room =
        memory_[static_cast<std::size_t>(filled.slot * layout_.memory_planes + piece)]
            .bytes()
            .size();
    filled.data_offset[static_cast<std::size_t>(piece)] = offset;
    if (offset + used > room || used < layout_.needed[static_cast<std::size_t>(piece)] || used == 0)
      filled.sound = false;
  }
  // Fields of one frame share a number where fields come one by one.
  const bool same_frame =
      layout_.field == V4L2_FIELD_ALTERNATE && buffer.sequence == last_sequence_;
  const __u32 step = buffer.sequence - last_sequence_;
  const bool plausible = has_sequence_ && step > 0 && step < 1u << 31;
  if (plausible) counts_.skipped += step - 1;
  if (has_sequence_ && !same_frame) sequence_ += plausible ? step : 1;
  has_sequence_ = true;
  last_sequence_ = buffer.sequence;
  filled.sequence = sequence_;
}

/// The driver's time where it is by our clock and can be true, else that of this moment.
void V4l2Stream::setTime(const v4l2_buffer& buffer, Filled& filled) const {
  const Time told{seconds(buffer.timestamp.tv_sec) +
                  std::chrono::microseconds(buffer.timestamp.tv_usec)};
  const __u32 clock = buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK;
  filled.timed = clock == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC && told <= last_sign_ &&
                 last_sign_ - told < kCredibleAge;
  filled.captured = filled.timed ? told : last_sign_;
}

void V4l2Stream::stop() {
  int type = node_.bufferType();
  node_.ask(VIDIOC_STREAMOFF, type);
  v4l2_requestbuffers none{};
  none.type = node_.bufferType();
  none.memory = V4L2_MEMORY_MMAP;
  node_.ask(VIDIOC_REQBUFS, none);
}

V4l2Stream::Taken V4l2Stream::take(std::chrono::nanoseconds max_age) {
  Taken taken;
  Filled newest;
  const auto drop = [&](const Filled& filled) {
    if (filled.slot < 0) return 0;
    ++(filled.sound ? counts_.skipped : counts_.damaged);
    return queue(filled.slot);
  };
  const Time sign_before = last_sign_;
  // Not more than there are: a card that outruns us must not hold us.
  for (int i = 0; taken.error == 0 && i < count_; ++i) {
    Filled filled;
    const int error = dequeue(filled);
    if (error == -EAGAIN || error == -EINTR) break;
    taken.error = error;
    if (error < 0) break;
    if (filled.sound) std::swap(filled, newest);
    taken.error = drop(filled);
  }
  if (taken.error != 0 || newest.slot < 0) return taken;
  // Without times: what was not asked for meanwhile may have waited since then.
  const auto age = (newest.timed ? calls_.now() - newest.captured : last_sign_ - sign_before);
  const bool stale = age > max_age;
  if (stale || queued_ < kKept) {
    taken.error = drop(newest);
    return taken;
  }
  taken.frame = wrap(newest);
  taken.bytes = newest.bytes;
  taken.field = newest.field;
  return taken;
}

Frame V4l2Stream::wrap(const Filled& filled) {
  Frame frame = lend(filled.slot);
  frame.format = layout_.format;
  frame.sequence = filled.sequence;
  frame.capture_time = filled.captured;
  frame.media_time_s = std::chrono::duration<double>(filled.captured.time_since_epoch()).count();
  const auto first = static_cast<std::size_t>(filled.slot * layout_.memory_planes);
  const int planes = layout_.jpeg ? 1 : planeCount(layout_.format.pixel_format);
  for (int i = 0; i < planes; ++i) {
    const auto& place = layout_.planes[i];
    const auto piece = static_cast<std::size_t>(place.memory);
    const std::size_t offset = place.offset + filled.data_offset[piece];
    auto* memory = reinterpret_cast<std::uint8_t*>(memory_[first + piece].bytes().data());
    frame.planes[static_cast<std::size_t>(i)] = {memory + offset, place.stride};
    if (!dma_.empty())
      frame.dma[static_cast<std::size_t>(i)] = {dma_[first + piece].get(),
                                                static_cast<std::uint32_t>(offset)};
  }
  return frame;
}

}  // namespace depthscope::capture
