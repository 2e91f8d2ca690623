#include "platform/config/live_settings.hpp"

#include <gtest/gtest.h>

#include "platform/config/config_file.hpp"
#include "platform/config/setting_table.hpp"
#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

TEST(LiveSettings, TakesOverLiveKeysAndNamesTheOthers) {
  Settings running, fresh;
  fresh.overlay.opacity = 0.25f;
  fresh.overlay.cue = overlay::CueMode::Mesh;
  fresh.recon.period_s = 9;
  fresh.slam.extractor.features = 777;
  fresh.daemon.state_dir = "/elsewhere";
  const int features = running.slam.extractor.features;
  const SettingsChange change = adoptLiveSettings(running, fresh);
  EXPECT_EQ(change.applied, "recon.period_s, overlay.cue, overlay.opacity");
  EXPECT_EQ(change.needs_restart, "slam.extractor.features, daemon.state_dir");
  EXPECT_EQ(running.overlay.opacity, 0.25f);
  EXPECT_EQ(running.overlay.cue, overlay::CueMode::Mesh);
  EXPECT_EQ(running.recon.period_s, 9);
  EXPECT_EQ(running.slam.extractor.features, features);
}

TEST(LiveSettings, NamesAKeyThatNeedsARestartEachTimeUntilThen) {
  Settings running, fresh;
  fresh.capture.loop = false;
  for (int i = 0; i < 2; ++i) {
    const SettingsChange change = adoptLiveSettings(running, fresh);
    EXPECT_EQ(change.applied, "");
    EXPECT_EQ(change.needs_restart, "capture.loop");
  }
}

/// What one process hands another must mean the same to both, key by key.
TEST(LiveSettings, SettingsAsTomlReadBackTheSame) {
  Settings changed;
  for (const Setting& s : settingTable(changed)) {
    if (const auto* number = std::get_if<double*>(&s.field)) **number = s.min + (s.max - s.min) / 3;
    if (const auto* number = std::get_if<float*>(&s.field))
      **number = static_cast<float>(s.min + (s.max - s.min) / 3);
    if (const auto* number = std::get_if<int*>(&s.field)) **number = static_cast<int>(s.max);
    if (const auto* text = std::get_if<std::string*>(&s.field)) **text = "a \"quoted\" \\ text";
    if (const auto* flag = std::get_if<bool*>(&s.field)) **flag = !**flag;
    if (const auto* choice = std::get_if<ChoiceField>(&s.field))
      choice->set(choice->names.size() - 1);
  }
  const TemporaryFolder folder;
  Settings read;
  loadConfig(folder.write("a.toml", settingsAsToml(changed)), read);
  EXPECT_EQ(settingsAsToml(read), settingsAsToml(changed));
}

}  // namespace
}  // namespace depthscope::platform
