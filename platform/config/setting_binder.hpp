#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/config/setting_table.hpp"

namespace depthscope::platform {

/// Collects configuration keys, each bound to the field it sets. Names, ranges and meanings stand
/// in the functions that use it, one for each section.
class SettingBinder {
 public:
  /// Keys that follow belong to this section.
  void section(std::string_view name) {
    section_ = name;
    live_ = false;
  }
  /// Those that follow, up to the next section, may change while the daemon runs, or not.
  void live(bool may_change) { live_ = may_change; }

  template <class T>
  void number(std::string_view name, T& field, double min, double max, std::string_view doc) {
    table_.push_back({path(name), &field, min, max, doc, live_});
  }
  void flag(std::string_view name, bool& field, std::string_view doc) {
    table_.push_back({path(name), &field, 0, 0, doc, live_});
  }
  void text(std::string_view name, std::string& field, std::string_view doc) {
    table_.push_back({path(name), &field, 0, 0, doc, live_});
  }
  /// `names` in the order of the enumerators.
  template <class Enum>
  void choice(std::string_view name, Enum& field, std::vector<std::string_view> names,
              std::string_view doc) {
    ChoiceField choice{std::move(names), [&field] { return static_cast<std::size_t>(field); },
                       [&field](std::size_t i) { field = static_cast<Enum>(i); }};
    table_.push_back({path(name), std::move(choice), 0, 0, doc, live_});
  }
  std::vector<Setting> take() { return std::move(table_); }

 private:
  std::string path(std::string_view name) const { return section_ + "." + std::string(name); }
  std::string section_;
  bool live_ = false;
  std::vector<Setting> table_;
};

/// Those of tracking, mapping and reconstruction (config/setting_bindings_seeing.cpp).
void bindSlam(SettingBinder& b, slam::SlamSettings& s);
void bindRecon(SettingBinder& b, recon::ReconSettings& s);

}  // namespace depthscope::platform
