#include "tests/fake_kernel/fake_v4l2_card.hpp"

#include <algorithm>
#include <cstring>

#include "tests/fake_kernel/fake_v4l2_session.hpp"

namespace depthscope::fake {
namespace {

v4l2_dv_timings mode(__u32 width, __u32 height, __u64 clock, std::array<__u32, 6> blanking) {
  v4l2_dv_timings t{};
  t.type = V4L2_DV_BT_656_1120;
  t.bt.width = width;
  t.bt.height = height;
  t.bt.pixelclock = clock;
  t.bt.hfrontporch = blanking[0];
  t.bt.hsync = blanking[1];
  t.bt.hbackporch = blanking[2];
  t.bt.vfrontporch = blanking[3];
  t.bt.vsync = blanking[4];
  t.bt.vbackporch = blanking[5];
  return t;
}

}  // namespace

v4l2_dv_timings timings720p60() {
  return mode(1280, 720, 74250000, {110, 40, 220, 5, 5, 20});
}
v4l2_dv_timings timings1080p60() {
  return mode(1920, 1080, 148500000, {88, 44, 148, 4, 5, 36});
}
v4l2_dv_timings timingsSmall(__u32 width, __u32 height, double rate, bool interlaced) {
  v4l2_dv_timings t = mode(width, height, 0, {8, 8, 8, 2, 2, 2});
  t.bt.interlaced = interlaced;
  t.bt.pixelclock =
      static_cast<__u64>(rate * V4L2_DV_BT_FRAME_WIDTH(&t.bt) * V4L2_DV_BT_FRAME_HEIGHT(&t.bt));
  return t;
}

FakeV4l2Card::FakeV4l2Card(FakeKernel& kernel, Options options)
    : kernel_(kernel),
      options_(std::move(options)),
      mode_(timingsSmall(64, 48, 50)),
      set_mode_(mode_) {
  const auto [width, height] =
      options_.sizes.empty() ? std::pair<__u32, __u32>(64, 48) : options_.sizes.front();
  layout_ = fakeLayout(options_.formats.empty() ? V4L2_PIX_FMT_SBGGR8 : options_.formats.front(),
                       width, height, options_.padding);
  scene_ = [](int, int, std::uint64_t, int) { return Rgb{0.5, 0.5, 0.5}; };
}

FakeV4l2Card::~FakeV4l2Card() = default;

int FakeV4l2Card::open(int, std::unique_ptr<FakeFile>& file) {
  if (!connected_) return -ENODEV;
  if (refuse_open_ != 0) return -refuse_open_;
  file = std::make_unique<File>(std::make_shared<Session>(*this));
  return 0;
}

// What happens to the card.

void FakeV4l2Card::at(Time time, std::function<void()> what) {
  schedule_.emplace(time, std::move(what));
}

void FakeV4l2Card::setSignal(Signal signal) {
  catchUp();
  signal_ = signal;
  raise();
}

void FakeV4l2Card::setMode(const v4l2_dv_timings& mode) {
  catchUp();
  mode_ = mode;
  raise();
}

void FakeV4l2Card::disconnect() {
  catchUp();
  connected_ = false;
  streaming_ = false;
  incoming_.clear();
  outgoing_.clear();
  for (Session* session : sessions_) session->gone = true;
}

void FakeV4l2Card::reconnect() {
  connected_ = true;
  owner_ = nullptr;
  buffers_.clear();
  set_mode_ = mode_;
}

void FakeV4l2Card::setScene(std::function<Rgb(int, int, std::uint64_t, int)> scene) {
  scene_ = std::move(scene);
}

void FakeV4l2Card::setJpeg(std::function<std::vector<std::uint8_t>(std::uint64_t)> jpeg) {
  jpeg_ = std::move(jpeg);
}

void FakeV4l2Card::raise() {
  if (!options_.events) return;
  v4l2_event event{};
  event.type = V4L2_EVENT_SOURCE_CHANGE;
  event.id = static_cast<__u32>(input_);
  event.u.src_change.changes = V4L2_EVENT_SRC_CH_RESOLUTION;
  for (Session* session : sessions_)
    if (session->subscribed) session->events.push_back(event);
}

// Pictures as time goes by.

double FakeV4l2Card::rate() const {
  if (!options_.digital) return options_.camera_fps;
  const v4l2_bt_timings& bt = set_mode_.bt;
  const double frames =
      static_cast<double>(bt.pixelclock) /
      (static_cast<double>(V4L2_DV_BT_FRAME_WIDTH(&bt)) * V4L2_DV_BT_FRAME_HEIGHT(&bt));
  return options_.field == V4L2_FIELD_ALTERNATE ? 2 * frames : frames;
}

Time FakeV4l2Card::nextFrame() const {
  return stream_start_ + std::chrono::nanoseconds(static_cast<std::int64_t>(
                             static_cast<double>(frame_ + 1) / rate() * 1e9));
}

bool FakeV4l2Card::showsNoise() const {
  if (!options_.digital) return signal_ != Signal::Good;
  return signal_ != Signal::Good || std::memcmp(&mode_, &set_mode_, sizeof mode_) != 0;
}

/// Everything up to now, in its order.
void FakeV4l2Card::catchUp() {
  for (;;) {
    const Time now = kernel_.now();
    const bool frame_due = streaming_ && nextFrame() <= now;
    const bool event_due = !schedule_.empty() && schedule_.begin()->first <= now;
    if (event_due && (!frame_due || schedule_.begin()->first <= nextFrame())) {
      const auto what = std::move(schedule_.begin()->second);
      schedule_.erase(schedule_.begin());
      what();
    } else if (frame_due) {
      complete(nextFrame());
    } else {
      return;
    }
  }
}

/// One picture; without a buffer for it, it is lost and its number with it.
void FakeV4l2Card::complete(Time when) {
  const std::uint64_t index = frame_++;
  if (incoming_.empty() || stalled_) return;
  const __u32 slot = incoming_.front();
  incoming_.pop_front();
  Buffer& buffer = buffers_[slot];
  buffer.state = Buffer::State::Done;
  buffer.done = {};
  buffer.done.flags =
      options_.monotonic ? V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC : V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  const bool alternate = options_.field == V4L2_FIELD_ALTERNATE;
  buffer.done.sequence = static_cast<__u32>(alternate ? index / 2 : index);
  const __u32 of_frame = index % 2 == 0 ? V4L2_FIELD_TOP : V4L2_FIELD_BOTTOM;
  buffer.done.field = alternate ? of_frame : options_.field;
  const auto us =
      std::chrono::duration_cast<std::chrono::microseconds>(when.time_since_epoch()).count();
  buffer.done.timestamp = {us / 1000000, us % 1000000};
  for (std::size_t i = 0; i < layout_.pieces; ++i)
    buffer.used[i] = static_cast<__u32>(layout_.size[i] + options_.data_offset);
  if (damage_ > 0) {
    --damage_;
    buffer.done.flags |= V4L2_BUF_FLAG_ERROR;
  } else {
    fill(buffer, index);
  }
  if (shorten_ > 0) {
    --shorten_;
    buffer.used[0] /= 2;
  }
  outgoing_.push_back(slot);
}

void FakeV4l2Card::fill(Buffer& buffer, std::uint64_t index) {
  if (layout_.fourcc == V4L2_PIX_FMT_MJPEG) {
    const auto data = jpeg_(index);
    std::memcpy(buffer.pieces[0].get(), data.data(), data.size());
    buffer.used[0] = static_cast<__u32>(data.size());
    return;
  }
  const int half = static_cast<int>(layout_.height + 1) / 2;
  const auto colour = [&](int x, int y) {
    if (showsNoise()) return noise;
    switch (options_.field) {
      case V4L2_FIELD_INTERLACED_TB:
        return scene_(x, y, index, y % 2);
      case V4L2_FIELD_INTERLACED_BT:
        return scene_(x, y, index, 1 - y % 2);
      case V4L2_FIELD_INTERLACED:
        return scene_(x, y, index, layout_.height <= 486 ? 1 - y % 2 : y % 2);
      case V4L2_FIELD_SEQ_TB:
        return y < half ? scene_(x, 2 * y, index, 0) : scene_(x, 2 * (y - half) + 1, index, 1);
      case V4L2_FIELD_SEQ_BT:
        return y < half ? scene_(x, 2 * y + 1, index, 0) : scene_(x, 2 * (y - half), index, 1);
      case V4L2_FIELD_ALTERNATE: {
        const int field = static_cast<int>(index % 2);
        return scene_(x, 2 * y + field, index / 2, field);
      }
      default:
        return scene_(x, y, index, 0);
    }
  };
  std::array<std::byte*, 3> pieces{};
  for (std::size_t i = 0; i < layout_.pieces; ++i)
    pieces[i] = buffer.pieces[i].get() + options_.data_offset;
  Encoding encoding = options_.encoding;
  const bool rgb = layout_.fourcc == V4L2_PIX_FMT_BGR24 || layout_.fourcc == V4L2_PIX_FMT_RGB24 ||
                   layout_.fourcc == V4L2_PIX_FMT_XBGR32;
  if (rgb || layout_.fourcc == V4L2_PIX_FMT_GREY)
    encoding.limited = options_.quantization == V4L2_QUANTIZATION_LIM_RANGE;
  paint(layout_, encoding, colour, pieces);
}

}  // namespace depthscope::fake
