#include "platform/config/config_file.hpp"

#include <toml++/toml.h>

#include <cmath>
#include <sstream>

#include "platform/config/setting_table.hpp"
#include "platform/display/mode_request.hpp"
#include "platform/footswitch/line_offset.hpp"
#include "platform/text_file.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

template <class T>
bool assignInteger(T& field, const Setting& setting, const toml::node& node) {
  const auto* value = node.as_integer();
  if (value == nullptr) return false;
  const double number = static_cast<double>(value->get());
  if (number < setting.min || number > setting.max) return false;
  field = static_cast<T>(value->get());
  return true;
}

template <class T>
bool assignReal(T& field, const Setting& setting, const toml::node& node) {
  if (!node.is_number()) return false;
  const double number = *node.value<double>();
  // The range in the field's own precision, so that a bound such as 0.1 is itself allowed.
  if (!std::isfinite(number) || static_cast<T>(number) < static_cast<T>(setting.min) ||
      static_cast<T>(number) > static_cast<T>(setting.max))
    return false;
  field = static_cast<T>(number);
  return true;
}

bool assign(bool* field, const Setting&, const toml::node& node) {
  if (!node.is_boolean()) return false;
  *field = node.as_boolean()->get();
  return true;
}
bool assign(int* field, const Setting& s, const toml::node& node) {
  return assignInteger(*field, s, node);
}
bool assign(std::int64_t* field, const Setting& s, const toml::node& node) {
  return assignInteger(*field, s, node);
}
bool assign(float* field, const Setting& s, const toml::node& node) {
  return assignReal(*field, s, node);
}
bool assign(double* field, const Setting& s, const toml::node& node) {
  return assignReal(*field, s, node);
}
bool assign(std::string* field, const Setting&, const toml::node& node) {
  if (!node.is_string()) return false;
  *field = node.as_string()->get();
  return true;
}
bool assign(const ChoiceField& choice, const Setting&, const toml::node& node) {
  if (!node.is_string()) return false;
  for (std::size_t i = 0; i < choice.names.size(); ++i)
    if (choice.names[i] == node.as_string()->get()) {
      choice.set(i);
      return true;
    }
  return false;
}

/// Sets the field from `node`; `where` starts the message should that fail.
void assignChecked(const Setting& setting, const toml::node& node, const std::string& where) {
  const bool done =
      std::visit([&](const auto& field) { return assign(field, setting, node); }, setting.field);
  if (done) return;
  std::ostringstream got;
  node.visit([&](const auto& concrete) {
    if constexpr (toml::is_value<decltype(concrete)>)
      got << toml::node_view<const toml::node>(&concrete);
    else
      got << "a table or list";
  });
  throw InputError(where + setting.key + " = " + got.str() + ": expected " + expectation(setting));
}

const Setting* find(const std::vector<Setting>& table, std::string_view key) {
  for (const Setting& s : table)
    if (s.key == key) return &s;
  return nullptr;
}

bool isSection(const std::vector<Setting>& table, std::string_view name) {
  const std::string prefix = std::string(name) + ".";
  for (const Setting& s : table)
    if (s.key.starts_with(prefix)) return true;
  return false;
}

[[noreturn]] void throwUnknown(const std::vector<Setting>& table, const std::string& where,
                               const std::string& key) {
  const auto dot = key.rfind('.');
  std::string known;
  if (dot != std::string::npos)
    for (const Setting& s : table)
      if (s.section() == std::string_view(key).substr(0, dot))
        known += (known.empty() ? "" : ", ") + std::string(s.name());
  if (!known.empty()) throw InputError(where + "unknown key " + key + "; expected one of " + known);
  std::string sections;
  std::string_view last;
  for (const Setting& s : table)
    if (s.section() != last) {
      last = s.section();
      sections += (sections.empty() ? "[" : ", [") + std::string(last) + "]";
    }
  throw InputError(where + "unknown key or section " + key + "; sections are " + sections);
}

void applyTable(const std::vector<Setting>& table, const toml::table& node,
                const std::string& prefix, const std::string& file) {
  for (const auto& [name, value] : node) {
    const std::string key = prefix + std::string(name.str());
    const std::string where = file + ":" + std::to_string(value.source().begin.line) + ": ";
    if (const Setting* setting = find(table, key))
      assignChecked(*setting, value, where);
    else if (value.is_table() && isSection(table, key))
      applyTable(table, *value.as_table(), key + ".", file);
    else
      throwUnknown(table, where, key);
  }
}

}  // namespace

void loadConfig(const std::filesystem::path& path, Settings& settings) {
  const std::string text = readTextFile(path, "a configuration file");
  try {
    const toml::table root = toml::parse(text, path.string());
    applyTable(settingTable(settings), root, "", path.string());
  } catch (const toml::parse_error& error) {
    throw InputError(path.string() + ":" + std::to_string(error.source().begin.line) +
                     ": not TOML: " + std::string(error.description()));
  }
}

void applyOverride(std::string_view assignment, Settings& settings) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0)
    throw InputError("--set " + std::string(assignment) + ": expected section.key=value");
  const std::string key(assignment.substr(0, equals)), value(assignment.substr(equals + 1));
  const auto table = settingTable(settings);
  const Setting* setting = find(table, key);
  if (setting == nullptr) throwUnknown(table, "--set ", key);
  toml::table parsed;
  try {
    parsed = toml::parse("v = " + value);
  } catch (const toml::parse_error&) {
    parsed.insert("v", value);  // a bare word
  }
  const toml::node* node = parsed.get("v");
  const bool text = std::holds_alternative<std::string*>(setting->field) ||
                    std::holds_alternative<ChoiceField>(setting->field);
  toml::value<std::string> raw(value);
  assignChecked(*setting, text && !node->is_string() ? static_cast<const toml::node&>(raw) : *node,
                "--set ");
}

namespace {

void checkGpioLine(const std::string& section, const std::string& line, const std::string& chip) {
  if (line.empty() && !chip.empty())
    throw InputError(section + ".chip: is set without " + section +
                     ".line, expected a line's name or offset");
  if (chip.empty() && lineOffset(line))
    throw InputError(section + ".line = \"" + line + "\": an offset needs " + section +
                     ".chip, expected the chip's path, name or label");
}

}  // namespace

void checkConsistency(const Settings& settings) {
  Settings copy = settings;
  const auto table = settingTable(copy);
  const auto ordered = [&](const char* low, double low_value, const char* high, double high_value) {
    if (low_value <= high_value) return;
    throw InputError(std::string(low) + " = " + valueAsToml(*find(table, low)) +
                     ": expected at most " + high + " = " + valueAsToml(*find(table, high)));
  };
  ordered("slam.extractor.fast_threshold_min", settings.slam.extractor.fast_threshold_min,
          "slam.extractor.fast_threshold", settings.slam.extractor.fast_threshold);
  ordered("slam.matching.hamming_strict", settings.slam.matching.hamming_strict,
          "slam.matching.hamming_loose", settings.slam.matching.hamming_loose);
  ordered("recon.min_points", settings.recon.min_points, "recon.max_points",
          settings.recon.max_points);
  ordered("recon.poisson_min_depth", settings.recon.poisson_min_depth, "recon.poisson_max_depth",
          settings.recon.poisson_max_depth);
  ordered("recon.max_triangles", settings.recon.max_triangles, "daemon.max_triangles",
          settings.daemon.max_triangles);
  ordered("overlay.gone_confidence", settings.overlay.gone_confidence, "overlay.full_confidence",
          settings.overlay.full_confidence);
  parseModeRequest(settings.display.mode);
  checkGpioLine("footswitch", settings.footswitch.line, settings.footswitch.chip);
  checkGpioLine("heartbeat", settings.heartbeat.line, settings.heartbeat.chip);
  ordered("daemon.restart_min_s", settings.daemon.restart_min_s, "daemon.restart_max_s",
          settings.daemon.restart_max_s);
}

std::string documentedConfig() {
  Settings defaults;
  std::string out =
      "# Every key with its default. Remove the '#' before a key to change it. Those marked live "
      "take\n"
      "# effect when the service is reloaded, the others when it is restarted.\n";
  std::string last;
  for (const Setting& s : settingTable(defaults)) {
    if (s.section() != last) {
      last = s.section();
      out += "\n[" + last + "]\n";
    }
    out += "# " + std::string(s.doc) + " (" + expectation(s) + (s.live ? "; live" : "") + ")\n#" +
           std::string(s.name()) + " = " + valueAsToml(s) + "\n";
  }
  return out;
}

std::string settingsAsToml(Settings settings) {
  std::string out, last;
  for (const Setting& s : settingTable(settings)) {
    if (s.section() != last) {
      last = s.section();
      out += "[" + last + "]\n";
    }
    out += std::string(s.name()) + " = " + valueAsToml(s) + "\n";
  }
  return out;
}

}  // namespace depthscope::platform
