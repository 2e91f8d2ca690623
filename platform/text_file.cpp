#include "platform/text_file.hpp"

#include <fstream>
#include <iterator>

#include "types/error.hpp"

namespace depthscope::platform {

std::string readTextFile(const std::filesystem::path& path, const char* expected) {
  constexpr std::size_t longest =
      1 << 20;  // a device or a video given by mistake must not fill the memory
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  std::ifstream in(path, std::ios::binary);
  std::string text;
  if (regular && in)
    for (auto c = std::istreambuf_iterator<char>(in);
         c != std::istreambuf_iterator<char>() && text.size() <= longest; ++c)
      text += *c;
  if (!regular || !in || text.size() > longest)
    throw InputError(path.string() + ": cannot be read, expected " + expected);
  return text;
}

}  // namespace depthscope::platform
