#include "platform/arguments.hpp"

#include <gtest/gtest.h>

#include "expect_input_error.hpp"

namespace depthscope::platform {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Arguments, TakesOptionsInBothForms) {
  Arguments a({"--in", "x y", "--out=z=1", "--fast"});
  EXPECT_EQ(a.required("--in"), "x y");
  EXPECT_EQ(a.value("--out"), "z=1");
  EXPECT_TRUE(a.flag("--fast"));
  EXPECT_FALSE(a.flag("--fast"));
  EXPECT_NO_THROW(a.finish());
}

TEST(Arguments, KeepsTheOrderOfRepeatedOptions) {
  Arguments a({"--set", "a=1", "--set=b=2", "--set", "a=3"});
  EXPECT_THAT(a.values("--set"), ElementsAre("a=1", "b=2", "a=3"));
}

TEST(Arguments, TakesAllWordsThatAreNoOptions) {
  Arguments a({"x", "--fast", "y"});
  EXPECT_THAT(a.positionals(), ElementsAre("x", "y"));
  EXPECT_THAT(a.positionals(), ElementsAre());
  EXPECT_TRUE(a.flag("--fast"));
  EXPECT_NO_THROW(a.finish());
}

TEST(Arguments, DoesNotMistakeALongerName) {
  Arguments a({"--inputs", "x"});
  EXPECT_EQ(a.value("--input"), std::nullopt);
}

TEST(Arguments, NamesWhatIsWrong) {
  EXPECT_INPUT_ERROR(Arguments(std::vector<std::string>{}).required("--in"), HasSubstr("--in"));
  EXPECT_INPUT_ERROR(Arguments({"--in"}).value("--in"), HasSubstr("--in"), HasSubstr("value"));
  EXPECT_INPUT_ERROR(Arguments({"--in=a", "--in=b"}).value("--in"), HasSubstr("more than once"));
  EXPECT_INPUT_ERROR(Arguments({"--what"}).finish(), HasSubstr("--what"));
  EXPECT_INPUT_ERROR(Arguments({"--what"}).positional("a file"), HasSubstr("a file"));
}

}  // namespace
}  // namespace depthscope::platform
