#include "capture/lockstep_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "tests/capture/clip_writer.hpp"
#include "tests/capture/simulated_clock.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

using testing::HasSubstr;
using Kind = FaultEvent::Kind;
using std::chrono::milliseconds;

const std::filesystem::path kSample =
    std::filesystem::path(DEPTHSCOPE_TEST_DATA) / "sample/video.mp4";
constexpr FrameFormat kYuv{PixelFormat::Yuv420p, 64, 48, YuvMatrix::Bt709, YuvRange::Limited};

/// FNV-1a over all pixels.
std::uint64_t hashOf(const Frame& frame) {
  std::uint64_t hash = 14695981039346656037u;
  for (int plane = 0; plane < planeCount(frame.format.pixel_format); ++plane) {
    const PlaneSize size = planeSize(frame.format, plane);
    for (int y = 0; y < size.rows; ++y)
      for (int x = 0; x < size.row_bytes; ++x)
        hash =
            (hash ^ frame.planes[plane].data[y * frame.planes[plane].stride + x]) * 1099511628211u;
  }
  return hash;
}

std::string openError(const std::filesystem::path& path) {
  try {
    openFileSource({.path = path});
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

class Lockstep : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(std::vector<FaultEvent> faults, bool loop = false) {
    return openFileSource({.path = clip_, .loop = loop, .faults = std::move(faults)}, clock_);
  }
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    clip_ = *folder_ / "clip.mkv";
    writeVideo(clip_, kYuv, 6, 25, gradient);
  }
  static void TearDownTestSuite() { delete folder_; }
  static int firstPixel(const ReadResult& result) { return result.frame.planes[0].data[0]; }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline std::filesystem::path clip_;
  SimulatedClock clock_;
};

TEST_F(Lockstep, GivesEveryFrameOnceWithItsTimeAndExactPixels) {
  const auto source = open({});
  EXPECT_EQ(source->format(), kYuv);
  EXPECT_EQ(source->fps(), 25);
  for (int i = 0; i < 6; ++i) {
    const ReadResult result = source->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_FALSE(result.format_changed);
    EXPECT_EQ(result.frame.format, kYuv);
    EXPECT_EQ(result.frame.sequence, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(result.frame.media_time_s, i / 25.0);
    EXPECT_EQ(result.frame.capture_time, clock_.now());
    EXPECT_FALSE(result.frame.damaged);
    for (int plane = 0; plane < 3; ++plane)
      for (int y = 0; y < planeSize(kYuv, plane).rows; ++y)
        for (int x = 0; x < planeSize(kYuv, plane).row_bytes; ++x)
          ASSERT_EQ(result.frame.planes[plane].data[y * result.frame.planes[plane].stride + x],
                    gradient(i, plane, x, y));
  }
  EXPECT_EQ(source->read({}).status, SourceStatus::EndOfStream);
  EXPECT_EQ(source->read({}).status, SourceStatus::EndOfStream);
  EXPECT_EQ(source->skipped(), 0u);
  EXPECT_EQ(source->damage(), "");
}

TEST_F(Lockstep, HandsOnNativeFormatsWithoutConversion) {
  for (const PixelFormat native : {PixelFormat::Rgb24, PixelFormat::Bgr24, PixelFormat::Nv12}) {
    FrameFormat format = kYuv;
    format.pixel_format = native;
    writeVideo(*folder_ / "native.nut", format, 2, 25, gradient);
    const auto source = openFileSource({.path = *folder_ / "native.nut"}, clock_);
    source->read({});
    const ReadResult result = source->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    ASSERT_EQ(result.frame.format.pixel_format, native);
    for (int plane = 0; plane < planeCount(native); ++plane)
      EXPECT_EQ(result.frame.planes[plane].data[result.frame.planes[plane].stride * 3 + 5],
                gradient(1, plane, 5, 3));
  }
}

TEST_F(Lockstep, LoopGoesOnCountingAndRepeatsThePixels) {
  const auto source = open({}, true);
  std::vector<std::uint64_t> hashes;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const ReadResult result = source->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.frame.sequence, i);
    EXPECT_DOUBLE_EQ(result.frame.media_time_s, static_cast<double>(i) / 25.0);
    hashes.push_back(hashOf(result.frame));
    if (i >= 6) {
      EXPECT_EQ(hashes[i], hashes[i - 6]);
    }
  }
}

TEST_F(Lockstep, LoopEndsWhenTheClipIsGone) {
  const auto gone = *folder_ / "gone.mkv";
  std::filesystem::copy_file(clip_, gone, std::filesystem::copy_options::overwrite_existing);
  const auto source = openFileSource({.path = gone, .loop = true}, clock_);
  std::filesystem::remove(gone);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(source->read({}).status, SourceStatus::Ok);
  EXPECT_EQ(source->read({}).status, SourceStatus::EndOfStream);
}

TEST_F(Lockstep, LosesNothingWhileTheCallerHoldsAllBuffers) {
  const auto source = open({});
  std::array<ReadResult, 4> held;
  for (ReadResult& result : held) result = source->read({});
  EXPECT_EQ(source->read({}).status, SourceStatus::Timeout);
  EXPECT_EQ(source->read({}).status, SourceStatus::Timeout);
  held[2].frame = {};
  const ReadResult next = source->read({});
  ASSERT_EQ(next.status, SourceStatus::Ok);
  EXPECT_EQ(next.frame.sequence, 4u);
  EXPECT_EQ(firstPixel(held[0]), gradient(0, 0, 0, 0));
}

TEST_F(Lockstep, SignalLostGivesNoSignalForItsFramesInEveryPass) {
  const auto source = open({{Kind::SignalLost, 2, 3}}, true);
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 0; i < 6; ++i) {
      const ReadResult result = source->read({});
      if (i >= 2 && i < 5) {
        EXPECT_EQ(result.status, SourceStatus::NoSignal);
        EXPECT_TRUE(result.frame.empty());
      } else {
        ASSERT_EQ(result.status, SourceStatus::Ok);
        EXPECT_EQ(result.frame.sequence, static_cast<std::uint64_t>(pass * 6 + i));
        EXPECT_EQ(firstPixel(result), gradient(i, 0, 0, 0));
      }
    }
}

TEST_F(Lockstep, ResizeChangesTheFormatAndSaysSoBothWays) {
  const auto source = open({{Kind::Resize, 2, 2, 32, 20}});
  const std::array<bool, 6> changed{false, false, true, false, true, false};
  for (int i = 0; i < 6; ++i) {
    const ReadResult result = source->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.format_changed, changed[i]) << i;
    EXPECT_EQ(result.frame.format.width, i == 2 || i == 3 ? 32 : 64);
    EXPECT_EQ(result.frame.format.height, i == 2 || i == 3 ? 20 : 48);
    EXPECT_EQ(result.frame.format.matrix, YuvMatrix::Bt709);
    EXPECT_EQ(source->format(), result.frame.format);
  }
}

TEST_F(Lockstep, ResizeKeepsTheLevelsOfThePicture) {
  const auto flat = [](int, int plane, int, int) { return std::uint8_t(60 + plane * 40); };
  writeVideo(*folder_ / "flat.mkv", kYuv, 1, 25, flat);
  const auto source = openFileSource(
      {.path = *folder_ / "flat.mkv", .faults = {{Kind::Resize, 0, 1, 100, 70}}}, clock_);
  const ReadResult result = source->read({});
  ASSERT_EQ(result.status, SourceStatus::Ok);
  for (int plane = 0; plane < 3; ++plane) {
    const PlaneSize size = planeSize(result.frame.format, plane);
    const Plane& pixels = result.frame.planes[plane];
    EXPECT_EQ(pixels.data[0], 60 + plane * 40);
    EXPECT_EQ(pixels.data[(size.rows - 1) * pixels.stride + size.row_bytes - 1], 60 + plane * 40);
  }
}

TEST_F(Lockstep, LatePicturesAreOldWhenTheyCome) {
  const auto source = open({{Kind::Late, 1, 1, 0, 0, 40.0}});
  EXPECT_EQ(source->read({}).frame.capture_time, clock_.now());
  EXPECT_EQ(source->read({}).frame.capture_time, clock_.now() - milliseconds(40));
  EXPECT_EQ(source->read({}).frame.capture_time, clock_.now());
}

TEST_F(Lockstep, DamagedPicturesAreMarkedAndDifferInPart) {
  const auto clean = open({});
  const auto source = open({{Kind::Damaged, 1, 1}});
  const auto again = open({{Kind::Damaged, 1, 1}});
  for (int i = 0; i < 3; ++i) {
    const ReadResult a = clean->read({}), b = source->read({}), c = again->read({});
    EXPECT_EQ(b.frame.damaged, i == 1);
    EXPECT_EQ(hashOf(a.frame) != hashOf(b.frame), i == 1);
    EXPECT_EQ(hashOf(b.frame), hashOf(c.frame)) << "garbage must be the same in every run";
    EXPECT_EQ(std::memcmp(a.frame.planes[0].data, b.frame.planes[0].data, 64), 0);
  }
}

TEST_F(Lockstep, RepeatedPicturesHaveANewNumberAndTheOldPixels) {
  const auto source = open({{Kind::Repeated, 2, 2}});
  const std::array<int, 6> shown{0, 1, 1, 1, 4, 5};
  for (int i = 0; i < 6; ++i) {
    const ReadResult result = source->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.frame.sequence, static_cast<std::uint64_t>(i));
    EXPECT_EQ(firstPixel(result), gradient(shown[i], 0, 0, 0)) << i;
  }
}

TEST_F(Lockstep, FaultsMayOverlap) {
  const auto source = open({{Kind::Resize, 0, 2, 32, 32}, {Kind::Damaged, 1, 1}});
  EXPECT_FALSE(source->read({}).frame.damaged);
  const ReadResult result = source->read({});
  EXPECT_TRUE(result.frame.damaged);
  EXPECT_EQ(result.frame.format.width, 32);
}

TEST(SampleClip, DecodesWholeAndTheSameTwice) {
  EXPECT_EQ(countFrames(kSample), 450);
  const auto a = openFileSource({.path = kSample}), b = openFileSource({.path = kSample});
  EXPECT_EQ(a->fps(), 30);
  EXPECT_EQ(a->format(),
            (FrameFormat{PixelFormat::Yuv420p, 640, 480, YuvMatrix::Bt601, YuvRange::Limited}));
  int frames = 0;
  for (;; ++frames) {
    const ReadResult first = a->read({});
    if (first.status == SourceStatus::EndOfStream) break;
    ASSERT_EQ(first.status, SourceStatus::Ok);
    if (frames < 60) {
      ASSERT_EQ(hashOf(first.frame), hashOf(b->read({}).frame)) << "frame " << frames;
    }
  }
  EXPECT_EQ(frames, 450);
  EXPECT_EQ(a->damage(), "");
}

TEST(SampleClip, TruncatedAtItsEndCannotBeOpened) {
  const TemporaryFolder folder;
  truncateFile(kSample, folder / "cut.mp4", 300000);  // its index is at the end
  EXPECT_THAT(openError(folder / "cut.mp4"), HasSubstr("cut.mp4: not a video that can be read"));
}

TEST_F(Lockstep, AClipThatBreaksOffEndsWithWhatDecodedAndSaysSo) {
  const TemporaryFolder folder;
  const FrameFormat noise{PixelFormat::Yuv420p, 64, 48};
  writeVideo(folder / "long.mkv", noise, 75, 25, gradient);
  truncateFile(folder / "long.mkv", folder / "cut.mkv",
               std::filesystem::file_size(folder / "long.mkv") / 2);
  const auto source = openFileSource({.path = folder / "cut.mkv"}, clock_);
  int frames = 0;
  while (source->read({}).status != SourceStatus::EndOfStream) ASSERT_LT(++frames, 75);
  EXPECT_GT(frames, 20);
  EXPECT_THAT(source->damage(), HasSubstr("of 75 announced frames"));
}

TEST(BadInput, DamagedPacketsOfAVideoAreReported) {
  const TemporaryFolder folder;
  truncateFile(kSample, folder / "hit.mp4", std::filesystem::file_size(kSample));
  std::fstream file(folder / "hit.mp4", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(300000);
  file << std::string(3000, 'x');
  file.close();
  const auto source = openFileSource({.path = folder / "hit.mp4"});
  int marked = 0;
  for (;;) {
    const ReadResult result = source->read({});
    if (result.status == SourceStatus::EndOfStream) break;
    marked += result.status != SourceStatus::Ok || result.frame.damaged;
  }
  EXPECT_GT(marked, 0);
  EXPECT_THAT(source->damage(), HasSubstr("hit.mp4: "));
}

TEST(BadInput, IsNamedInOneLine) {
  const TemporaryFolder folder;
  std::ofstream(folder / "empty.mp4");
  std::ofstream(folder / "text.txt") << "a text is no video\n";
  std::ofstream(folder / "text.mp4") << "nor when it is called one\n";
  writePicture(folder / "one.jpg", {PixelFormat::Yuv420p, 64, 48, YuvMatrix::Bt601, YuvRange::Full},
               0, gradient);
  std::ofstream(folder / "list.ffconcat")
      << "ffconcat version 1.0\nfile " << kSample.string() << "\n";
  std::ofstream(folder / "list.m3u8") << "#EXTM3U\n#EXTINF:1,\n" << kSample.string() << "\n";
  EXPECT_THAT(openError(folder / "missing.mp4"), HasSubstr("missing.mp4: no such file"));
  EXPECT_THAT(openError(folder / "empty.mp4"), HasSubstr("empty.mp4: is empty"));
  for (const char* name : {"text.txt", "text.mp4", "one.jpg", "list.ffconcat", "list.m3u8"}) {
    const std::string error = openError(folder / name);
    EXPECT_THAT(error, HasSubstr(std::string(name) + ": not a video that can be read"));
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  EXPECT_THAT(openError("/dev/null"), HasSubstr("neither a file nor a folder"));
  EXPECT_THROW(countFrames(folder / "missing.mp4"), InputError);
}

TEST(BadInput, BufferCountsOutOfRangeAreRefused) {
  EXPECT_THROW(openFileSource({.path = kSample, .buffers = 1}), InputError);
  EXPECT_THROW(openFileSource({.path = kSample, .buffers = 65}), InputError);
}

}  // namespace
}  // namespace depthscope::capture
