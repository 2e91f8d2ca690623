// Whatever is wrong with the input: exit status 2, one line that names it, nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "../platform/temporary_folder.hpp"
#include "program.hpp"

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path sample = fs::path(DEPTHSCOPE_TEST_DATA) / "sample";

class BadInput : public ::testing::Test {
 protected:
  /// Runs replay and expects one line on stderr with all of these texts, and no output folder.
  void expectRefused(const std::string& input, const std::string& camera,
                     std::vector<std::string> more, const std::vector<std::string>& said) {
    const fs::path out = folder_.path() / "out" / "below";
    std::vector<std::string> words{"depthscope", "replay", "--input", input, "--camera", camera};
    if (std::find(more.begin(), more.end(), "--out") == more.end())
      more.insert(more.end(), {"--out", out});
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = runProgram(words);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& text : said) EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(fs::exists(folder_.path() / "out"));
  }
  std::string video() const { return sample / "video.mp4"; }
  std::string camera() const { return sample / "camera.yaml"; }
  /// The sample's camera file with a text in it replaced.
  std::string cameraWith(const std::string& from, const std::string& to) const {
    std::string text = readFile(sample / "camera.yaml");
    text.replace(text.find(from), from.size(), to);
    return folder_.write("camera.yaml", text);
  }
  TemporaryFolder folder_;
};

TEST_F(BadInput, Missing) {
  expectRefused("/no/such/clip.mp4", camera(), {}, {"/no/such/clip.mp4"});
}

TEST_F(BadInput, Empty) {
  expectRefused(folder_.write("empty.mp4", ""), camera(), {}, {"empty.mp4"});
}

TEST_F(BadInput, NoVideo) {
  expectRefused(folder_.write("text.mp4", std::string(10000, 'x')), camera(), {}, {"text.mp4"});
}

TEST_F(BadInput, FolderWithoutPictures) {
  expectRefused(folder_.path(), camera(), {}, {folder_.path()});
}

TEST_F(BadInput, TruncatedAtAnyPlace) {
  const std::string whole = readFile(video());
  for (const double share : {0.01, 0.3, 0.7, 0.97})
    expectRefused(
        folder_.write("cut.mp4", whole.substr(0, static_cast<std::size_t>(
                                                     share * static_cast<double>(whole.size())))),
        camera(), {"--no-overlay", "--no-surface"}, {"cut.mp4"});
}

TEST_F(BadInput, CameraFileMissing) {
  expectRefused(video(), "/no/such/camera.yaml", {}, {"/no/such/camera.yaml"});
}

TEST_F(BadInput, CameraFileWithoutAKey) {
  expectRefused(video(), cameraWith("fx: 457.007362\n", ""), {}, {"camera.yaml", "fx", "missing"});
}

TEST_F(BadInput, CameraFileOfAnotherSize) {
  expectRefused(video(), cameraWith("640", "800"), {},
                {"camera.yaml", "image_width", "800", "640"});
}

TEST_F(BadInput, CameraFileWithANumberThatIsNotFinite) {
  expectRefused(video(), cameraWith("319.5", "nan"), {}, {"camera.yaml", "cx", "finite"});
}

TEST_F(BadInput, OutputFolderThatCannotBeWritten) {
  expectRefused(video(), camera(), {"--out", "/proc/depthscope"}, {"/proc/depthscope"});
  const std::string file = folder_.write("file", "x");
  expectRefused(video(), camera(), {"--out", file + "/out"}, {file});
}

TEST_F(BadInput, UnknownArgumentsAndSettings) {
  expectRefused(video(), camera(), {"--fast"}, {"--fast"});
  expectRefused(video(), camera(), {"--set", "overlay.colour=red"}, {"overlay.colour"});
  expectRefused(video(), camera(), {"--set", "overlay.opacity=2"}, {"overlay.opacity", "0 to 1"});
  expectRefused(video(), camera(), {"--config", "/no/such.toml"}, {"/no/such.toml"});
  expectRefused(video(), camera(), {"--label", "nowhere"}, {"nowhere"});
  expectRefused(video(), camera(), {"--set", "slam.vocabulary=/no/such.voc"}, {"/no/such.voc"});
}

TEST_F(BadInput, ScalesThatCannotBe) {
  expectRefused(video(), camera(), {"--scale", "10 5,5"}, {"10 5,5", "MM X1,Y1 X2,Y2"});
  expectRefused(video(), camera(), {"--scale", "0 5,5 50,50"}, {"0.1 to 500 mm"});
  expectRefused(video(), camera(), {"--scale", "10 5,5 700,50"}, {"700,50", "640x480"});
  expectRefused(video(), camera(), {"--scale", "10 5,5 50,50", "--no-surface"}, {"--no-surface"});
  expectRefused(video(), camera(), {"--scale", "10 5,5 50,50", "--scale-frame", "x"},
                {"--scale-frame x"});
  expectRefused(video(), camera(), {"--scale-frame", "1"}, {"--scale-frame"});
}

TEST(Tool, ScaleRefusesWhatIsNoLengthBeforeItAsksTheDaemon) {
  const ProgramResult result =
      runProgram({"depthscope", "scale", "900", "1,2", "3,4", "--socket", "/no/such/socket"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("0.1 to 500 mm"));
}

TEST(Tool, TrainsTheSameVocabularyTwice) {
  const TemporaryFolder folder;
  std::string bytes[2];
  for (std::string& b : bytes) {
    const std::string out = folder.path() / "words.voc";
    const ProgramResult result = runProgram({"depthscope", "train-vocabulary", "--input", sample,
                                             "--out", out, "--every", "90", "--levels", "2"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("100 words from 5 pictures"));
    b = readFile(out);
  }
  EXPECT_GT(bytes[0].size(), 4000u);
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST(Tool, TrainingRefusesWhatIsNoClip) {
  const ProgramResult result = runProgram(
      {"depthscope", "train-vocabulary", "--input", "/no/such/folder", "--out", "/tmp/x.voc"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("/no/such/folder"));
}

TEST(Tool, RefusesUnknownCommands) {
  const ProgramResult result = runProgram({"depthscope", "fly"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("fly"));
}

TEST(Tool, EveryCommandHasHelp) {
  for (const char* command :
       {"replay", "evaluate", "calibrate", "train-vocabulary", "status", "reconstruct", "overlay",
        "label", "scale", "snapshot", "export", "reset"}) {
    const ProgramResult result = runProgram({"depthscope", command, "--help"});
    EXPECT_EQ(result.status, 0) << command;
    EXPECT_THAT(result.out, HasSubstr(std::string("depthscope ") + command));
  }
}

}  // namespace
