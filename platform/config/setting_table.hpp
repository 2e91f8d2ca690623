#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "platform/config/settings.hpp"

namespace depthscope::platform {

/// A field that takes one of a few names; `get` and `set` speak in indices into `names`.
struct ChoiceField {
  std::vector<std::string_view> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

using SettingField =
    std::variant<bool*, int*, std::int64_t*, float*, double*, std::string*, ChoiceField>;

/// One key of the configuration, bound to the field it sets.
struct Setting {
  std::string key;  // "section.key"; a section may itself have dots
  SettingField field;
  double min = 0, max = 0;  // allowed range of numbers, both ends included
  std::string_view doc;     // one line
  bool live = false;        // may change while the daemon runs (SIGHUP)

  std::string_view section() const { return std::string_view(key).substr(0, key.rfind('.')); }
  std::string_view name() const { return std::string_view(key).substr(key.rfind('.') + 1); }
};

/// Every key there is, bound to the fields of `settings`, which must outlive the table. The only
/// place where a key, its range and its meaning are written down (config/setting_bindings*.cpp).
std::vector<Setting> settingTable(Settings& settings);

/// What a setting takes, in words: "an integer from 1 to 8", "one of \"off\", \"mesh\"".
std::string expectation(const Setting& setting);

/// The present value, as TOML.
std::string valueAsToml(const Setting& setting);

}  // namespace depthscope::platform
