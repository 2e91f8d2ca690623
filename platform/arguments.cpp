#include "platform/arguments.hpp"

#include <algorithm>

#include "types/error.hpp"

namespace depthscope::platform {

bool Arguments::flag(std::string_view name) {
  return std::erase(words_, name) > 0;
}

std::vector<std::string> Arguments::values(std::string_view name) {
  std::vector<std::string> found;
  for (auto word = words_.begin(); word != words_.end();) {
    if (*word == name) {
      if (word + 1 == words_.end())
        throw InputError(std::string(name) + ": expected a value after it");
      found.push_back(word[1]);
      word = words_.erase(word, word + 2);
    } else if (word->size() > name.size() && word->starts_with(name) &&
               (*word)[name.size()] == '=') {
      found.push_back(word->substr(name.size() + 1));
      word = words_.erase(word);
    } else {
      ++word;
    }
  }
  return found;
}

std::optional<std::string> Arguments::value(std::string_view name) {
  auto found = values(name);
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) throw InputError(std::string(name) + ": given more than once");
  return std::move(found.front());
}

std::string Arguments::required(std::string_view name) {
  auto found = value(name);
  if (!found) throw InputError(std::string(name) + ": is missing (see --help)");
  return *found;
}

std::string Arguments::positional(std::string_view what) {
  const auto word = std::find_if(words_.begin(), words_.end(),
                                 [](const std::string& w) { return !w.starts_with("--"); });
  if (word == words_.end()) throw InputError("expected " + std::string(what) + " (see --help)");
  std::string taken = std::move(*word);
  words_.erase(word);
  return taken;
}

std::vector<std::string> Arguments::positionals() {
  const auto options = std::stable_partition(
      words_.begin(), words_.end(), [](const std::string& w) { return !w.starts_with("--"); });
  std::vector<std::string> taken(words_.begin(), options);
  words_.erase(words_.begin(), options);
  return taken;
}

void Arguments::finish() const {
  if (!words_.empty()) throw InputError(words_.front() + ": unknown argument (see --help)");
}

}  // namespace depthscope::platform
