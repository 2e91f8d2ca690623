#include "platform/log.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

TEST(Log, WritesMessageAndFields) {
  EXPECT_EQ(formatLogLine(LogPriority::Info, "child started",
                          {{"pid", 12}, {"rate", 2.5}, {"ok", true}}, false),
            "child started pid=12 rate=2.5 ok=true");
}

TEST(Log, StartsWithThePriorityUnderTheJournal) {
  EXPECT_EQ(formatLogLine(LogPriority::Warning, "late", {}, true), "<4>late");
}

TEST(Log, QuotesWhatHasSpacesAndKeepsOneLine) {
  EXPECT_EQ(formatLogLine(LogPriority::Error, "a\nb",
                          {{"why", "no \"such\" file\n"}, {"empty", ""}}, false),
            "a?b why=\"no \\\"such\\\" file?\" empty=\"\"");
}

}  // namespace
}  // namespace depthscope::platform
