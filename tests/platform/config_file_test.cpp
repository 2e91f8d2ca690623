#include "platform/config/config_file.hpp"

#include <gtest/gtest.h>

#include <set>

#include "expect_input_error.hpp"
#include "platform/config/setting_table.hpp"
#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

class ConfigFile : public ::testing::Test {
 protected:
  void load(const std::string& text) { loadConfig(folder_.write("a.toml", text), settings_); }
  TemporaryFolder folder_;
  Settings settings_;
};

TEST_F(ConfigFile, SetsTheFieldsItNamesAndNoOthers) {
  load(
      "[overlay]\ncue = \"mesh\"\nopacity = 1\n[slam.extractor]\nfeatures = 2000\n[capture]\nloop "
      "= false\n");
  EXPECT_EQ(settings_.overlay.cue, overlay::CueMode::Mesh);
  EXPECT_EQ(settings_.overlay.opacity, 1.0f);
  EXPECT_EQ(settings_.slam.extractor.features, 2000);
  EXPECT_FALSE(settings_.capture.loop);
  EXPECT_EQ(settings_.slam.extractor.levels, Settings().slam.extractor.levels);
}

TEST_F(ConfigFile, NamesLineAndKeyOfAnUnknownKey) {
  EXPECT_INPUT_ERROR(load("[overlay]\n\nopaqueness = 1\n"), HasSubstr("a.toml:3:"),
                     HasSubstr("overlay.opaqueness"), HasSubstr("opacity"));
}

TEST_F(ConfigFile, NamesAnUnknownSection) {
  EXPECT_INPUT_ERROR(load("[overlays]\ncue = \"mesh\"\n"), HasSubstr("a.toml:1:"),
                     HasSubstr("overlays"), HasSubstr("[overlay]"));
}

TEST_F(ConfigFile, NamesWhatAWrongTypeShouldHaveBeen) {
  EXPECT_INPUT_ERROR(load("[slam.extractor]\nfeatures = 10.5\n"), HasSubstr("a.toml:2:"),
                     HasSubstr("slam.extractor.features = 10.5"),
                     HasSubstr("an integer from 100 to 10000"));
  EXPECT_INPUT_ERROR(load("[overlay]\ninset = 1\n"), HasSubstr("overlay.inset"),
                     HasSubstr("true or false"));
  EXPECT_INPUT_ERROR(load("[overlay]\nopacity = \"high\"\n"), HasSubstr("overlay.opacity"),
                     HasSubstr("a number from 0 to 1"));
  EXPECT_INPUT_ERROR(load("[capture]\ninput = 7\n"), HasSubstr("capture.input"),
                     HasSubstr("a text in quotes"));
  EXPECT_INPUT_ERROR(load("overlay = 3\n"), HasSubstr("overlay"));
  EXPECT_INPUT_ERROR(load("[overlay.opacity]\n"), HasSubstr("overlay.opacity"));
}

TEST_F(ConfigFile, NamesTheRangeOfAValueOutsideIt) {
  EXPECT_INPUT_ERROR(load("[overlay]\nopacity = 1.5\n"), HasSubstr("a.toml:2:"),
                     HasSubstr("0 to 1"));
  EXPECT_INPUT_ERROR(load("[overlay]\nopacity = nan\n"), HasSubstr("0 to 1"));
  EXPECT_INPUT_ERROR(load("[overlay]\nopacity = inf\n"), HasSubstr("0 to 1"));
  EXPECT_INPUT_ERROR(load("[overlay]\ncue = \"rainbow\"\n"),
                     HasSubstr("\"off\", \"chromadepth\", \"mesh\""));
  EXPECT_INPUT_ERROR(load("[slam.extractor]\nfeatures = 99999999999\n"), HasSubstr("100 to 10000"));
}

TEST_F(ConfigFile, NamesTheLineWhereTheTextIsNotToml) {
  EXPECT_INPUT_ERROR(load("[overlay]\nopacity = \n"), HasSubstr("a.toml:2:"),
                     HasSubstr("not TOML"));
  EXPECT_INPUT_ERROR(load("[overlay]\nopacity = 0.1\nopacity = 0.2\n"), HasSubstr("a.toml:3:"));
}

TEST_F(ConfigFile, SaysWhenTheFileCannotBeRead) {
  EXPECT_INPUT_ERROR(loadConfig(folder_.path() / "missing.toml", settings_),
                     HasSubstr("missing.toml"));
  EXPECT_INPUT_ERROR(loadConfig(folder_.path(), settings_), HasSubstr("cannot be read"));
}

TEST_F(ConfigFile, AnEmptyFileChangesNothing) {
  EXPECT_NO_THROW(load(""));
}

TEST_F(ConfigFile, OverridesTakeTextsWithAndWithoutQuotes) {
  applyOverride("overlay.cue=mesh", settings_);
  EXPECT_EQ(settings_.overlay.cue, overlay::CueMode::Mesh);
  applyOverride("overlay.cue=\"off\"", settings_);
  EXPECT_EQ(settings_.overlay.cue, overlay::CueMode::Off);
  applyOverride("capture.input=/a b/c=d.mp4", settings_);
  EXPECT_EQ(settings_.capture.input, "/a b/c=d.mp4");
  applyOverride("capture.input=123", settings_);
  EXPECT_EQ(settings_.capture.input, "123");
  applyOverride("recon.period_s=1.5", settings_);
  EXPECT_EQ(settings_.recon.period_s, 1.5);
}

TEST_F(ConfigFile, OverridesAreCheckedLikeTheFile) {
  EXPECT_INPUT_ERROR(applyOverride("overlay.opacity=2", settings_),
                     HasSubstr("--set overlay.opacity"), HasSubstr("0 to 1"));
  EXPECT_INPUT_ERROR(applyOverride("overlay.nothing=2", settings_), HasSubstr("overlay.nothing"));
  EXPECT_INPUT_ERROR(applyOverride("overlay.opacity", settings_), HasSubstr("section.key=value"));
  EXPECT_INPUT_ERROR(applyOverride("overlay.opacity=much", settings_), HasSubstr("0 to 1"));
}

TEST_F(ConfigFile, EveryDefaultIsInsideItsOwnRange) {
  // The documented configuration with all its keys switched on must load and change nothing.
  std::string text;
  bool line_start = true;
  for (char c : documentedConfig()) {
    if (!(line_start && c == '#')) text += c;
    line_start = c == '\n';
  }
  std::string keys_only;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    if (text[at] != ' ') keys_only += text.substr(at, end - at + 1);
    at = end + 1;
  }
  ASSERT_NO_THROW(load(keys_only)) << keys_only;
  Settings defaults;
  const auto loaded = settingTable(settings_), expected = settingTable(defaults);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(valueAsToml(loaded[i]), valueAsToml(expected[i])) << expected[i].key;
}

TEST_F(ConfigFile, ChecksBoundsAgainstEachOther) {
  EXPECT_NO_THROW(checkConsistency(settings_));
  settings_.daemon.restart_min_s = 60;
  EXPECT_INPUT_ERROR(checkConsistency(settings_), HasSubstr("daemon.restart_min_s = 60.0"),
                     HasSubstr("daemon.restart_max_s = 10.0"));
}

TEST_F(ConfigFile, NoKeyIsBoundTwice) {
  std::set<std::string> keys;
  for (const Setting& s : settingTable(settings_)) EXPECT_TRUE(keys.insert(s.key).second) << s.key;
}

}  // namespace
}  // namespace depthscope::platform
