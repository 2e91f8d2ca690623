#include "platform/config/live_settings.hpp"

#include "platform/config/setting_table.hpp"

namespace depthscope::platform {
namespace {

/// Two bindings of the same key hold fields of the same type.
void copyValue(const Setting& from, const Setting& to) {
  std::visit(
      [&](const auto& field) {
        using Field = std::decay_t<decltype(field)>;
        const Field& source = std::get<Field>(from.field);
        if constexpr (std::is_same_v<Field, ChoiceField>)
          field.set(source.get());
        else
          *field = *source;
      },
      to.field);
}

void append(std::string& list, const std::string& key) {
  if (!list.empty()) list += ", ";
  list += key;
}

}  // namespace

SettingsChange adoptLiveSettings(Settings& running, Settings fresh) {
  const auto old_table = settingTable(running), new_table = settingTable(fresh);
  SettingsChange change;
  for (std::size_t i = 0; i < old_table.size(); ++i) {
    const Setting &old_setting = old_table[i], &new_setting = new_table[i];
    if (valueAsToml(old_setting) == valueAsToml(new_setting)) continue;
    append(old_setting.live ? change.applied : change.needs_restart, old_setting.key);
    if (old_setting.live) copyValue(new_setting, old_setting);
  }
  return change;
}

}  // namespace depthscope::platform
