#include "platform/ipc/wire.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "platform/utf8.hpp"

namespace depthscope::platform {
namespace {

PoseEstimate somePose() {
  PoseEstimate e;
  e.frame = 12;
  e.timestamp_s = 0.4;
  e.state = TrackingState::Tracking;
  e.T_camera_world = Pose().retract({0.3, -0.2, 0.9}, {1, 2, 3});
  e.confidence = 0.75f;
  e.map_id = 3;
  e.inliers = 250;
  return e;
}

TEST(Wire, APoseComesBackAsItWas) {
  PoseEstimate back;
  ASSERT_TRUE(decodePose(encodePose(somePose()), back));
  EXPECT_EQ(back.frame, 12);
  EXPECT_EQ(back.state, TrackingState::Tracking);
  EXPECT_EQ(back.T_camera_world.R, somePose().T_camera_world.R);
  EXPECT_EQ(back.T_camera_world.t, somePose().T_camera_world.t);
  EXPECT_EQ(back.confidence, 0.75f);
  EXPECT_EQ(back.map_id, 3u);
  EXPECT_EQ(back.inliers, 250);
}

TEST(Wire, RefusesPosesThatNoTrackerGives) {
  const auto refused = [](auto&& spoil) {
    WirePose wire = encodePose(somePose());
    spoil(wire);
    PoseEstimate out;
    out.frame = -77;
    const bool decoded = decodePose(wire, out);
    EXPECT_TRUE(decoded || out.frame == -77) << "output touched";
    return !decoded;
  };
  EXPECT_TRUE(refused([](WirePose& w) { w.state = 3; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.state = 0xFFFFFFFF; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.frame = -1; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.timestamp_s = NAN; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.confidence = 1.5f; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.confidence = NAN; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.inliers = -1; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.t[1] = INFINITY; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.R[4] = NAN; }));
  EXPECT_TRUE(refused([](WirePose& w) { w.R[0] *= 1.01; }));
  EXPECT_TRUE(refused([](WirePose& w) {
    for (double& r : w.R) r = -r;
  }));  // a mirror
  EXPECT_FALSE(refused([](WirePose&) {}));
}

TEST(Wire, APoseThatIsNotTrackedNeedsNoRotation) {
  WirePose wire{};
  wire.state = static_cast<std::uint32_t>(TrackingState::Lost);
  PoseEstimate out;
  EXPECT_TRUE(decodePose(wire, out));
  EXPECT_EQ(out.state, TrackingState::Lost);
}

TEST(Wire, LabelsComeBackAsTheyWere) {
  const std::vector<Label> labels{{1, 2, {1, 2, 3}, "vessel"},
                                  {9, 2, {-1, 0, 4}, "Gef\xC3\xA4\xC3\x9F"}};
  std::vector<Label> back;
  ASSERT_TRUE(decodeLabels(encodeLabels(labels), back));
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[1].id, 9u);
  EXPECT_EQ(back[1].anchor, Eigen::Vector3f(-1, 0, 4));
  EXPECT_EQ(back[1].text, labels[1].text);
}

TEST(Wire, LongLabelsAreCutBetweenCharactersAndManyAtTheCapacity) {
  std::string text(max_label_bytes - 2, 'a');
  text += "\xC3\xA4tail";
  const std::vector<Label> labels(max_wire_labels + 5, Label{1, 1, {0, 0, 1}, text});
  std::vector<Label> back;
  ASSERT_TRUE(decodeLabels(encodeLabels(labels), back));
  EXPECT_EQ(back.size(), max_wire_labels);
  EXPECT_EQ(back[0].text, std::string(max_label_bytes - 2, 'a'));
}

TEST(Wire, RefusesUnsoundLabels) {
  const auto refused = [](auto&& spoil) {
    const std::vector<Label> labels{{1, 2, {1, 2, 3}, "vessel"}};
    WireLabels wire = encodeLabels(labels);
    spoil(wire);
    std::vector<Label> out(1);
    const bool decoded = decodeLabels(wire, out);
    EXPECT_TRUE(decoded || out[0].text.empty()) << "output touched";
    return !decoded;
  };
  EXPECT_TRUE(refused([](WireLabels& w) { w.count = max_wire_labels + 1; }));
  EXPECT_TRUE(refused([](WireLabels& w) { w.labels[0].anchor[2] = NAN; }));
  EXPECT_TRUE(refused([](WireLabels& w) { std::memset(w.labels[0].text, 'x', max_label_bytes); }));
  EXPECT_TRUE(refused([](WireLabels& w) { w.labels[0].text[0] = 0; }));
  EXPECT_TRUE(refused([](WireLabels& w) { w.labels[0].text[0] = '\x1B'; }));
  EXPECT_TRUE(refused([](WireLabels& w) { w.labels[0].text[0] = '\xFF'; }));
  EXPECT_FALSE(refused([](WireLabels&) {}));
}

TEST(Wire, CommandsComeBackAsTheyWere) {
  WireCommand::Kind kind;
  LabelRequest label;
  ASSERT_TRUE(decodeCommand(encodeCommand(WireCommand::Reset), kind, label));
  EXPECT_EQ(kind, WireCommand::Reset);
  ASSERT_TRUE(decodeCommand(encodeCommand(WireCommand::Label, {"here", {12, 34.5}}), kind, label));
  EXPECT_EQ(label.text, "here");
  EXPECT_EQ(label.pixel, Eigen::Vector2d(12, 34.5));
  EXPECT_FALSE(decodeCommand(encodeCommand(WireCommand::Label, {"", {1, 1}}), kind, label));
  EXPECT_FALSE(decodeCommand(WireCommand{}, kind, label));
  WireCommand unknown{};
  unknown.kind = 5;
  EXPECT_FALSE(decodeCommand(unknown, kind, label));
  WireCommand period = encodeSurfacePeriod(2.5);
  ASSERT_TRUE(decodeCommand(period, kind, label));
  EXPECT_EQ(kind, WireCommand::SurfacePeriod);
  EXPECT_EQ(period.x, 2.5f);
  for (float impossible : {-1.0f, std::numeric_limits<float>::infinity()}) {
    period.x = impossible;
    EXPECT_FALSE(decodeCommand(period, kind, label));
  }
}

TEST(Wire, AStatusWithImpossibleNumbersIsNotShown) {
  WireArStatus status{};
  EXPECT_TRUE(plausible(status));
  status.keyframes = -1;
  EXPECT_FALSE(plausible(status));
  status = {};
  status.track_p50_ms = NAN;
  EXPECT_FALSE(plausible(status));
  status = {};
  status.slam_bytes = -1;
  EXPECT_FALSE(plausible(status));
}

template <class T>
T garbage(std::mt19937_64& random) {
  T value;
  auto* bytes = reinterpret_cast<unsigned char*>(&value);
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<unsigned char>(random());
  return value;
}

TEST(Wire, DecodersSurviveGarbage) {
  std::mt19937_64 random(1);
  PoseEstimate pose;
  std::vector<Label> labels;
  WireCommand::Kind kind;
  LabelRequest label;
  for (int i = 0; i < 20000; ++i) {
    WirePose wire = garbage<WirePose>(random);
    if (i % 2 == 0) wire.state %= 3;
    if (decodePose(wire, pose)) {
      EXPECT_TRUE(pose.T_camera_world.allFinite());
    }
    WireLabels wire_labels = garbage<WireLabels>(random);
    wire_labels.count %= max_wire_labels + 2;
    if (decodeLabels(wire_labels, labels)) {
      for (const Label& l : labels) EXPECT_TRUE(isPrintableUtf8(l.text) && l.anchor.allFinite());
    }
    WireCommand command = garbage<WireCommand>(random);
    command.kind %= 5;
    decodeCommand(command, kind, label);
    plausible(garbage<WireArStatus>(random));
  }
}

TEST(Wire, AViewComesBackAsItWasAndOneWithNumbersThatAreNoneIsRefused) {
  ViewOutline sent, got;
  sent.spans[3] = {12.5f, 300};
  sent.spans[4] = {0, 0};
  ASSERT_TRUE(decodeView(encodeView(sent), got));
  EXPECT_EQ(got, sent);
  for (float bad :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    WireView wire = encodeView(ViewOutline());
    wire.ends[100][1] = bad;
    EXPECT_FALSE(decodeView(wire, got));
    EXPECT_EQ(got, sent);
  }
}

}  // namespace
}  // namespace depthscope::platform
