#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "overlay/blend.hpp"
#include "tests/overlay/allocation_count.hpp"
#include "tests/overlay/overlay_scene.hpp"
#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

SurfaceMesh tissue() {
  return wall(-30, 30, -20, 30, 45, 70, 24);
}

TEST(CompositorState, WithTheCueOffEveryPixelIsThePicturesOwn) {
  OverlaySettings settings;
  settings.cue = CueMode::Off;
  Compositor compositor(testCamera(), settings);
  compositor.setSurface(tissue());
  const Label label{1, 0, {0, 0, 50}, "Vein"};
  compositor.setLabels(std::span(&label, 1));
  const Image picture = noise(320, 240);
  EXPECT_EQ(compositeOf(compositor, picture, tracking()).bytes, picture.bytes);
}

TEST(CompositorState, OutsideTheLayerEveryPixelIsThePicturesOwnAndInsideItIsBlended) {
  for (CueMode cue : {CueMode::Chromadepth, CueMode::Mesh}) {
    OverlaySettings settings;
    settings.cue = cue;
    Compositor compositor(testCamera(), settings);
    compositor.setSurface(wall(-20, 12, -14, 20, 45, 70, 24));
    const Image picture = noise(320, 240);
    const Image out = compositeOf(compositor, picture, tracking());
    const Image layer = layerOf(compositor, tracking());
    Image expected = picture;
    blendRow(layer.bytes.data(), picture.bytes.data(), expected.bytes.data(), 320 * 240);
    EXPECT_EQ(out.bytes, expected.bytes);
    int untouched = 0;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) {
        if (layer.at(x, y)[3] != 0) continue;
        ASSERT_EQ(std::memcmp(out.at(x, y), picture.at(x, y), 4), 0) << x << " " << y;
        ++untouched;
      }
    EXPECT_GT(untouched, 30000);
    EXPECT_LT(untouched, 60000);
  }
}

TEST(CompositorState, TakesPicturesWithPaddingAndInPlace) {
  Compositor compositor(testCamera(), plainSettings());
  compositor.setSurface(tissue());
  const Image picture = noise(320, 240), expected = compositeOf(compositor, picture, tracking());
  std::vector<std::uint8_t> padded(240 * 1344, 5);
  for (int y = 0; y < 240; ++y) std::memcpy(padded.data() + y * 1344, picture.at(0, y), 1280);
  Image out(320, 240);
  ASSERT_TRUE(compositor.composite({padded.data(), 320, 240, 1344}, tracking(), out.bytes));
  EXPECT_EQ(out.bytes, expected.bytes);
  out = picture;
  ASSERT_TRUE(compositor.composite(out.view(), tracking(), out.bytes));
  EXPECT_EQ(out.bytes, expected.bytes);
}

TEST(CompositorState, RefusesAnOutputThatIsTooSmall) {
  Compositor compositor(testCamera(), plainSettings());
  const Image picture = noise(320, 240);
  std::vector<std::uint8_t> small(320 * 239 * 4, 3);
  EXPECT_FALSE(compositor.composite(picture.view(), tracking(), small));
  EXPECT_THAT(small, testing::Each(3));
}

TEST(CompositorState, FadesWithAgeFromHalfTheLimitToTheLimit) {
  Compositor compositor(testCamera(), plainSettings());
  compositor.setSurface(tissue());
  OverlayState state = tracking();
  const auto alphaAt = [&](float age) {
    state.age_ms = age;
    return static_cast<double>(layerOf(compositor, state).at(160, 140)[3]);
  };
  const double full = alphaAt(0);
  EXPECT_GT(full, 100);
  EXPECT_EQ(alphaAt(60), full);
  EXPECT_NEAR(alphaAt(90), full / 2, 1.5);
  EXPECT_NEAR(alphaAt(105), full / 4, 1.5);
  EXPECT_EQ(alphaAt(120), 0);
  EXPECT_EQ(alphaAt(5000), 0);
  EXPECT_EQ(alphaAt(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(CompositorState, DrawsNothingByADoubtfulPose) {
  Compositor compositor(testCamera(), plainSettings());
  compositor.setSurface(tissue());
  OverlayState doubtful = tracking(), broken = tracking();
  doubtful.confidence = 0.05f;
  broken.T_camera_world.t.x() = std::numeric_limits<double>::quiet_NaN();
  const Image good = layerOf(compositor, tracking());
  for (const OverlayState& state : {doubtful, broken}) {
    const Image layer = layerOf(compositor, state);
    EXPECT_EQ(layer.covered(0, kBelowMark, 320, 240), 0);
    EXPECT_GT(layer.covered(0, 0, 120, kBelowMark), 300) << "the mark says why";
    EXPECT_NE(0, std::memcmp(layer.at(0, 0), good.at(0, 0), 320 * kBelowMark * 4))
        << "and not that it is tracking";
  }
}

TEST(CompositorState, EveryStatusHasAMarkOfItsOwnAndOnlyTrackingAnOverlay) {
  Compositor compositor(testCamera(), plainSettings());
  compositor.setSurface(tissue());
  std::vector<std::vector<std::uint8_t>> seen;
  for (Status status :
       {Status::NoAr, Status::Initializing, Status::Lost, Status::Stale, Status::NoSignal}) {
    OverlayState state = tracking();
    state.status = status;
    const Image layer = layerOf(compositor, state);
    EXPECT_EQ(layer.covered(0, kBelowMark, 320, 240), 0);
    EXPECT_GT(layer.covered(0, 0, 160, kBelowMark), 300);
    // The symbol alone, by its shape: colours do not count.
    std::vector<std::uint8_t> shape;
    for (int y = 0; y < kBelowMark; ++y)
      for (int x = 0; x < 20; ++x) shape.push_back(layer.luminance(x, y) > 90);
    EXPECT_THAT(seen, testing::Not(testing::Contains(shape)));
    seen.push_back(shape);
  }
  OverlayState stale = tracking();
  stale.status = Status::Stale;
  OverlayState old = tracking();
  old.age_ms = 200;
  EXPECT_EQ(layerOf(compositor, old).bytes, layerOf(compositor, stale).bytes)
      << "an old pose is said to be stale";
}

TEST(CompositorState, ShowsAMessageBesideTheMark) {
  Compositor compositor(testCamera(), plainSettings());
  OverlayState state;
  state.status = Status::Lost;
  const int without = layerOf(compositor, state).covered(0, 0, 320, kBelowMark);
  state.message = "move back";
  EXPECT_GT(layerOf(compositor, state).covered(0, 0, 320, kBelowMark), without + 300);
}

TEST(CompositorState, APictureOfAnotherSizeGetsTheMarkAloneAndTheNextOneEverything) {
  Compositor compositor(testCamera(), plainSettings());
  compositor.setSurface(tissue());
  const Image before = layerOf(compositor, tracking());
  const Image picture = noise(400, 302);
  const Image out = compositeOf(compositor, picture, tracking());
  EXPECT_EQ(std::memcmp(out.at(0, 40), picture.at(0, 40), 400 * 262 * 4), 0);
  EXPECT_EQ(layerOf(compositor, tracking()).bytes, before.bytes);
}

TEST(CompositorState, TheSameFramesGiveTheSamePictures) {
  const auto run = [] {
    OverlaySettings settings;
    Compositor compositor(testCamera(), settings);
    std::vector<std::uint8_t> all;
    for (int i = 0; i < 6; ++i) {
      if (i % 3 == 0)
        compositor.setSurface(wall(-30, 30, -20, 30, 45, 70 + static_cast<float>(i), 24));
      OverlayState state = tracking();
      state.time_s = 0.1 * i;
      state.T_camera_world.t.x() = i;
      const Image out = compositeOf(compositor, noise(320, 240), state);
      all.insert(all.end(), out.bytes.begin(), out.bytes.end());
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

TEST(CompositorState, AllocatesNothingOnceWarm) {
#ifdef DEPTHSCOPE_SANITIZED
  GTEST_SKIP() << "the sanitizer owns the allocation functions";
#endif
  Compositor compositor(testCamera(), OverlaySettings{});
  compositor.setSurface(tissue());
  const Label label{1, 0, {0, 0, 50}, "a label longer than any small string optimization"};
  compositor.setLabels(std::span(&label, 1));
  const Image picture = noise(320, 240);
  Image out(320, 240);
  long before = 0;
  for (int i = 0; i < 20; ++i) {
    OverlayState state = tracking();
    state.time_s = i / 30.0;
    state.T_camera_world.t.x() = 0.1 * i;
    if (i == 5) before = allocationCount();
    ASSERT_TRUE(compositor.composite(picture.view(), state, out.bytes));
  }
  EXPECT_EQ(allocationCount(), before);
  const auto counted = std::make_unique<int>(1);
  EXPECT_EQ(allocationCount(), before + *counted) << "allocations are counted at all";
}

TEST(CompositorState, NamesAFontThatIsMissing) {
  OverlaySettings settings;
  settings.font_file = "/nowhere/none.ttf";
  EXPECT_THROW(Compositor(testCamera(), settings), InputError);
}

/// How much of the overlay is seen in the middle of pictures that follow on each other.
class CompositorFade : public testing::Test {
 protected:
  static OverlaySettings opaque() {
    OverlaySettings settings = plainSettings();
    settings.opacity = 1;
    return settings;
  }
  void SetUp() override { compositor.setSurface(wall(-30, 30, -25, 25, 50, 52, 8)); }
  int alphaAt(double time, Status status) {
    state.time_s = time;
    state.status = status;
    return layerOf(compositor, state).at(160, 120)[3];
  }
  Compositor compositor{testCamera(), opaque()};
  OverlayState state = tracking();
};

TEST_F(CompositorFade, WithoutAPoseTheOverlayGoesAtOnceAndItComesBackGently) {
  EXPECT_EQ(alphaAt(5.0, Status::Tracking), 255);
  EXPECT_EQ(alphaAt(5.033, Status::Lost), 0);
  EXPECT_NEAR(alphaAt(5.083, Status::Tracking), 64, 2);
  EXPECT_NEAR(alphaAt(5.133, Status::Tracking), 128, 2);
  EXPECT_EQ(alphaAt(5.233, Status::Tracking), 255);
  state.confidence = 0.2f;
  EXPECT_NEAR(alphaAt(5.266, Status::Tracking), 128, 2) << "doubt is shown at once";
}

TEST_F(CompositorFade, WithThePoseOfAMomentAgoItGoesGently) {
  EXPECT_EQ(alphaAt(5.0, Status::Tracking), 255);
  state.fading = true;
  EXPECT_NEAR(alphaAt(5.02, Status::Lost), 204, 2);
  EXPECT_NEAR(alphaAt(5.04, Status::Lost), 153, 2);
  state.age_ms = 108;  // of 120
  EXPECT_NEAR(alphaAt(5.06, Status::Lost), 51, 2) << "never stronger than the age lets it be";
  state.age_ms = 121;
  EXPECT_EQ(alphaAt(5.061, Status::Lost), 0);
  state.age_ms = 0;
  EXPECT_EQ(alphaAt(5.1, Status::Lost), 0) << "and it does not come back by itself";
}

TEST(FadeOut, KeepsTheLastPoseForAsLongAsItsAgeAllows) {
  FadeOut fade_out;
  OverlayState state = tracking();
  state.time_s = 7;
  state.age_ms = 20;
  state.map_id = 3;
  state.T_camera_world.t.x() = 4;
  fade_out.apply(state, 120);
  EXPECT_FALSE(state.fading);
  const auto later = [&](double seconds) {
    OverlayState lost;
    lost.status = Status::Lost;
    lost.time_s = 7 + seconds;
    fade_out.apply(lost, 120);
    return lost;
  };
  const OverlayState soon = later(0.05);
  EXPECT_TRUE(soon.fading);
  EXPECT_EQ(soon.status, Status::Lost);
  EXPECT_NEAR(soon.age_ms, 70, 1e-3);
  EXPECT_EQ(soon.T_camera_world.t.x(), 4);
  EXPECT_EQ(soon.map_id, 3u);
  EXPECT_FALSE(later(0.101).fading) << "too old";
  EXPECT_FALSE(later(0.05).fading) << "for good";
}

TEST(FadeOut, HasNothingToFadeWithoutATimeOrAPose) {
  FadeOut fade_out;
  OverlayState state;
  state.time_s = 1;
  fade_out.apply(state, 120);
  EXPECT_FALSE(state.fading);
  OverlayState timeless = tracking();
  fade_out.apply(timeless, 120);
  fade_out.apply(state, 120);
  EXPECT_FALSE(state.fading);
}

}  // namespace
}  // namespace depthscope::overlay
