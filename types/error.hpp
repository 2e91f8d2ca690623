#pragma once
#include <stdexcept>
#include <string>

namespace depthscope {

/// Bad input from outside: a file, a setting, an argument. The message is one line that names what
/// and where, and what was expected. Programs print it and exit with status 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace depthscope
