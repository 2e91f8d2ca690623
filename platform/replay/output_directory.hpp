#pragma once
#include <filesystem>
#include <string_view>
#include <vector>

namespace depthscope::platform {

/// A folder that gets all of a run's files or none: they are written into a hidden folder inside it
/// and moved to their places by commit(). Without commit() the destructor removes everything it
/// made.
class OutputDirectory {
 public:
  /// Makes the folder where it is missing. Throws InputError when it cannot be written to.
  explicit OutputDirectory(const std::filesystem::path& path);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  /// Where to write the file `name` until commit().
  std::filesystem::path file(std::string_view name) const { return partial_ / name; }
  /// Moves the files to their places. Files of an earlier run among `names` that this run did not
  /// write are removed, so that results of two runs never mix. Throws
  /// std::filesystem::filesystem_error.
  void commit(const std::vector<std::string_view>& names);

 private:
  std::filesystem::path path_, partial_;
  std::vector<std::filesystem::path> made_;  // folders made on the way, outermost first
  bool committed_ = false;
};

}  // namespace depthscope::platform
