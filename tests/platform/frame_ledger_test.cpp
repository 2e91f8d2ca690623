#include "platform/daemon/frame_ledger.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "tests/platform/temporary_folder.hpp"

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

class FrameLedgerTest : public testing::Test {
 protected:
  static FrameTimes times(std::uint64_t sequence) {
    FrameTimes t;
    t.sequence = sequence;
    t.captured = FrameTimes::Time(milliseconds(1000 + 10 * sequence));
    t.dequeued = t.uploaded = t.overlaid = t.composited = t.captured + milliseconds(1);
    t.submitted = t.captured + milliseconds(3);
    return t;
  }
  /// First and last column of each picture's line.
  std::vector<std::string> lines() {
    log.flush();
    std::istringstream in(readFile(path));
    std::vector<std::string> found;
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line))
      found.push_back(line.substr(0, line.find(',')) + ":" + line.substr(line.rfind(',') + 1));
    return found;
  }

  TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "frames.csv";
  FrameLog log{path};
};

TEST_F(FrameLedgerTest, TellsWhenEachPictureWasOnTheGlassAndOfThoseThatNeverWere) {
  FrameLedger ledger(&log);
  for (std::uint64_t i = 0; i < 4; ++i) ledger.submitted(static_cast<std::int64_t>(i), times(i));
  EXPECT_THAT(lines(), ElementsAre()) << "not known yet";
  ledger.shown(0, FrameTimes::Time(milliseconds(1012)));
  ledger.shown(2, FrameTimes::Time(milliseconds(1037)));
  EXPECT_THAT(lines(), ElementsAre("0:12000", "1:", "2:17000"));
  EXPECT_EQ(ledger.summary().shown_delay.count, 2u);
  EXPECT_EQ(ledger.summary().video_delay.count, 4u);
}

TEST_F(FrameLedgerTest, WritesEveryPictureWhereTheDisplayTellsNothing) {
  std::vector<std::string> expected;
  {
    FrameLedger ledger(&log);
    for (std::uint64_t i = 0; i < 40; ++i) {
      ledger.submitted(static_cast<std::int64_t>(i), times(i));
      expected.push_back(std::to_string(i) + ":");
    }
    EXPECT_EQ(lines().size(), 24u) << "the last ones may still be told of";
  }
  EXPECT_EQ(lines(), expected);
}

TEST_F(FrameLedgerTest, IsNotConfusedByPicturesThatItDoesNotKnow) {
  FrameLedger ledger(&log);
  ledger.shown(-1, FrameTimes::Time(milliseconds(1000)));
  ledger.submitted(5, times(5));
  ledger.shown(4, FrameTimes::Time(milliseconds(1040)));
  EXPECT_THAT(lines(), ElementsAre());
  ledger.shown(6, FrameTimes::Time(milliseconds(1060)));  // a fault picture's
  EXPECT_THAT(lines(), ElementsAre("5:"));
  EXPECT_EQ(ledger.summary().shown_delay.count, 0u);
}

}  // namespace
}  // namespace depthscope::platform
