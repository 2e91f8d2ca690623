#include "platform/journal.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

TEST(Journal, AnEntryHasTheLineAndEachFieldApart) {
  EXPECT_EQ(journalEntry(LogPriority::Warning, "depthscoped", "AR process ended",
                         {{"how", "signal 9"}, {"restart_in_s", 0.5}}),
            "PRIORITY=4\nSYSLOG_IDENTIFIER=depthscoped\n"
            "MESSAGE=AR process ended how=\"signal 9\" restart_in_s=0.5\n"
            "DEPTHSCOPE_EVENT=AR process ended\nDEPTHSCOPE_HOW=signal 9\n"
            "DEPTHSCOPE_RESTART_IN_S=0.5\n");
}

TEST(Journal, NoValueCanForgeAField) {
  const std::string entry =
      journalEntry(LogPriority::Info, "d", "a\nPRIORITY=0", {{"odd-key", "x\nMESSAGE=y"}});
  EXPECT_EQ(entry,
            "PRIORITY=6\nSYSLOG_IDENTIFIER=d\nMESSAGE=a?PRIORITY=0 odd-key=\"x?MESSAGE=y\"\n"
            "DEPTHSCOPE_EVENT=a?PRIORITY=0\nDEPTHSCOPE_ODD_KEY=x?MESSAGE=y\n");
}

class JournalSocket : public ::testing::Test {
 protected:
  void listen() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(server_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }
  TemporaryFolder folder_;
  std::string path_ = folder_.path() / "journal";
  UniqueFd server_{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
};

TEST_F(JournalSocket, TakesAnEntryAsOneDatagram) {
  listen();
  EXPECT_TRUE(Journal(path_.c_str()).send("MESSAGE=a\nB=c\n"));
  char buffer[64];
  const ssize_t got = ::recv(server_.get(), buffer, sizeof buffer, MSG_DONTWAIT);
  EXPECT_EQ(std::string(buffer, got > 0 ? static_cast<std::size_t>(got) : 0), "MESSAGE=a\nB=c\n");
}

TEST_F(JournalSocket, AFullJournalIsNotWaitedFor) {
  listen();
  const Journal journal(path_.c_str());
  int taken = 0;
  while (taken < 100000 && journal.send("MESSAGE=a\n")) ++taken;
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, 100000);
}

TEST_F(JournalSocket, WithoutAJournalNothingIsTaken) {
  EXPECT_FALSE(Journal(path_.c_str()).send("MESSAGE=a\n"));
}

}  // namespace
}  // namespace depthscope::platform
