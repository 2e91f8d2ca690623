#include "platform/video_writer.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "capture/file_source.hpp"
#include "expect_input_error.hpp"
#include "platform/video_queue.hpp"
#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

std::vector<std::uint8_t> greyPicture(int width, int height, int level) {
  std::vector<std::uint8_t> p(static_cast<std::size_t>(width * height * 4),
                              static_cast<std::uint8_t>(level));
  return p;
}

/// Mean luma of each picture of a clip, read back, and the clip's rate.
std::vector<double> readBack(const std::filesystem::path& path, double& fps) {
  capture::FileSourceSettings settings;
  settings.path = path;
  const auto source = capture::openFileSource(settings);
  fps = source->fps();
  std::vector<double> means;
  for (;;) {
    const auto r = source->read(std::chrono::seconds(5));
    if (r.status != capture::SourceStatus::Ok) break;
    const GrayView luma = r.frame.luma();
    double sum = 0;
    for (int y = 0; y < luma.height; ++y)
      for (int x = 0; x < luma.width; ++x) sum += luma.row(y)[x];
    means.push_back(sum / (luma.width * luma.height));
  }
  return means;
}

TEST(VideoWriter, EveryPictureComesBackInOrderAndAtTheRate) {
  const TemporaryFolder folder;
  {
    VideoWriter writer(folder.path() / "a.mp4", 64, 48, 30000.0 / 1001.0);
    for (int i = 0; i < 40; ++i) writer.write({greyPicture(64, 48, 5 * i).data(), 64, 48, 256}, i);
    writer.finish();
  }
  double fps = 0;
  const auto means = readBack(folder.path() / "a.mp4", fps);
  ASSERT_EQ(means.size(), 40u);
  EXPECT_NEAR(fps, 29.97, 0.01);
  for (int i = 0; i < 40; ++i)
    EXPECT_NEAR(means[static_cast<std::size_t>(i)], 16 + 5 * i * 219 / 255.0, 3) << i;
}

TEST(VideoWriter, LeavesOutAnOddLastRowAndColumn) {
  const TemporaryFolder folder;
  VideoWriter writer(folder.path() / "a.mp4", 65, 49, 25);
  writer.write({greyPicture(65, 49, 100).data(), 65, 49, 260}, 0);
  writer.finish();
  capture::FileSourceSettings settings;
  settings.path = folder.path() / "a.mp4";
  const capture::FrameFormat format = capture::openFileSource(settings)->format();
  EXPECT_EQ(format.width, 64);
  EXPECT_EQ(format.height, 48);
}

TEST(VideoWriter, NamesAFileThatCannotBeMade) {
  const TemporaryFolder folder;
  EXPECT_INPUT_ERROR(VideoWriter(folder.path() / "none" / "a.mp4", 64, 48, 25), HasSubstr("a.mp4"),
                     HasSubstr("cannot be written"));
}

TEST(VideoQueue, WritesAllThatWasSubmitted) {
  const TemporaryFolder folder;
  {
    VideoQueue queue(folder.path() / "a.mp4", 64, 48, 25);
    for (int i = 0; i < 30; ++i) {
      const auto buffer = queue.acquire(VideoQueue::WhenFull::Wait);
      ASSERT_EQ(buffer.size(), 64u * 48u * 4u);
      std::fill(buffer.begin(), buffer.end(), static_cast<std::uint8_t>(8 * i));
      queue.submit(i);
    }
    queue.finish();
  }
  double fps = 0;
  EXPECT_EQ(readBack(folder.path() / "a.mp4", fps).size(), 30u);
}

TEST(VideoQueue, EndsInOrderWithoutFinish) {
  const TemporaryFolder folder;
  VideoQueue queue(folder.path() / "a.mp4", 64, 48, 25);
  queue.acquire(VideoQueue::WhenFull::Wait);
  queue.submit(0);
}

TEST(VideoQueue, PassesOnThatTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  EXPECT_THROW(
      {
        VideoQueue queue("/dev/full", 256, 256, 25);
        for (int i = 0; i < 200; ++i) {
          const auto buffer = queue.acquire(VideoQueue::WhenFull::Wait);
          for (std::size_t k = 0; k < buffer.size(); ++k)
            buffer[k] = static_cast<std::uint8_t>(k * k * 31 + static_cast<std::size_t>(i) * 7919);
          queue.submit(i);
        }
        queue.finish();
      },
      std::exception);
}

}  // namespace
}  // namespace depthscope::platform
