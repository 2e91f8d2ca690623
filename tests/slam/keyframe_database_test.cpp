#include "slam/keyframe_database.hpp"

#include <gtest/gtest.h>

#include "slam/vocabulary_trainer.hpp"
#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_map.hpp"
#include "types/allocation_scope.hpp"
#include "types/error.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// Cameras far apart, so that neighbours share some of what they see and others nothing.
struct Places {
  World world{1500, 21};
  std::vector<Pose> poses = sidewaysPoses(6, 1.0);
  SlamSettings settings = smallSettings();
  MappedWorld mapped{settings, world, poses};
  KeyframeDatabase database{settings, vocabularyOf(world)};
  PlaceQuery query{settings};

  Places() {
    for (const KeyframeId k : mapped.keyframes) database.add(mapped.map, k);
  }
  static Vocabulary vocabularyOf(const World& world) {
    std::vector<std::vector<Descriptor>> pictures(world.descriptors.size() / 10);
    for (std::size_t i = 0; i < world.descriptors.size(); ++i)
      pictures[i % pictures.size()].push_back(world.descriptors[i]);
    return trainVocabulary(pictures, {.branching = 10, .levels = 3});
  }
};

TEST(KeyframeDatabase, RanksTheSamePlaceFirst) {
  Places p;
  std::vector<int> ids;
  for (std::size_t i = 0; i < p.poses.size(); ++i) {
    const FeatureSet again = p.world.view(p.poses[i], ids, 0.5);
    const auto places = p.database.find(p.mapped.map, again.descriptors, p.query);
    ASSERT_FALSE(places.empty());
    EXPECT_EQ(places.front().keyframe, p.mapped.keyframes[i]);
    EXPECT_GT(places.front().score, 0.9f);
    for (std::size_t j = 1; j < places.size(); ++j) EXPECT_LE(places[j].score, places[j - 1].score);
  }
}

TEST(KeyframeDatabase, ScoresAreTheSimilarityOfTheBags) {
  Places p;
  std::vector<WordWeight> a, b;
  const auto& map = p.mapped.map;
  const KeyframeId ka = p.mapped.keyframes[0], kb = p.mapped.keyframes[1];
  p.database.vocabulary().describe(map.keyframe(ka).features.descriptors, a);
  p.database.vocabulary().describe(map.keyframe(kb).features.descriptors, b);
  ASSERT_GT(similarity(a, b), 0.05);
  EXPECT_NEAR(p.database.score(ka, kb, p.query), similarity(a, b), 1e-6);
  for (const PlaceMatch& m : p.database.find(map, ka, p.query)) {
    EXPECT_NE(m.keyframe, ka);
    if (m.keyframe == kb) {
      EXPECT_NEAR(m.score, similarity(a, b), 1e-5);
    }
  }
}

TEST(KeyframeDatabase, ForgetsAKeyframeThatLeftTheMap) {
  Places p;
  const KeyframeId gone = p.mapped.keyframes[2];
  p.mapped.map.removeKeyframe(gone);
  std::vector<int> ids;
  const FeatureSet picture = p.world.view(p.poses[2], ids);
  for (const PlaceMatch& m : p.database.find(p.mapped.map, picture.descriptors, p.query))
    EXPECT_NE(m.keyframe, gone);

  // Its slot goes to another, whose words take the place of the old ones.
  const FeatureSet other = p.world.view(p.poses[5], ids);
  const KeyframeId reused = p.mapped.map.addKeyframe(other, p.poses[5], 9, 9);
  ASSERT_EQ(reused, gone);
  EXPECT_FALSE(p.database.contains(p.mapped.map, reused));
  p.database.add(p.mapped.map, reused);
  EXPECT_EQ(p.database.find(p.mapped.map, other.descriptors, p.query).front().keyframe, reused);
  for (const PlaceMatch& m : p.database.find(p.mapped.map, picture.descriptors, p.query))
    if (m.keyframe == reused) {
      EXPECT_LT(m.score, 0.9f);
    }
}

TEST(KeyframeDatabase, RefusesAVocabularyThatItHasNoRoomFor) {
  SlamSettings settings = smallSettings();
  const Vocabulary vocabulary = Vocabulary::builtIn();
  settings.capacity.vocabulary_words = vocabulary.words();
  EXPECT_NO_THROW(KeyframeDatabase(settings, vocabulary));
  settings.capacity.vocabulary_words = vocabulary.words() - 1;
  EXPECT_THROW(KeyframeDatabase(settings, vocabulary), InputError);
}

TEST(KeyframeDatabase, AllocatesNothingOnceItIsBuilt) {
  Places p;
  takeAllocationCount();
  const AllocationScope counted;
  for (const KeyframeId k : p.mapped.keyframes) p.database.add(p.mapped.map, k);
  p.database.find(p.mapped.map, p.mapped.keyframes[0], p.query);
  p.database.find(p.mapped.map, p.mapped.map.keyframe(p.mapped.keyframes[1]).features.descriptors,
                  p.query);
  EXPECT_EQ(takeAllocationCount(), 0);
}

}  // namespace
}  // namespace depthscope::slam
