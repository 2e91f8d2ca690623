// depthscoped --check on configurations with one mistake each: one line that names file, line and
// key, and what would be right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "../platform/temporary_folder.hpp"
#include "program.hpp"

namespace {

using ::testing::HasSubstr;

struct Mistake {
  const char* text;      // of the file
  const char* where;     // it is, as the message begins
  const char* expected;  // what would be right
};

constexpr Mistake mistakes[] = {
    {"[overlay]\nopacity = 5\n", ":2: overlay.opacity = 5", "a number from 0 to 1"},
    {"[slam.extractor]\nfeatures = 50\n", ":2: slam.extractor.features = 50",
     "an integer from 100 to 10000"},
    {"[overlay]\ncue = \"rainbow\"\n", ":2: overlay.cue = 'rainbow'",
     "one of \"off\", \"chromadepth\", \"mesh\""},
    {"[display]\nkind = \"hdmi\"\n", ":2: display.kind = 'hdmi'",
     "one of \"null\", \"file\", \"kms\", \"fbdev\""},
    {"[overlay]\ninset = 1\n", ":2: overlay.inset = 1", "true or false"},
    {"[capture]\ncamera = 7\n", ":2: capture.camera = 7", "a text in quotes"},
    {"[overlay]\n\nopaqueness = 1\n", ":3: unknown key overlay.opaqueness", "one of cue, opacity"},
    {"[overlays]\ncue = \"mesh\"\n", ":1: unknown key or section overlays", "[overlay]"},
    {"[daemon]\nrestart_min_s = 60\n", ": daemon.restart_min_s = 60.0", "daemon.restart_max_s"},
    {"[capture]\npixel_format = \"H264\"\ndevice = \"auto\"\n", ": capture.pixel_format: \"H264\"",
     "YUYV"},
    {"[capture]\ndevice = \"auto\"\ninput = \"clip.mp4\"\n", ": capture.device = \"auto\"",
     "without capture.input"},
    {"[overlay]\nopacity = \n", ":2:", "not TOML"},
};

TEST(BrokenConfiguration, IsNamedByFileLineAndKeyWithWhatWouldBeRight) {
  const TemporaryFolder folder;
  for (const Mistake& mistake : mistakes) {
    const std::string file = folder.write("depthscope.toml", mistake.text);
    const ProgramResult result = runProgram({"depthscoped", "--check", file});
    EXPECT_EQ(result.status, 2) << mistake.text;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(file + mistake.where));
    EXPECT_THAT(result.err, HasSubstr(mistake.expected));
    std::printf("%s", result.err.c_str());
  }
}

}  // namespace
