// The buffers of the card: asked for, mapped, exported, queued and dequeued, and their stream.
#include <algorithm>

#include "tests/fake_kernel/fake_v4l2_session.hpp"

namespace depthscope::fake {
namespace {

constexpr off_t kPage = 4096;
constexpr off_t kOffsetStep = 16 * kPage;  // between the places to map buffers and pieces from

off_t mapOffset(__u32 slot, std::size_t piece) {
  return static_cast<off_t>(slot * 4 + piece) * kOffsetStep;
}

/// Memory of a buffer, as another device would get it.
struct DmaFile final : FakeFile {
  explicit DmaFile(std::shared_ptr<std::byte[]> bytes) : memory(std::move(bytes)) {}
  std::shared_ptr<std::byte[]> map(std::size_t, off_t, int&) override { return memory; }
  std::shared_ptr<std::byte[]> memory;
};

}  // namespace

int FakeV4l2Card::requestBuffers(Session& session, v4l2_requestbuffers& r) {
  if (r.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  if (owner_ != nullptr && owner_ != &session) return -EBUSY;
  if (streaming_ && r.count > 0) return -EBUSY;
  const bool mapped = std::any_of(buffers_.begin(), buffers_.end(), [](const Buffer& b) {
    return std::any_of(b.pieces.begin(), b.pieces.end(),
                       [](const auto& p) { return p.use_count() > 1; });
  });
  if (mapped && !options_.orphans) return -EBUSY;
  stream(session, false);
  buffers_.clear();
  owner_ = nullptr;
  if (r.count == 0) return 0;
  r.count = std::min(r.count, options_.most_buffers);
  for (__u32 i = 0; i < r.count; ++i) {
    Buffer& buffer = buffers_.emplace_back();
    for (std::size_t piece = 0; piece < layout_.pieces; ++piece)
      buffer.pieces.push_back(
          std::make_shared<std::byte[]>(layout_.size[piece] + options_.data_offset));
  }
  owner_ = &session;
  return 0;
}

int FakeV4l2Card::queryBuffer(v4l2_buffer& b) const {
  if (b.index >= buffers_.size()) return -EINVAL;
  const auto length = [&](std::size_t piece) {
    return static_cast<__u32>(layout_.size[piece] + options_.data_offset);
  };
  if (!options_.multiplanar) {
    b.length = length(0);
    b.m.offset = static_cast<__u32>(mapOffset(b.index, 0));
    return 0;
  }
  if (b.length < layout_.pieces) return -EINVAL;
  b.length = static_cast<__u32>(layout_.pieces);
  for (std::size_t piece = 0; piece < layout_.pieces; ++piece) {
    b.m.planes[piece].length = length(piece);
    b.m.planes[piece].m.mem_offset = static_cast<__u32>(mapOffset(b.index, piece));
  }
  return 0;
}

std::shared_ptr<std::byte[]> FakeV4l2Card::map(std::shared_ptr<Session> session, std::size_t length,
                                               off_t offset, int& error) {
  const auto number = static_cast<std::size_t>(offset / kOffsetStep);
  const std::size_t slot = number / 4, piece = number % 4;
  if (session->gone || offset % kOffsetStep != 0 || slot >= buffers_.size() ||
      piece >= layout_.pieces || length > layout_.size[piece] + options_.data_offset) {
    error = session->gone ? -ENODEV : -EINVAL;
    return nullptr;
  }
  // The mapping keeps the memory and, as in the kernel, the file.
  struct Held {
    std::shared_ptr<std::byte[]> memory;
    std::shared_ptr<Session> session;
  };
  auto memory = buffers_[slot].pieces[piece];
  auto held = std::make_shared<Held>(Held{memory, std::move(session)});
  return {held, memory.get()};
}

int FakeV4l2Card::exportBuffer(v4l2_exportbuffer& e) {
  if (!options_.exports) return -ENOTTY;
  if (e.index >= buffers_.size() || e.plane >= layout_.pieces) return -EINVAL;
  e.fd = kernel_.install(std::make_unique<DmaFile>(buffers_[e.index].pieces[e.plane]));
  return 0;
}

int FakeV4l2Card::queueBuffer(Session& session, const v4l2_buffer& b) {
  if (owner_ != &session) return buffers_.empty() ? -EINVAL : -EBUSY;
  if (b.index >= buffers_.size() || b.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  if (options_.multiplanar && (b.m.planes == nullptr || b.length < layout_.pieces)) return -EINVAL;
  if (buffers_[b.index].state != Buffer::State::Mine) return -EINVAL;
  buffers_[b.index].state = Buffer::State::Queued;
  incoming_.push_back(b.index);
  return 0;
}

int FakeV4l2Card::dequeueBuffer(Session& session, v4l2_buffer& b) {
  if (owner_ != &session || !streaming_) return -EINVAL;
  if (outgoing_.empty()) return -EAGAIN;
  const __u32 slot = outgoing_.front();
  Buffer& buffer = buffers_[slot];
  if (options_.multiplanar && b.length < layout_.pieces) return -EINVAL;
  outgoing_.pop_front();
  buffer.state = Buffer::State::Mine;
  v4l2_plane* planes = b.m.planes;
  const __u32 type = b.type;
  b = buffer.done;
  b.index = slot;
  b.type = type;
  b.memory = V4L2_MEMORY_MMAP;
  if (!options_.multiplanar) {
    b.bytesused = buffer.used[0];
    b.length = static_cast<__u32>(layout_.size[0]);
    return 0;
  }
  b.m.planes = planes;
  b.length = static_cast<__u32>(layout_.pieces);
  for (std::size_t piece = 0; piece < layout_.pieces; ++piece) {
    planes[piece] = {};
    planes[piece].bytesused = buffer.used[piece];
    planes[piece].length = static_cast<__u32>(layout_.size[piece] + options_.data_offset);
    planes[piece].data_offset = static_cast<__u32>(options_.data_offset);
  }
  return 0;
}

int FakeV4l2Card::stream(Session& session, bool on) {
  if (owner_ != nullptr && owner_ != &session) return -EBUSY;
  if (!on) {
    streaming_ = false;
    incoming_.clear();
    outgoing_.clear();
    for (Buffer& buffer : buffers_) buffer.state = Buffer::State::Mine;
    return 0;
  }
  if (buffers_.empty()) return -EINVAL;
  if (streaming_) return 0;
  streaming_ = true;
  stream_start_ = kernel_.now();
  frame_ = 0;
  return 0;
}

void FakeV4l2Card::release(Session& session) {
  if (owner_ != &session) return;
  stream(session, false);
  buffers_.clear();
  owner_ = nullptr;
}

}  // namespace depthscope::fake
