#include "platform/ipc/seqlock.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace depthscope::platform {
namespace {

using Payload = std::array<std::uint64_t, 16>;

Payload filledWith(std::uint64_t value) {
  Payload p;
  p.fill(value);
  return p;
}

TEST(Seqlock, IsEmptyUntilTheFirstWrite) {
  SeqlockBox<Payload> box;
  Payload p;
  EXPECT_FALSE(box.read(p));
  box.write(filledWith(7));
  std::uint64_t first = 0, second = 0;
  ASSERT_TRUE(box.read(p, &first));
  EXPECT_EQ(p, filledWith(7));
  box.write(filledWith(8));
  ASSERT_TRUE(box.read(p, &second));
  EXPECT_NE(first, second);
}

TEST(Seqlock, CopiesSizesThatAreNoWholeWords) {
  struct Odd {
    char text[13];
  };
  SeqlockBox<Odd> box;
  box.write({"hello, world"});
  Odd read;
  ASSERT_TRUE(box.read(read));
  EXPECT_STREQ(read.text, "hello, world");
}

TEST(Seqlock, AWriteThatNeverEndsHoldsNobodyUp) {
  seqlock::Word count{0}, word{0};
  seqlock::beginWrite(count);  // and the writer dies
  const std::uint64_t before = seqlock::beginRead(count);
  EXPECT_FALSE(seqlock::endRead(count, before));
  seqlock::beginWrite(count);  // its successor goes on from there
  const std::uint64_t value = 5;
  seqlock::store(&word, &value, 8);
  seqlock::endWrite(count);
  EXPECT_TRUE(seqlock::endRead(count, seqlock::beginRead(count)));
}

TEST(Seqlock, ACountAtItsLargestGoesOnWithoutSayingEmpty) {
  seqlock::Word count{~std::uint64_t{0} - 1};
  seqlock::beginWrite(count);
  seqlock::endWrite(count);
  EXPECT_NE(count.load(), 0u);
  EXPECT_EQ(count.load() % 2, 0u);
}

TEST(Seqlock, TwoThreadsNeverSeeATornValue) {
  SeqlockBox<Payload> box;
  box.write(filledWith(0));
  constexpr std::uint64_t writes = 200000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= writes; ++i) box.write(filledWith(i));
  });
  std::uint64_t last = 0, good = 0;
  while (last < writes) {
    Payload p;
    if (!box.read(p)) continue;
    ++good;
    ASSERT_EQ(p, filledWith(p[0]));
    ASSERT_GE(p[0], last);
    last = p[0];
  }
  writer.join();
  EXPECT_GT(good, 0u);
}

}  // namespace
}  // namespace depthscope::platform
