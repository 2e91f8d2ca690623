#include "slam/descriptor_search.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace depthscope::slam {
namespace {

class DescriptorSearchTest : public ::testing::TestWithParam<SimdPath> {
 protected:
  void SetUp() override {
    if (!isAvailable(GetParam())) GTEST_SKIP() << "not on this processor";
  }
  Descriptor random() {
    Descriptor d;
    for (auto& word : d.bits) word = generator_();
    return d;
  }
  std::mt19937_64 generator_{1};
};

TEST_P(DescriptorSearchTest, FindsWhatComparingEachWithEachFinds) {
  DescriptorSearch search(300);
  for (const int n : {1, 2, 3, 4, 5, 8, 11, 299}) {
    std::vector<Descriptor> many(n);
    for (Descriptor& d : many) d = random();
    search.assign(many);
    for (int trial = 0; trial < 50; ++trial) {
      const Descriptor query = random();
      DescriptorSearch::Nearest expected;
      for (int i = 0; i < n; ++i) {
        const int d = hammingDistance(query, many[i]);
        if (d < expected.distance)
          expected = {i, d, expected.distance};
        else
          expected.second_distance = std::min(expected.second_distance, d);
      }
      const auto found = search.nearest(query, GetParam());
      EXPECT_EQ(found.index, expected.index) << n;
      EXPECT_EQ(found.distance, expected.distance) << n;
      EXPECT_EQ(found.second_distance, expected.second_distance) << n;
    }
  }
}

TEST_P(DescriptorSearchTest, OfThoseEquallyNearTheFirstIsTaken) {
  DescriptorSearch search(10);
  std::vector<Descriptor> many(10, random());
  const Descriptor query = many[0];
  many[0].bits[0] ^= 1;
  many[1].bits[3] ^= 2;
  for (int i = 2; i < 10; ++i) many[i].bits[1] ^= 3;
  std::swap(many[0], many[6]);
  std::swap(many[1], many[7]);
  search.assign(many);
  const auto found = search.nearest(query, GetParam());
  EXPECT_EQ(found.index, 6);
  EXPECT_EQ(found.distance, 1);
  EXPECT_EQ(found.second_distance, 1);
}

TEST_P(DescriptorSearchTest, OppositesAreFoundWhereThereIsNothingElseAndNothingWhereThereIsNone) {
  DescriptorSearch search(4);
  search.assign({});
  EXPECT_EQ(search.nearest(Descriptor{}, GetParam()).index, -1);
  Descriptor opposite;
  for (auto& word : opposite.bits) word = ~std::uint64_t{0};
  search.assign(std::vector<Descriptor>(4, opposite));
  const auto found = search.nearest(Descriptor{}, GetParam());
  EXPECT_EQ(found.index, 0);
  EXPECT_EQ(found.distance, 256);
}

INSTANTIATE_TEST_SUITE_P(Paths, DescriptorSearchTest,
                         ::testing::Values(SimdPath::Portable, SimdPath::Avx2));

}  // namespace
}  // namespace depthscope::slam
