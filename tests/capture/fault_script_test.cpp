#include "capture/fault_script.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <string>

#include "tests/capture/clip_writer.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

using Kind = FaultEvent::Kind;
using testing::HasSubstr;

class FaultScript : public testing::Test {
 protected:
  std::vector<FaultEvent> load(const std::string& text) {
    std::ofstream(path_) << text;
    return loadFaultScript(path_);
  }
  std::string errorOf(const std::string& text) {
    try {
      load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "script.txt";
};

TEST_F(FaultScript, ReadsEveryKind) {
  const auto script = load(
      "# a comment\n\nsignal-lost 10 5\n  resize 20 3 320x240  # smaller\n"
      "late 30 1 12.5\ndamaged 40 2\r\nrepeated 50 1");
  ASSERT_EQ(script.size(), 5u);
  EXPECT_EQ(script[0].kind, Kind::SignalLost);
  EXPECT_EQ(script[0].first, 10);
  EXPECT_EQ(script[0].count, 5);
  EXPECT_EQ(script[1].kind, Kind::Resize);
  EXPECT_EQ(script[1].width, 320);
  EXPECT_EQ(script[1].height, 240);
  EXPECT_EQ(script[2].kind, Kind::Late);
  EXPECT_EQ(script[2].delay_ms, 12.5);
  EXPECT_EQ(script[3].kind, Kind::Damaged);
  EXPECT_EQ(script[4].kind, Kind::Repeated);
}

TEST_F(FaultScript, NamesFileLineAndWhatWasExpected) {
  EXPECT_THAT(errorOf("damaged 0 1\nexplode 1 1"),
              HasSubstr(path_.string() + ":2: expected signal"));
  EXPECT_THAT(errorOf("damaged 0"), HasSubstr("expected damaged FIRST COUNT"));
  EXPECT_THAT(errorOf("damaged 0 1 5"), HasSubstr("expected damaged FIRST COUNT"));
  EXPECT_THAT(errorOf("late 0 1"), HasSubstr("DELAY_MS"));
  EXPECT_THAT(errorOf("damaged -1 1"), HasSubstr("FIRST"));
  EXPECT_THAT(errorOf("damaged 0 0"), HasSubstr("COUNT"));
  EXPECT_THAT(errorOf("damaged 0 1x"), HasSubstr("COUNT"));
  EXPECT_THAT(errorOf("resize 0 1 320"), HasSubstr("WIDTHxHEIGHT"));
  EXPECT_THAT(errorOf("resize 0 1 320x"), HasSubstr("WIDTHxHEIGHT"));
  EXPECT_THAT(errorOf("resize 0 1 8x100000"), HasSubstr("16 to 16384"));
  EXPECT_THAT(errorOf("late 0 1 nan"), HasSubstr("ms"));
  EXPECT_THAT(errorOf("late 0 1 -3"), HasSubstr("ms"));
}

TEST_F(FaultScript, AMissingFileOrAFolderIsAnError) {
  EXPECT_THROW(loadFaultScript(folder_ / "none"), InputError);
  EXPECT_THROW(loadFaultScript(folder_.path()), InputError);
}

TEST(FaultsAt, HoldFromFirstForCountFrames) {
  const std::vector<FaultEvent> script{{Kind::Damaged, 3, 2}, {Kind::Late, 4, 1, 0, 0, 20.0}};
  EXPECT_FALSE(faultsAt(script, 2).damaged);
  EXPECT_TRUE(faultsAt(script, 3).damaged);
  EXPECT_TRUE(faultsAt(script, 4).damaged);
  EXPECT_EQ(faultsAt(script, 4).delay_ms, 20.0);
  EXPECT_FALSE(faultsAt(script, 5).damaged);
}

TEST(FaultsAt, AnEndlessEventDoesNotOverflow) {
  const std::vector<FaultEvent> script{
      {Kind::SignalLost, 5, std::numeric_limits<std::int64_t>::max()}};
  EXPECT_FALSE(faultsAt(script, 4).signal_lost);
  EXPECT_TRUE(faultsAt(script, 1'000'000).signal_lost);
}

}  // namespace
}  // namespace depthscope::capture
