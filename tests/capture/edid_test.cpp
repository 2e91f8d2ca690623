#include "capture/edid.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>

#include "tests/capture/v4l2_test_card.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

TEST(Edid, TheBuiltinOneIsSound) {
  const auto edid = builtinEdid();
  EXPECT_EQ(edid.size(), 256u);
  EXPECT_EQ(edidFault(edid), "");
}

/// The fields as VESA lays them out, read back independently of how they were written.
TEST(Edid, TheBuiltinOnePrefers1080pAndHas720p) {
  const auto e = builtinEdid();
  struct Timing {
    int clock_10khz, width, h_blank, height, v_blank, h_front, h_sync, v_front, v_sync;
  };
  const auto timing = [&](std::size_t at) {
    const std::uint8_t* d = &e[at];
    return Timing{d[0] | d[1] << 8,
                  d[2] | (d[4] & 0xf0) << 4,
                  d[3] | (d[4] & 0x0f) << 8,
                  d[5] | (d[7] & 0xf0) << 4,
                  d[6] | (d[7] & 0x0f) << 8,
                  d[8] | (d[11] & 0xc0) << 2,
                  d[9] | (d[11] & 0x30) << 4,
                  d[10] >> 4 | (d[11] & 0x0c) << 2,
                  (d[10] & 15) | (d[11] & 0x03) << 4};
  };
  const auto rate = [](const Timing& t) {
    return t.clock_10khz * 1e4 / ((t.width + t.h_blank) * double(t.height + t.v_blank));
  };
  const Timing first = timing(54), second = timing(72);
  EXPECT_EQ(first.width, 1920);
  EXPECT_EQ(first.height, 1080);
  EXPECT_NEAR(rate(first), 60, 0.01);
  EXPECT_EQ(first.h_front, 88);
  EXPECT_EQ(first.h_sync, 44);
  EXPECT_EQ(first.v_front, 4);
  EXPECT_EQ(first.v_sync, 5);
  EXPECT_EQ(second.width, 1280);
  EXPECT_EQ(second.height, 720);
  EXPECT_NEAR(rate(second), 60, 0.01);
  EXPECT_TRUE(e[24] & 2) << "the first timing is the preferred one";
  EXPECT_EQ((e[8] << 8 | e[9]) >> 10 & 31, 'D' - '@');
  // The vendor block that makes it HDMI.
  const std::uint8_t hdmi[] = {0x03, 0x0c, 0x00};
  EXPECT_NE(std::search(e.begin() + 128, e.end(), std::begin(hdmi), std::end(hdmi)), e.end());
  EXPECT_LE(e[130], 127);
}

TEST(Edid, FaultsAreFound) {
  auto edid = builtinEdid();
  edid[60] ^= 1;
  EXPECT_EQ(edidFault(edid), "checksum of block 0 is wrong");
  edid = builtinEdid();
  edid[140] ^= 1;
  EXPECT_EQ(edidFault(edid), "checksum of block 1 is wrong");
  edid = builtinEdid();
  edid[0] = 1;
  EXPECT_NE(edidFault(edid), "");
  edid.resize(128);
  EXPECT_NE(edidFault(edid), "");
  edid.resize(100);
  EXPECT_NE(edidFault(edid), "");
  EXPECT_NE(edidFault({}), "");
}

TEST(Edid, AFileIsReadOrRefusedByName) {
  const auto file = std::filesystem::path(testing::TempDir()) / "depthscope_edid.bin";
  const auto edid = builtinEdid();
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(edid.data()), 256);
  EXPECT_EQ(loadEdid(file), edid);
  std::filesystem::resize_file(file, 200);
  try {
    loadEdid(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("depthscope_edid.bin"), std::string::npos);
  }
  std::filesystem::remove(file);
  EXPECT_THROW(loadEdid(file), InputError);
}

TEST_F(V4l2Test, ACardWithoutEdidGetsTheBuiltinOneOnce) {
  plug({});
  open();
  nextPicture();
  EXPECT_EQ(card->edid(), builtinEdid());
  card->setMode(fake::timingsSmall(32, 32, 50));
  nextPicture();
  EXPECT_EQ(card->edidWrites(), 1);
}

TEST_F(V4l2Test, AnEdidThatIsThereStaysUnlessOneIsAskedFor) {
  plug({});
  auto own = builtinEdid();
  own[10] = 77;
  own[127] = static_cast<std::uint8_t>(own[127] - 76);
  card->setEdid(own);
  open();
  EXPECT_EQ(card->edid(), own);
  source.reset();
  open({.edid = "none"});
  EXPECT_EQ(card->edid(), own);
  source.reset();
  open({.edid = "builtin"});
  EXPECT_EQ(card->edid(), builtinEdid());
  EXPECT_FALSE(nextPicture().empty());
}

TEST_F(V4l2Test, ACameraHasNoEdid) {
  plug({.digital = false, .sizes = {{64, 48}}});
  open({.edid = "builtin"});
  EXPECT_FALSE(nextPicture().empty()) << source->detail();
  EXPECT_EQ(card->edidWrites(), 0);
}

}  // namespace
}  // namespace depthscope::capture
