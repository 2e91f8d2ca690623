#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "slam/local_bundle.hpp"
#include "slam/map_culler.hpp"
#include "slam/point_creator.hpp"
#include "slam/point_fuser.hpp"
#include "slam/relocalizer.hpp"
#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// Over the points that keyframe `seen_by` sees.
double largestError(const MappedWorld& m, const World& world, KeyframeId seen_by) {
  double worst = 0;
  for (std::size_t i = 0; i < world.points.size(); ++i)
    if (m.point_of[i] != kNone && m.map.isObservedBy(m.point_of[i], seen_by))
      worst = std::max(worst, (m.map.point(m.point_of[i]).position - world.points[i]).norm());
  return worst;
}

TEST(PointCreator, TriangulatesWhatNoPointExplainsYet) {
  const World world(300);
  MappedWorld m(smallSettings(), world, sidewaysPoses(3, 0.5));
  int removed = 0;
  for (std::size_t i = 0; i < world.points.size(); i += 3)
    if (m.point_of[i] != kNone) m.map.removePoint(m.point_of[i]), ++removed;
  PointCreator creator(smallSettings(), m.map);
  std::vector<PointRef> created;
  created.reserve(1000);
  creator.create(m.keyframes[1], std::vector<KeyframeId>{m.keyframes[0], m.keyframes[2]}, created);
  EXPECT_GT(static_cast<int>(created.size()), removed * 9 / 10);
  for (const PointRef& r : created) {
    double nearest = 1e9;
    for (const auto& p : world.points)
      nearest = std::min(nearest, (p - m.map.point(r.id).position).norm());
    EXPECT_LT(nearest, 1e-3);
  }
}

TEST(PointCreator, MakesNothingWithoutBaseline) {
  const World world(300);
  MappedWorld m(smallSettings(), world, sidewaysPoses(3, 0.001));
  for (std::size_t i = 0; i < world.points.size(); i += 3)
    if (m.point_of[i] != kNone) m.map.removePoint(m.point_of[i]);
  PointCreator creator(smallSettings(), m.map);
  std::vector<PointRef> created;
  created.reserve(1000);
  creator.create(m.keyframes[1], std::vector<KeyframeId>{m.keyframes[0], m.keyframes[2]}, created);
  EXPECT_TRUE(created.empty());
}

int createdAcross(const World& world, double baseline) {
  MappedWorld m(smallSettings(), world, sidewaysPoses(2, baseline));
  for (std::size_t i = 0; i < world.points.size(); i += 3)
    if (m.point_of[i] != kNone) m.map.removePoint(m.point_of[i]);
  PointCreator creator(smallSettings(), m.map);
  std::vector<PointRef> created;
  created.reserve(1000);
  creator.create(m.keyframes[1], std::vector<KeyframeId>{m.keyframes[0]}, created);
  return static_cast<int>(created.size());
}

// Points lie 4 to 8 units away: 0.57 degrees are 0.04 units across the nearest, 0.08 across the
// farthest, and 0.8 degrees 0.084 across those in the middle.
TEST(PointCreator, DoesNotTakeTheNearOnesAloneWhereTheBaselineIsShort) {
  const World world(300);
  EXPECT_EQ(createdAcross(world, 0.07), 0);
  const int all = createdAcross(world, 0.5);
  EXPECT_GT(all, 50);
  EXPECT_GT(createdAcross(world, 0.11), all * 9 / 10);
}

TEST(PointFuser, MakesDoublesOne) {
  const World world(200);
  MappedWorld m(smallSettings(), world, sidewaysPoses(4));
  // Point 0 twice: keyframes 0 and 1 see one of them, 2 and 3 the other.
  const PointId p = m.point_of[10];
  ASSERT_EQ(m.map.observations(p).size(), 4u);
  const Observation c = m.map.observations(p)[2], d = m.map.observations(p)[3];
  m.map.unobserve(p, c.keyframe);
  m.map.unobserve(p, d.keyframe);
  const PointId twin = m.map.addPoint(m.map.point(p).position + Eigen::Vector3d(1e-3, 0, 0), 1);
  m.map.observe(twin, c.keyframe, c.feature);
  m.map.observe(twin, d.keyframe, d.feature);
  m.map.refreshPoint(twin);
  const int before = m.map.pointCount();
  PointFuser fuser(smallSettings(), m.map);
  fuser.fuse(m.keyframes[3],
             std::vector<KeyframeId>{m.keyframes[0], m.keyframes[1], m.keyframes[2]});
  EXPECT_EQ(m.map.pointCount(), before - 1);
  EXPECT_EQ(
      m.map.keyframe(c.keyframe).points[c.feature],
      m.map.keyframe(m.keyframes[0])
          .points[m.map.observations(m.map.keyframe(c.keyframe).points[c.feature])[0].feature]);
}

TEST(LocalBundle, BringsADisturbedMapBack) {
  const World world(300);
  const auto poses = sidewaysPoses(6);
  MappedWorld m(smallSettings(), world, poses);
  std::mt19937 rng(5);
  const auto shake = [&](double size) {
    return Eigen::Vector3d(uniform(rng, -size, size), uniform(rng, -size, size),
                           uniform(rng, -size, size));
  };
  for (PointId p = 0; p < m.map.pointEnd(); ++p) m.map.point(p).position += shake(0.05);
  std::vector<KeyframeId> window(m.keyframes.begin() + 2, m.keyframes.end());
  for (const KeyframeId k : window)
    m.map.keyframe(k).T_camera_world =
        m.map.keyframe(k).T_camera_world.retract(shake(0.01), shake(0.01));
  BundleAdjuster adjuster(12, 1000, 12000);
  LocalBundle bundle(smallSettings(), m.map, adjuster);
  bundle.adjust(window, 30, nullptr);
  EXPECT_LT(largestError(m, world, m.keyframes[3]),
            2e-3);  // features are stored in single precision
  for (std::size_t i = 2; i < poses.size(); ++i)
    EXPECT_LT((m.map.keyframe(m.keyframes[i]).T_camera_world.t - poses[i].t).norm(), 1e-3);
}

TEST(LocalBundle, IsPulledLessByPointsThatMoved) {
  const auto pulled = [](float residual) {
    const World world(300);
    const auto poses = sidewaysPoses(6);
    MappedWorld m(smallSettings(), world, poses);
    // In one picture a third of the points have moved to the right.
    Keyframe& moved = m.map.keyframe(m.keyframes[4]);
    for (PointId p = 0; p < m.map.pointEnd(); ++p) m.map.point(p).residual = 0.8f;
    for (int f = 0; f < moved.features.size(); f += 3) {
      if (moved.points[f] == kNone) continue;
      moved.features.keypoints[f].ux += 2;
      m.map.point(moved.points[f]).residual = residual;
    }
    BundleAdjuster adjuster(12, 1000, 12000);
    LocalBundle bundle(smallSettings(), m.map, adjuster);
    bundle.adjust(std::vector<KeyframeId>(m.keyframes.begin() + 2, m.keyframes.end()), 10, nullptr);
    return (moved.T_camera_world.t - poses[4].t).norm();
  };
  const double trusted = pulled(0.8f);
  EXPECT_GT(trusted, 1e-3);
  EXPECT_LT(pulled(16.f), 0.3 * trusted);
}

TEST(LocalBundle, DropsAWrongObservationAndKeepsThePoint) {
  const World world(300);
  MappedWorld m(smallSettings(), world, sidewaysPoses(6));
  const PointId p = m.point_of[20];
  const Observation wrong = m.map.observations(p)[4];
  m.map.keyframe(wrong.keyframe).features.keypoints[wrong.feature].ux += 25;
  const std::size_t before = m.map.observations(p).size();
  BundleAdjuster adjuster(12, 1000, 12000);
  LocalBundle bundle(smallSettings(), m.map, adjuster);
  bundle.adjust(std::vector<KeyframeId>(m.keyframes.begin() + 2, m.keyframes.end()), 10, nullptr);
  EXPECT_EQ(m.map.observations(p).size(), before - 1);
  EXPECT_FALSE(m.map.isObservedBy(p, wrong.keyframe));
  EXPECT_LT((m.map.point(p).position - world.points[20]).norm(), 1e-2);
}

TEST(MapCuller, DropsAKeyframeThatAddsNothingAndKeepsItsFrames) {
  const World world(200);
  MappedWorld m(smallSettings(), world, sidewaysPoses(6, 0.02));
  FrameRecords records{Trajectory(10), ViewKeeper(10, 1)};
  const Pose T_camera_keyframe = cameraAt({0.01, 0.02, 0}, {0, 0.01, 0});
  AnchoredPose frame;
  frame.frame = 42;
  frame.anchor(m.map, m.keyframes[2], T_camera_keyframe);
  records.trajectory.add(frame);
  ASSERT_TRUE(records.views.offer(m.map, frame, 1, true));
  const Eigen::Vector3d before =
      records.trajectory.corrected(m.map, m.map.activeId()).front().T_world_camera.t;
  MapCuller culler(smallSettings(), m.map, records);
  culler.cullKeyframes(std::vector<KeyframeId>{m.keyframes[2]});
  EXPECT_FALSE(m.map.keyframe(m.keyframes[2]).alive);
  const Eigen::Vector3d after =
      records.trajectory.corrected(m.map, m.map.activeId()).front().T_world_camera.t;
  EXPECT_LT((after - before).norm(), 1e-7);
  const AnchoredPose& view = records.views.poses().front();
  EXPECT_LT((view.T_camera_world(m.map).inverse().t - before).norm(), 1e-7);
}

TEST(MapCuller, KeepsAKeyframeThatAloneSeesItsPoints) {
  const World world(200);
  MappedWorld m(smallSettings(), world, sidewaysPoses(4, 1.5));
  FrameRecords records{Trajectory(0), ViewKeeper(0, 1)};
  MapCuller culler(smallSettings(), m.map, records);
  culler.cullKeyframes(std::vector<KeyframeId>{m.keyframes[0]});
  EXPECT_TRUE(m.map.keyframe(m.keyframes[0]).alive);
}

TEST(MapCuller, MakesRoomWhenEverySlotIsTaken) {
  const World world(200);
  const SlamSettings settings = smallSettings();
  MappedWorld m(settings, world, sidewaysPoses(settings.capacity.keyframes, 0.05));
  ASSERT_EQ(m.map.freeKeyframes(), 0);
  FrameRecords records{Trajectory(0), ViewKeeper(0, 1)};
  MapCuller culler(settings, m.map, records);
  culler.makeRoom(2);
  EXPECT_EQ(m.map.freeKeyframes(), 2);
}

TEST(MapCuller, OfEquallyRedundantKeyframesTheOldAndFarOneGoesFirst) {
  const World world(200);
  MappedWorld m(smallSettings(), world, sidewaysPoses(6, 0.02));
  const SlamSettings settings = smallSettings();
  FrameRecords records{Trajectory(0), ViewKeeper(0, 1)};
  MapCuller culler(settings, m.map, records);
  while (m.map.keyframeCount() > 5) culler.makeRoom(m.map.freeKeyframes() + 1);
  EXPECT_FALSE(m.map.keyframe(m.keyframes.front()).alive);
  EXPECT_TRUE(m.map.keyframe(m.keyframes.back()).alive);
}

TEST(MapCuller, PrefersAKeyframeWithoutPointsOfItsOwnToAnOlderOneThatHasSome) {
  const World world(400);
  std::vector<Pose> poses;
  for (const double x : {0.0, 0.02}) poses.push_back(cameraAt({x, 0, 0}, {0, 0, 0}));
  for (int i = 0; i < 5; ++i) poses.push_back(cameraAt({3 + 0.02 * i, 0, 0}, {0, 0, 0}));
  MappedWorld m(smallSettings(), world, poses);
  FrameRecords records{Trajectory(0), ViewKeeper(0, 1)};
  MapCuller culler(smallSettings(), m.map, records);
  culler.makeRoom(m.map.freeKeyframes() + 1);
  EXPECT_TRUE(m.map.keyframe(m.keyframes[0]).alive);
  EXPECT_TRUE(m.map.keyframe(m.keyframes[1]).alive);
  EXPECT_EQ(m.map.keyframeCount(), 6);
}

TEST(MapCuller, DropsARecentPointThatIsSeldomFound) {
  const World world(100);
  MappedWorld m(smallSettings(), world, sidewaysPoses(4));
  std::vector<PointRef> recent{m.map.ref(m.point_of[0]), m.map.ref(m.point_of[1])};
  m.map.point(recent[0].id).visible = 20;
  m.map.point(recent[0].id).found = 2;
  m.map.point(recent[1].id).visible = 20;
  m.map.point(recent[1].id).found = 15;
  FrameRecords records{Trajectory(0), ViewKeeper(0, 1)};
  MapCuller culler(smallSettings(), m.map, records);
  culler.cullRecentPoints(recent, 1);
  EXPECT_EQ(m.map.resolve(recent[0]), recent[0].id);  // the survivor moved to the front
  EXPECT_EQ(recent.size(), 1u);
  EXPECT_EQ(recent[0].id, m.point_of[1]);
  EXPECT_FALSE(m.map.point(m.point_of[0]).alive);
}

KeyframeDatabase databaseOf(const MappedWorld& m) {
  KeyframeDatabase database(smallSettings(), Vocabulary::builtIn());
  for (const KeyframeId k : m.keyframes) database.add(m.map, k);
  return database;
}

TEST(Relocalizer, FindsTheCameraFromDescriptorsAlone) {
  const World world(300);
  MappedWorld m(smallSettings(), world, sidewaysPoses(5));
  const Pose truth = cameraAt({0.7, 0.1, 0.3}, {0.02, -0.05, 0.1});
  std::vector<int> ids;
  const FeatureSet features = world.view(truth, ids, 0.5);
  const KeyframeDatabase database = databaseOf(m);
  Relocalizer relocalizer(smallSettings(), testCamera(), database);
  Pose found;
  std::vector<PointRef> points(400);
  ASSERT_TRUE(relocalizer.relocalize(m.map, features, 8, found, points));
  EXPECT_LT((found.inverse().t - truth.inverse().t).norm(), 0.02);
  EXPECT_LT(rotationError(found, truth), 0.005);
}

TEST(Relocalizer, RefusesAPlaceThatIsNotInTheMap) {
  const World world(300), elsewhere(300, 77);
  MappedWorld m(smallSettings(), world, sidewaysPoses(5));
  std::vector<int> ids;
  const FeatureSet features = elsewhere.view(Pose{}, ids);
  const KeyframeDatabase database = databaseOf(m);
  Relocalizer relocalizer(smallSettings(), testCamera(), database);
  Pose found;
  std::vector<PointRef> points(400);
  EXPECT_FALSE(relocalizer.relocalize(m.map, features, 8, found, points));
}

/// However far down the ranks the turn has come with pictures of nothing.
TEST(Relocalizer, AsksTheMostSimilarKeyframeInEveryPicture) {
  World world(300);
  std::mt19937 rng(5);
  for (int i = 0; i < 300; ++i) {
    world.points.push_back(-world.points[i]);
    world.descriptors.push_back(randomDescriptor(rng));
  }
  std::vector<Pose> poses = sidewaysPoses(3);
  for (int i = 0; i < 9; ++i) poses.push_back(cameraAt({0.1 * i, 0, 0}, {0, std::numbers::pi, 0}));
  MappedWorld m(smallSettings(), world, poses);
  const KeyframeDatabase database = databaseOf(m);
  Relocalizer relocalizer(smallSettings(), testCamera(), database);
  Pose found;
  std::vector<PointRef> points(400);
  std::vector<int> ids;
  const FeatureSet nothing = World(300, 77).view(Pose{}, ids);
  const FeatureSet known = world.view(poses[1], ids, 0.5);
  for (int i = 0; i < 9; ++i) {
    ids.clear();
    EXPECT_FALSE(relocalizer.relocalize(m.map, nothing, 3, found, points)) << i;
    EXPECT_TRUE(relocalizer.relocalize(m.map, known, 1, found, points)) << i;
  }
}

}  // namespace
}  // namespace depthscope::slam
