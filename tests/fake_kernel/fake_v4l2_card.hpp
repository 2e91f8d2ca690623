#pragma once
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/fake_kernel/fake_kernel.hpp"
#include "tests/fake_kernel/fake_v4l2_picture.hpp"

namespace depthscope::fake {

/// A 1280x720 and a 1920x1080 mode at 60, and a small one at 50 for tests of many frames.
v4l2_dv_timings timings720p60();
v4l2_dv_timings timings1080p60();
v4l2_dv_timings timingsSmall(__u32 width, __u32 height, double rate, bool interlaced = false);

/// A capture card as the kernel's V4L2 and videobuf2 would let a program see it: one node, one
/// owner of its buffers, and pictures by the kernel's simulated clock.
///
/// As with vivid and some real cards, pictures keep coming when the signal is gone or of another
/// mode than the card expects; they are then of the colour `noise`.
class FakeV4l2Card final : public FakeDevice {
 public:
  struct Options {
    std::string name = "Fake HDMI", bus = "PCI:0000:01:00.0";
    bool multiplanar = false;
    bool digital = true;  // an HDMI input with timings and EDID; else a camera with sizes to choose
    std::vector<std::string> inputs{"HDMI"};
    std::vector<__u32> formats{V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12};
    std::vector<std::pair<__u32, __u32>> sizes{};  // of a camera
    std::size_t padding = 0;                       // [bytes] after each line
    std::size_t data_offset = 0;                   // [bytes] before the picture, multi-planar only
    __u32 field = V4L2_FIELD_NONE;
    __u32 colorspace = V4L2_COLORSPACE_REC709;
    __u32 ycbcr_enc = V4L2_YCBCR_ENC_DEFAULT, quantization = V4L2_QUANTIZATION_DEFAULT;
    Encoding encoding{0.2126, 0.0722, true};  // what the numbers above mean
    bool events = true, exports = true, monotonic = true;
    bool orphans = true;  // buffers may be given up while they are mapped (since Linux 4.20)
    __u32 most_buffers = 32;
    double camera_fps = 30;                  // [1/s]
    double compressed_fps = 0, raw_fps = 0;  // [1/s] that ENUM_FRAMEINTERVALS tells; 0: nothing
  };
  enum class Signal { Good, NoCable, Missing, Unlocked, OutOfRange };

  static constexpr Rgb noise{0.9, 0.1, 0.8};

  FakeV4l2Card(FakeKernel& kernel, Options options);
  ~FakeV4l2Card() override;
  int open(int flags, std::unique_ptr<FakeFile>& file) override;

  // What happens to the card. All take effect now; at() makes it happen at a time to come, also
  // while a program waits.
  void at(Time time, std::function<void()> what);
  void setSignal(Signal signal);
  void setMode(const v4l2_dv_timings& mode);
  void disconnect();  // files that are open see ENODEV from now on, and so do new ones
  void reconnect();
  void damageNext(int frames) { damage_ = frames; }  // flagged by the driver, with old content
  void shortenNext(int frames) { shorten_ = frames; }
  void stall(bool stalled) { stalled_ = stalled; }  // signal, but no pictures
  void refuseOpen(int error) { refuse_open_ = error; }
  /// What the camera sees in frame `index`, which counts the pictures since the stream's start;
  /// `field` 0 and 1 are the earlier and the later field of an interlaced frame.
  void setScene(std::function<Rgb(int x, int y, std::uint64_t index, int field)> scene);
  /// Compressed data of frame `index`.
  void setJpeg(std::function<std::vector<std::uint8_t>(std::uint64_t index)> jpeg);

  const std::vector<std::uint8_t>& edid() const { return edid_; }
  void setEdid(std::vector<std::uint8_t> edid) { edid_ = std::move(edid); }
  int edidWrites() const { return edid_writes_; }
  bool streaming() const { return streaming_; }
  std::size_t queuedBuffers() const { return incoming_.size(); }
  int currentInput() const { return input_; }
  __u32 fourcc() const { return layout_.fourcc; }

 private:
  struct Session;
  struct File;
  struct Buffer {
    enum class State { Mine, Queued, Done } state = State::Mine;  // Mine: the program's
    std::vector<std::shared_ptr<std::byte[]>> pieces;
    v4l2_buffer done{};
    std::array<__u32, 3> used{};
  };

  int answer(Session& session, unsigned long request, void* argument);
  int queryCap(v4l2_capability& out) const;
  int enumInput(v4l2_input& out) const;
  int setInput(int index);
  int enumFormat(v4l2_fmtdesc& out) const;
  int enumSizes(v4l2_frmsizeenum& out) const;
  int enumIntervals(v4l2_frmivalenum& out) const;
  int format(v4l2_format& f, bool set, bool attempt);
  void describe(v4l2_format& f, const FakeLayout& layout) const;
  int frameRate(v4l2_streamparm& p) const;
  int queryTimings(v4l2_dv_timings& out) const;
  int setTimings(const v4l2_dv_timings& timings);
  int control(v4l2_ext_controls& controls) const;
  int readEdid(v4l2_edid& e) const;
  int writeEdid(v4l2_edid& e);
  int subscribe(Session& session, const v4l2_event_subscription& s);
  int nextEventOf(Session& session, v4l2_event& out);
  int requestBuffers(Session& session, v4l2_requestbuffers& r);
  int queryBuffer(v4l2_buffer& b) const;
  int exportBuffer(v4l2_exportbuffer& e);
  int queueBuffer(Session& session, const v4l2_buffer& b);
  int dequeueBuffer(Session& session, v4l2_buffer& b);
  int stream(Session& session, bool on);
  std::shared_ptr<std::byte[]> map(std::shared_ptr<Session> session, std::size_t length,
                                   off_t offset, int& error);
  void release(Session& session);

  void catchUp();
  void complete(Time when);
  void fill(Buffer& buffer, std::uint64_t index);
  void raise();
  double rate() const;
  Time nextFrame() const;
  bool showsNoise() const;

  FakeKernel& kernel_;
  Options options_;
  bool connected_ = true;
  int refuse_open_ = 0;
  Signal signal_ = Signal::Good;
  v4l2_dv_timings mode_, set_mode_;  // of the signal; as the program set it
  int input_ = 0;
  FakeLayout layout_;
  std::vector<std::uint8_t> edid_;
  int edid_writes_ = 0;
  std::vector<Session*> sessions_;
  const Session* owner_ = nullptr;  // of the buffers
  std::vector<Buffer> buffers_;
  std::deque<__u32> incoming_, outgoing_;
  bool streaming_ = false, stalled_ = false;
  Time stream_start_;
  std::uint64_t frame_ = 0;  // frames since the stream's start
  int damage_ = 0, shorten_ = 0;
  std::function<Rgb(int, int, std::uint64_t, int)> scene_;
  std::function<std::vector<std::uint8_t>(std::uint64_t)> jpeg_;
  std::multimap<Time, std::function<void()>> schedule_;
};

}  // namespace depthscope::fake
