#include "platform/utf8.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

TEST(Utf8, TakesPrintableTexts) {
  EXPECT_TRUE(isPrintableUtf8(""));
  EXPECT_TRUE(isPrintableUtf8("tumour margin"));
  EXPECT_TRUE(isPrintableUtf8("Gef\xC3\xA4\xC3\x9F \xE2\x86\x92 \xF0\x9F\xA9\xBA"));
}

TEST(Utf8, RefusesControlsAndWhatIsNotWellFormed) {
  for (const char* text : {"\n", "\x7F", "\x1B[0m", "\x80", "\xC3", "\xC3(", "\xC0\xAF", "\xC1\xBF",
                           "\xC2\x85", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                           "\xF8\x88\x80\x80\x80", "\xFF", "\xE2\x86"})
    EXPECT_FALSE(isPrintableUtf8(text)) << text;
}

TEST(Utf8, CutsBetweenCharacters) {
  EXPECT_EQ(utf8Prefix("abc", 5), "abc");
  EXPECT_EQ(utf8Prefix("abc", 2), "ab");
  EXPECT_EQ(utf8Prefix("a\xE2\x86\x92", 3), "a");
  EXPECT_EQ(utf8Prefix("a\xE2\x86\x92", 4), "a\xE2\x86\x92");
}

}  // namespace
}  // namespace depthscope::platform
