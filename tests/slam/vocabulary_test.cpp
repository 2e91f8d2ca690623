#include "slam/vocabulary.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "slam/vocabulary_trainer.hpp"
#include "tests/slam/synthetic_map.hpp"
#include "types/error.hpp"

namespace depthscope::slam {
namespace {

using testing::randomDescriptor;

Descriptor disturbed(Descriptor d, int bits, std::mt19937& rng) {
  for (int i = 0; i < bits; ++i) d.bits[rng() % 4] ^= std::uint64_t{1} << (rng() % 64);
  return d;
}

/// Pictures that each show `per_picture` of `kinds` kinds of patches, with noise.
std::vector<std::vector<Descriptor>> picturesOf(const std::vector<Descriptor>& kinds, int pictures,
                                                int per_picture) {
  std::mt19937 rng(8);
  std::vector<std::vector<Descriptor>> out(pictures);
  for (auto& picture : out)
    for (int i = 0; i < per_picture; ++i)
      picture.push_back(disturbed(kinds[rng() % kinds.size()], 12, rng));
  return out;
}

std::vector<Descriptor> someKinds(int n) {
  std::mt19937 rng(2);
  std::vector<Descriptor> kinds;
  for (int i = 0; i < n; ++i) kinds.push_back(randomDescriptor(rng));
  return kinds;
}

Vocabulary smallVocabulary() {
  return trainVocabulary(picturesOf(someKinds(60), 40, 50), {.branching = 8, .levels = 3});
}

class VocabularyFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            (std::string("depthscope_") +
             ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".voc");
    smallVocabulary().save(path_);
  }
  void TearDown() override { std::filesystem::remove(path_); }

  void overwrite(std::streamoff at, char value) {
    std::fstream f(path_, std::ios::in | std::ios::out | std::ios::binary);
    f.seekp(at);
    f.put(value);
  }
  std::string refusal() const {
    try {
      Vocabulary::load(path_);
    } catch (const InputError& e) {
      return e.what();
    }
    return "loaded";
  }
  std::filesystem::path path_;
};

TEST(Vocabulary, GivesNoisyViewsOfOnePatchOneWord) {
  const auto kinds = someKinds(60);
  const Vocabulary vocabulary = smallVocabulary();
  std::mt19937 rng(4);
  int same = 0, chance = 0;
  for (const Descriptor& d : kinds) {
    same += vocabulary.wordOf(disturbed(d, 12, rng)) == vocabulary.wordOf(disturbed(d, 12, rng));
    chance += vocabulary.wordOf(d) == vocabulary.wordOf(kinds[rng() % kinds.size()]);
  }
  EXPECT_GT(same, 50);
  EXPECT_LT(chance, 10);
}

TEST(Vocabulary, WeighsAWordByHowFewPicturesShowIt) {
  const auto kinds = someKinds(20);
  auto pictures = picturesOf(std::vector<Descriptor>(kinds.begin() + 2, kinds.end()), 30, 40);
  for (auto& picture : pictures) picture.push_back(kinds[0]);    // in each
  for (int i = 0; i < 20; ++i) pictures[3].push_back(kinds[1]);  // in one
  const Vocabulary vocabulary = trainVocabulary(pictures, {.branching = 5, .levels = 4});
  EXPECT_FLOAT_EQ(vocabulary.leafOf(kinds[0]).weight, 0);
  EXPECT_GT(vocabulary.leafOf(kinds[1]).weight, 2);
}

TEST(Vocabulary, BagsHaveSumOneAndAscendingWords) {
  const Vocabulary vocabulary = smallVocabulary();
  std::vector<WordWeight> bag;
  vocabulary.describe(picturesOf(someKinds(60), 1, 30).front(), bag);
  double sum = 0;
  for (std::size_t i = 0; i < bag.size(); ++i) {
    sum += bag[i].weight;
    if (i > 0) {
      EXPECT_LT(bag[i - 1].word, bag[i].word);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-5);
}

TEST(Vocabulary, SimilarityIsOneForTheSameBagAndZeroWithoutACommonWord) {
  const std::vector<WordWeight> a{{1, 0.5f}, {4, 0.5f}}, b{{2, 0.25f}, {9, 0.75f}},
      c{{1, 0.25f}, {9, 0.75f}};
  EXPECT_DOUBLE_EQ(similarity(a, a), 1);
  EXPECT_DOUBLE_EQ(similarity(a, b), 0);
  EXPECT_DOUBLE_EQ(similarity(a, c), 0.25);  // 1 - (0.25 + 0.5 + 0.75) / 2
}

TEST(Vocabulary, TheSamePicturesGiveTheSameVocabulary) {
  const Vocabulary a = smallVocabulary(), b = smallVocabulary();
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  for (std::size_t i = 0; i < a.nodes().size(); ++i) {
    EXPECT_EQ(a.nodes()[i].centre, b.nodes()[i].centre);
    EXPECT_EQ(a.nodes()[i].weight, b.nodes()[i].weight);
  }
}

TEST(Vocabulary, PicturesWithoutFeaturesAreRefused) {
  EXPECT_THROW(trainVocabulary(std::vector<std::vector<Descriptor>>(5), {}), InputError);
}

TEST(Vocabulary, TheBuiltInOneIsWhole) {
  const Vocabulary vocabulary = Vocabulary::builtIn();
  EXPECT_GT(vocabulary.words(), 1000);
  EXPECT_LT(vocabulary.bytes(), 2u << 20);
}

TEST_F(VocabularyFile, ComesBackAsItWasSaved) {
  const Vocabulary a = smallVocabulary(), b = Vocabulary::load(path_);
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  EXPECT_EQ(a.words(), b.words());
  std::mt19937 rng(5);
  for (int i = 0; i < 100; ++i) {
    const Descriptor d = randomDescriptor(rng);
    EXPECT_EQ(a.wordOf(d), b.wordOf(d));
    EXPECT_EQ(a.leafOf(d).weight, b.leafOf(d).weight);
  }
}

TEST_F(VocabularyFile, RefusalsNameTheFileAndTheReason) {
  EXPECT_EQ(refusal(), "loaded");
  overwrite(100, 77);
  EXPECT_NE(refusal().find(path_.string() + ": is damaged"), std::string::npos) << refusal();
  overwrite(8, 9);
  EXPECT_NE(refusal().find("has version 9 instead of 1"), std::string::npos) << refusal();
  overwrite(0, 'X');
  EXPECT_NE(refusal().find("is not a vocabulary"), std::string::npos) << refusal();
  std::filesystem::resize_file(path_, 10);
  EXPECT_NE(refusal().find("is too short"), std::string::npos) << refusal();
  std::filesystem::remove(path_);
  EXPECT_NE(refusal().find("cannot be read"), std::string::npos) << refusal();
}

TEST_F(VocabularyFile, ATruncatedOneIsRefused) {
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 5);
  EXPECT_NE(refusal().find("is truncated"), std::string::npos) << refusal();
}

TEST(Vocabulary, RefusesATreeThatIsNone) {
  using Node = Vocabulary::Node;
  const auto tree = [](std::vector<Node> nodes) { return Vocabulary(std::move(nodes), "it"); };
  const Node root{{}, 1, 2, 0}, word0{{}, 0, 0, 1}, word1{{}, 1, 0, 1};
  EXPECT_NO_THROW(tree({root, word0, word1}));
  EXPECT_THROW(tree({}), InputError);
  EXPECT_THROW(tree({root, word0}), InputError);                   // a child is missing
  EXPECT_THROW(tree({root, word1, word0}), InputError);            // words out of order
  EXPECT_THROW(tree({{{}, 0, 3, 0}, word0, word1}), InputError);   // its own child
  EXPECT_THROW(tree({root, word0, word1, word0}), InputError);     // nobody's child
  EXPECT_THROW(tree({root, word0, {{}, 1, 0, NAN}}), InputError);  // no weight
}

}  // namespace
}  // namespace depthscope::slam
