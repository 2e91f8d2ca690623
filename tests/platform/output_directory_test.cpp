#include "platform/replay/output_directory.hpp"

#include <gtest/gtest.h>

#include "expect_input_error.hpp"
#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::vector<std::string> listing(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

TEST(OutputDirectory, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  {
    OutputDirectory out(folder.path() / "a" / "b");
    std::ofstream(out.file("x.txt")) << "half";
    EXPECT_TRUE(fs::exists(out.file("x.txt")));
  }
  EXPECT_TRUE(listing(folder.path()).empty());
}

TEST(OutputDirectory, KeepsAFolderThatWasThereBefore) {
  const TemporaryFolder folder;
  folder.write("mine.txt", "keep");
  { const OutputDirectory out(folder.path()); }
  EXPECT_THAT(listing(folder.path()), ::testing::ElementsAre("mine.txt"));
}

TEST(OutputDirectory, CommitMovesFilesAndRemovesThoseOfAnEarlierRun) {
  const TemporaryFolder folder;
  folder.write("old.txt", "old");
  folder.write("new.txt", "old");
  folder.write("mine.txt", "keep");
  {
    OutputDirectory out(folder.path());
    std::ofstream(out.file("new.txt")) << "new";
    out.commit({"old.txt", "new.txt"});
  }
  EXPECT_THAT(listing(folder.path()), ::testing::UnorderedElementsAre("new.txt", "mine.txt"));
  EXPECT_EQ(readFile(folder.path() / "new.txt"), "new");
}

TEST(OutputDirectory, TakesATrailingSlash) {
  const TemporaryFolder folder;
  OutputDirectory out(folder.path() / "a" / "");
  out.commit({});
  EXPECT_TRUE(fs::is_directory(folder.path() / "a"));
}

TEST(OutputDirectory, NamesAFolderThatCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("file", "x");
  EXPECT_INPUT_ERROR(OutputDirectory{file}, HasSubstr("file"), HasSubstr("expected a folder"));
  EXPECT_INPUT_ERROR(OutputDirectory{file / "below"}, HasSubstr("file/below"));
  EXPECT_INPUT_ERROR(OutputDirectory{"/proc/depthscope/out"}, HasSubstr("/proc/depthscope/out"));
  EXPECT_THAT(listing(folder.path()), ::testing::ElementsAre("file"));
}

}  // namespace
}  // namespace depthscope::platform
