#include "platform/replay/output_directory.hpp"

#include <stdlib.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "types/error.hpp"

namespace depthscope::platform {
namespace fs = std::filesystem;
namespace {

void removeMade(const std::vector<fs::path>& made) {
  std::error_code ignored;
  for (auto folder = made.rbegin(); folder != made.rend(); ++folder) fs::remove(*folder, ignored);
}

}  // namespace

OutputDirectory::OutputDirectory(const fs::path& path)
    : path_(fs::absolute(path).lexically_normal()) {
  const auto fail = [&](const std::string& why) {
    removeMade(made_);
    throw InputError(path.string() + ": cannot be written: " + why +
                     ", expected a folder to write to");
  };
  std::error_code error;
  fs::path walked;
  for (const fs::path& part : path_) {
    walked /= part;
    if (!fs::exists(walked, error) && !error) {
      if (fs::create_directory(walked, error)) made_.push_back(walked);
    }
    if (error) fail(error.message());
  }
  std::string pattern = (path_ / ".depthscope-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr)
    fail(std::error_code(errno, std::generic_category()).message());
  partial_ = pattern;
}

OutputDirectory::~OutputDirectory() {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
  if (!committed_) removeMade(made_);
}

void OutputDirectory::commit(const std::vector<std::string_view>& names) {
  for (std::string_view name : names) {
    if (fs::exists(file(name)))
      fs::rename(file(name), path_ / name);
    else
      fs::remove(path_ / name);
  }
  committed_ = true;
}

}  // namespace depthscope::platform
