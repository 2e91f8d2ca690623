#include "capture/deinterlace.hpp"

#include "tests/capture/v4l2_test_card.hpp"

namespace depthscope::capture {
namespace {

class V4l2Fields : public V4l2Test, public testing::WithParamInterface<__u32> {};

/// The earlier field sees red, the later one a ramp down the picture: none of the red may come out,
/// and between its lines the ramp has to go on.
TEST_P(V4l2Fields, OnlyTheNewerFieldIsShownAndLinesBetweenAreInterpolated) {
  FakeV4l2Card::Options options;
  options.formats = {V4L2_PIX_FMT_BGR24};
  options.field = GetParam();
  plug(options);
  const bool alone = GetParam() == V4L2_FIELD_ALTERNATE;
  card->setScene([&](int, int y, std::uint64_t, int field) {
    if (!alone && field == 0) return Rgb{1, 0, 0};
    const double level = (40 + 4 * y) / 255.0;
    return Rgb{0, level, level};
  });
  card->setMode(fake::timingsSmall(64, 48, 25, true));
  open();
  for (int i = 0; i < 4; ++i) {
    const Frame frame = nextPicture();
    ASSERT_FALSE(frame.empty()) << source->detail();
    ASSERT_EQ(frame.format.height, 48);
    const auto pixels = rgbaOf(frame);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const std::uint8_t* p = &pixels[static_cast<std::size_t>(4 * (y * 64 + x))];
        ASSERT_EQ(p[0], 0) << "line " << y << " is of the other field";
        const bool border = y == 0 || y == 47;  // may be the nearest line twice
        ASSERT_NEAR(p[1], 40 + 4 * y, border ? 4 : 1) << "line " << y;
      }
  }
}

INSTANTIATE_TEST_SUITE_P(All, V4l2Fields,
                         testing::Values(V4L2_FIELD_INTERLACED, V4L2_FIELD_INTERLACED_TB,
                                         V4L2_FIELD_INTERLACED_BT, V4L2_FIELD_SEQ_TB,
                                         V4L2_FIELD_SEQ_BT, V4L2_FIELD_ALTERNATE));

TEST_F(V4l2Test, FieldsOneByOneAreEachAPictureOfItsTime) {
  plug({.formats = {V4L2_PIX_FMT_NV12}, .field = V4L2_FIELD_ALTERNATE});
  card->setMode(fake::timingsSmall(64, 48, 25, true));
  open();
  const Frame first = nextPicture(), second = nextPicture();
  ASSERT_FALSE(first.empty() || second.empty());
  EXPECT_NEAR(std::chrono::duration<double>(second.capture_time - first.capture_time).count(), 0.02,
              0.001);
  EXPECT_EQ(source->skipped(), 0u);
}

/// Chroma lines belong to fields too.
TEST_F(V4l2Test, ChromaOfInterlacedPicturesIsOfTheSameField) {
  plug({.formats = {V4L2_PIX_FMT_NV16}, .field = V4L2_FIELD_INTERLACED_TB});
  card->setScene([](int, int, std::uint64_t, int field) {
    return field == 0 ? Rgb{0, 1, 0} : Rgb{0, 0, 1};
  });
  card->setMode(fake::timingsSmall(64, 48, 25, true));
  open();
  const Frame frame = nextPicture();
  ASSERT_FALSE(frame.empty());
  EXPECT_LE(farthest(frame, [](int, int) { return Rgb{0, 0, 1}; }), 2.0);
}

TEST_F(V4l2Test, AnUnknownOrderOfFieldsIsRefusedInWords) {
  plug({.field = 77});
  open();
  EXPECT_EQ(source->read(0ms).status, SourceStatus::UnsupportedMode);
  EXPECT_EQ(source->detail(), "an unknown order of fields");
}

}  // namespace
}  // namespace depthscope::capture
