#include "platform/daemon/settings_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "platform/config/config_file.hpp"

namespace depthscope::platform {

UniqueFd makeSettingsFile(const Settings& settings) {
  const std::string text = settingsAsToml(settings);
  UniqueFd file(::memfd_create("depthscope.toml", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  const int seals = F_SEAL_WRITE | F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL;
  if (!file.valid() ||
      ::write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::fcntl(file.get(), F_ADD_SEALS, seals) != 0)
    throw std::system_error(errno, std::generic_category(), "settings in memory");
  return file;
}

}  // namespace depthscope::platform
