#include <gmock/gmock.h>

#include <cmath>

#include "tests/overlay/overlay_scene.hpp"

namespace depthscope::overlay {
namespace {

OverlaySettings labelSettings() {
  OverlaySettings s = plainSettings();
  s.labels = true;
  return s;
}

Label label(const Eigen::Vector3f& anchor, std::uint32_t id = 1) {
  return {id, 0, anchor, "Vein"};
}

/// Centre of mass of what is nearly white within `r` pixels.
Eigen::Vector2d brightSpot(const Image& layer, const Eigen::Vector2d& around, int r) {
  Eigen::Vector2d sum(0, 0);
  int n = 0;
  for (int y = static_cast<int>(around.y()) - r; y <= around.y() + r; ++y)
    for (int x = static_cast<int>(around.x()) - r; x <= around.x() + r; ++x)
      if (layer.luminance(x, y) > 225) sum += Eigen::Vector2d(x, y), ++n;
  return n > 0 ? Eigen::Vector2d(sum / n) : Eigen::Vector2d(-1, -1);
}

TEST(CompositorLabels, TheDotSitsOnItsAnchorWhateverThePose) {
  CameraModel camera = testCamera();
  camera.k = {-0.2, 0.03, 0, 0, 0};
  Compositor compositor(camera, labelSettings());
  const Label one = label({6, 4, 60});
  compositor.setLabels(std::span(&one, 1));
  for (int i = 0; i < 12; ++i) {
    OverlayState state = tracking();
    state.T_camera_world =
        Pose{}.retract({0.01 * i, -0.015 * i, 0.02 * i}, {-1.3 * i, 0.4 * i, 0.7 * i});
    const Eigen::Vector2d expected =
        camera.project(state.T_camera_world * one.anchor.cast<double>());
    const Eigen::Vector2d found = brightSpot(layerOf(compositor, state), expected, 5);
    EXPECT_LT((found - expected).norm(), 0.6) << expected.transpose();
  }
}

TEST(CompositorLabels, OneBehindTheSurfaceIsDimmedAndItsDotHollow) {
  Compositor compositor(testCamera(), labelSettings());
  compositor.setSurface(wall(-40, 40, -30, 30, 50, 52, 8));
  const auto drawn = [&](float depth) {
    const Label one = label({0.2f * depth, 0.1f * depth, depth});
    compositor.setLabels(std::span(&one, 1));
    return layerOf(compositor, tracking());
  };
  const int x = static_cast<int>(std::lround(159.5 + 0.2 * 260)),
            y = static_cast<int>(std::lround(119.5 + 0.1 * 260));
  const Image open = drawn(51), just_behind = drawn(51.8f), in_front = drawn(40),
              hidden = drawn(80);
  for (const Image* image : {&open, &just_behind, &in_front}) {
    EXPECT_GT(image->luminance(x, y), 225);
    EXPECT_GT(image->at(x, y)[3], 240);
  }
  EXPECT_LT(hidden.at(x, y)[3], 200);
  const auto whites = [&](const Image& image) {
    int n = 0;
    for (int py = kBelowMark; py < 240; ++py)
      for (int px = 0; px < 320; ++px) n += image.luminance(px, py) > 225;
    return n;
  };
  EXPECT_GT(whites(open), 40);
  EXPECT_LT(whites(hidden), 5) << "the text is dimmed";
  EXPECT_NE(hidden.bytes, drawn(51).bytes);
}

TEST(CompositorLabels, ATextThatTurnsSidesCanBeReadAllTheWhile) {
  Compositor compositor(testCamera(), labelSettings());
  const Label one = label({0, 0, 50});
  compositor.setLabels(std::span(&one, 1));
  OverlayState state = tracking();
  state.time_s = 1;
  const auto brightness = [&] {
    const Image layer = layerOf(compositor, state);
    double sum = 0;
    for (int y = kBelowMark; y < 240; ++y)
      for (int x = 0; x < 320; ++x) sum += layer.luminance(x, y);
    return sum;
  };
  const double in_place = brightness();
  for (int i = 1; i <= 50; ++i) {  // 2.6 pixels each, to 30 from the right edge
    state.time_s = 1 + i / 30.0;
    state.T_camera_world.t.x() = 0.5 * i;
    EXPECT_NEAR(brightness(), in_place, 0.25 * in_place) << "picture " << i;
  }
}

TEST(CompositorLabels, WhatIsNotInViewIsNotDrawn) {
  Compositor compositor(testCamera(), labelSettings());
  const Label all[] = {label({0, 0, -50}, 1),
                       label({500, 0, 50}, 2),
                       label({std::nanf(""), 0, 50}, 3),
                       {4, 9, {0, 0, 50}, "of another map"}};
  compositor.setLabels(all);
  EXPECT_EQ(layerOf(compositor, tracking()).covered(0, kBelowMark, 320, 240), 0);
}

TEST(CompositorLabels, MoreThanThereIsMemoryForAreLeftOut) {
  OverlaySettings settings = labelSettings();
  settings.max_labels = 2;
  Compositor compositor(testCamera(), settings);
  const Label all[] = {label({-9, 0, 50}, 1), label({0, 0, 50}, 2), label({9, 0, 50}, 3)};
  compositor.setLabels(all);
  const Image layer = layerOf(compositor, tracking());
  EXPECT_GT(layer.luminance(160, 120), 225);
  EXPECT_EQ(layer.at(206, 120)[3], 0);
}

TEST(CompositorLabels, TheCornerPictureShowsMeshAndAnchors) {
  OverlaySettings settings = plainSettings();
  settings.inset = true;
  Compositor compositor(testCamera(), settings);
  compositor.setSurface(wall(-40, 40, -30, 30, 50, 70, 20));
  const Image without = layerOf(compositor, tracking());
  // The panel is dark and nearly opaque; the mesh in it is coloured.
  int colored = 0;
  for (int y = 6; y < 64; ++y)
    for (int x = 236; x < 314; ++x) {
      EXPECT_GT(without.at(x, y)[3], 180);
      colored += without.luminance(x, y) > 60;
    }
  EXPECT_GT(colored, 300);
  EXPECT_LT(colored, 60 * 80 * 2 / 3);
  settings.labels = true;
  compositor.setSettings(settings);
  const Label one = label({0, 0, 60});
  compositor.setLabels(std::span(&one, 1));
  const Image with = layerOf(compositor, tracking());
  int changed = 0;
  for (int y = 6; y < 64; ++y)
    for (int x = 236; x < 314; ++x) changed += with.luminance(x, y) > without.luminance(x, y) + 40;
  EXPECT_GT(changed, 4);
  EXPECT_LT(changed, 60);
}

}  // namespace
}  // namespace depthscope::overlay
