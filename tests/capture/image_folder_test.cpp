#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "capture/file_source.hpp"
#include "tests/capture/clip_writer.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

using testing::HasSubstr;

constexpr FrameFormat kGray{PixelFormat::Gray8, 40, 24, YuvMatrix::Bt601, YuvRange::Full};
constexpr FrameFormat kRgb{PixelFormat::Rgb24, 40, 24, YuvMatrix::Bt601, YuvRange::Full};
constexpr FrameFormat kJpeg{PixelFormat::Yuv420p, 40, 24, YuvMatrix::Bt601, YuvRange::Full};

class ImageFolderSource : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open() { return openFileSource({.path = folder_.path()}); }
  std::string openError() {
    try {
      open();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  TemporaryFolder folder_;
};

TEST_F(ImageFolderSource, PlaysInByteOrderOfNamesAtThirtyAsecond) {
  writePicture(folder_ / "b.png", kGray, 2, gradient);
  writePicture(folder_ / "a10.png", kGray, 0, gradient);
  writePicture(folder_ / "a9.PNG", kGray, 1, gradient);  // '1' is before '9'
  writePicture(folder_ / ".hidden.png", kGray, 9, gradient);
  std::ofstream(folder_ / "notes.txt") << "not a picture";
  const auto source = open();
  EXPECT_EQ(countFrames(folder_.path()), 3);
  EXPECT_EQ(source->fps(), 30);
  for (int i = 0; i < 3; ++i) {
    const ReadResult result = source->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.frame.planes[0].data[0], gradient(i, 0, 0, 0));
    EXPECT_EQ(result.frame.sequence, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(result.frame.media_time_s, i / 30.0);
  }
  EXPECT_EQ(source->read({}).status, SourceStatus::EndOfStream);
  EXPECT_EQ(source->damage(), "");
}

TEST_F(ImageFolderSource, KeepsTheExactPixelsOfGrayAndColourPng) {
  for (const FrameFormat& format : {kGray, kRgb}) {
    const TemporaryFolder folder;
    writePicture(folder / "0.png", format, 0, gradient);
    const ReadResult result = openFileSource({.path = folder.path()})->read({});
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.frame.format, format);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < planeSize(format, 0).row_bytes; ++x)
        ASSERT_EQ(result.frame.planes[0].data[y * result.frame.planes[0].stride + x],
                  gradient(0, 0, x, y));
  }
}

TEST_F(ImageFolderSource, ReadsJpegAsFullRangeBt601) {
  const auto flat = [](int, int plane, int, int) { return std::uint8_t(plane == 0 ? 250 : 100); };
  writePicture(folder_ / "0.jpg", kJpeg, 0, flat);
  const ReadResult result = open()->read({});
  ASSERT_EQ(result.status, SourceStatus::Ok);
  EXPECT_EQ(result.frame.format, kJpeg);
  EXPECT_NEAR(result.frame.planes[0].data[0], 250, 2);
  EXPECT_NEAR(result.frame.planes[2].data[0], 100, 2);
}

TEST_F(ImageFolderSource, ConvertsPicturesOfAnotherKindToTheFirstOnes) {
  const auto flat = [](int, int, int, int) { return std::uint8_t(120); };
  writePicture(folder_ / "0.png", kRgb, 0, flat);
  writePicture(folder_ / "1.png", kGray, 0, flat);
  const auto source = open();
  ASSERT_EQ(source->read({}).status, SourceStatus::Ok);
  const ReadResult result = source->read({});
  ASSERT_EQ(result.status, SourceStatus::Ok);
  EXPECT_FALSE(result.format_changed);
  EXPECT_EQ(result.frame.format, kRgb);
  EXPECT_NEAR(result.frame.planes[0].data[5], 120, 1);
}

TEST_F(ImageFolderSource, FrameRateCanBeGiven) {
  writePicture(folder_ / "0.png", kGray, 0, gradient);
  writePicture(folder_ / "1.png", kGray, 1, gradient);
  const auto source = openFileSource({.path = folder_.path(), .fps = 12.5});
  source->read({});
  EXPECT_DOUBLE_EQ(source->read({}).frame.media_time_s, 1 / 12.5);
  EXPECT_THROW(openFileSource({.path = folder_.path(), .fps = -1}), InputError);
  EXPECT_THROW(openFileSource({.path = folder_.path(), .fps = std::nan("")}), InputError);
}

TEST_F(ImageFolderSource, RefusesAFolderWithoutPictures) {
  EXPECT_THAT(openError(), HasSubstr("no pictures"));
  std::ofstream(folder_ / "a.txt") << "x";
  EXPECT_THAT(openError(), HasSubstr("no pictures"));
}

TEST_F(ImageFolderSource, RefusesPicturesOfDifferentSizesAndNamesTheOne) {
  writePicture(folder_ / "0.png", kGray, 0, gradient);
  writePicture(folder_ / "1.png", {PixelFormat::Gray8, 42, 24}, 0, gradient);
  EXPECT_THAT(openError(), HasSubstr("1.png: is 42x24, expected 40x24"));
}

TEST_F(ImageFolderSource, RefusesWhatIsNoPictureAndNamesIt) {
  writePicture(folder_ / "0.png", kGray, 0, gradient);
  std::ofstream(folder_ / "1.png") << "not a picture at all, whatever its name says";
  EXPECT_THAT(openError(), HasSubstr("1.png: empty, truncated or not"));
  std::ofstream(folder_ / "1.png", std::ios::trunc);
  EXPECT_THAT(openError(), HasSubstr("1.png: empty, truncated or not"));
}

TEST_F(ImageFolderSource, RefusesToStartWithATruncatedPicture) {
  for (const char* name : {"whole.png", "whole.jpg"}) {
    const TemporaryFolder other;
    const FrameFormat& format = name == std::string("whole.png") ? kGray : kJpeg;
    writePicture(other / name, format, 0, gradient);
    truncateFile(other / name, folder_ / (std::string("0") + (name + 5)).c_str(),
                 std::filesystem::file_size(other / name) - 60);
    EXPECT_THAT(openError(), HasSubstr("first picture cannot be decoded")) << name;
    std::filesystem::remove(folder_ / (std::string("0") + (name + 5)).c_str());
  }
}

TEST_F(ImageFolderSource, ATruncatedPictureOnTheWayIsAReadErrorAndTheRestFollows) {
  const TemporaryFolder other;
  writePicture(other / "1.jpg", kJpeg, 1, gradient);
  writePicture(folder_ / "0.jpg", kJpeg, 0, gradient);
  truncateFile(other / "1.jpg", folder_ / "1.jpg",
               std::filesystem::file_size(other / "1.jpg") - 60);
  writePicture(folder_ / "2.jpg", kJpeg, 2, gradient);
  const auto source = open();
  EXPECT_EQ(source->read({}).status, SourceStatus::Ok);
  EXPECT_EQ(source->read({}).status, SourceStatus::ReadError);
  const ReadResult last = source->read({});
  ASSERT_EQ(last.status, SourceStatus::Ok);
  EXPECT_EQ(last.frame.sequence, 2u);
  EXPECT_THAT(source->damage(), HasSubstr("1 unreadable"));
}

}  // namespace
}  // namespace depthscope::capture
