#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace depthscope::platform {

/// A command line, taken apart by asking for what is known; what is left at the end is an error.
/// Options with a value are given as `--name VALUE` or `--name=VALUE`.
class Arguments {
 public:
  explicit Arguments(std::vector<std::string> words) : words_(std::move(words)) {}
  Arguments(int argc, char** argv) : words_(argv + 1, argv + argc) {}

  /// Whether the flag is there.
  bool flag(std::string_view name);
  /// The option's value, if it is there. Throws InputError when it is given twice or without a
  /// value.
  std::optional<std::string> value(std::string_view name);
  /// The option's values, in order.
  std::vector<std::string> values(std::string_view name);
  /// Like value(). Throws InputError naming the option when it is missing.
  std::string required(std::string_view name);
  /// The next word that is no option. Throws InputError saying that `what` was expected.
  std::string positional(std::string_view what);
  /// All words left that are no options, in order.
  std::vector<std::string> positionals();
  /// Throws InputError naming the first word that nobody asked for.
  void finish() const;

 private:
  std::vector<std::string> words_;
};

}  // namespace depthscope::platform
