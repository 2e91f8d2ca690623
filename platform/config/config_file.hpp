#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "platform/config/settings.hpp"

namespace depthscope::platform {

/// Reads a TOML file over `settings`; keys that it does not name keep their values. Throws
/// InputError naming file, line, key and what was expected: unknown key, wrong type, out of range,
/// not TOML.
void loadConfig(const std::filesystem::path& path, Settings& settings);

/// Applies one `section.key=value`, value in TOML; a text may come without quotes. Throws
/// InputError.
void applyOverride(std::string_view assignment, Settings& settings);

/// Checks what no single key tells: that lower bounds lie below upper ones. After all files and
/// overrides. Throws InputError naming both keys.
void checkConsistency(const Settings& settings);

/// A configuration file with every key at its default, each with its meaning and range.
std::string documentedConfig();

/// A configuration file that sets every key to its value in `settings`.
std::string settingsAsToml(Settings settings);

}  // namespace depthscope::platform
