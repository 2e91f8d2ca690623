#include "platform/daemon/control_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <thread>

#include "expect_input_error.hpp"
#include "platform/tool/control_client.hpp"
#include "temporary_folder.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

/// A server that is served in a thread until the test is over.
class ControlServerTest : public ::testing::Test {
 protected:
  void serve(ControlServer::Handler handler) {
    server_ = std::make_unique<ControlServer>(path_, std::move(handler));
    thread_ = std::thread([this] {
      while (!stop_) {
        pollfd wait{server_->fd(), POLLIN, 0};
        if (::poll(&wait, 1, 10) > 0) server_->serve();
      }
    });
  }
  void TearDown() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.path() / "control.sock";
  std::unique_ptr<ControlServer> server_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_F(ControlServerTest, AnswersOneLineWithOneAnswer) {
  serve([](std::string_view line, UniqueFd) { return "ok you said " + std::string(line); });
  EXPECT_EQ(controlRequest(path_, "label a b"), "you said label a b");
  EXPECT_EQ(controlRequest(path_, "again"), "you said again");
}

TEST_F(ControlServerTest, PassesTheDaemonsRefusalOn) {
  serve([](std::string_view, UniqueFd) { return std::string("error not now"); });
  EXPECT_THAT([&] { controlRequest(path_, "x"); },
              ::testing::ThrowsMessage<std::runtime_error>("not now"));
}

TEST_F(ControlServerTest, TakesADescriptorAlong) {
  serve([](std::string_view, UniqueFd fd) {
    return ::write(fd.get(), "hello", 5) == 5 ? std::string("ok")
                                              : std::string("error no descriptor");
  });
  const auto file = folder_.write("out", "");
  FILE* out = std::fopen(file.c_str(), "w");
  EXPECT_EQ(controlRequest(path_, "export", fileno(out)), "");
  std::fclose(out);
  EXPECT_EQ(readFile(file), "hello");
}

TEST_F(ControlServerTest, AnEndlessLineIsCutOff) {
  serve([](std::string_view, UniqueFd) { return std::string("ok"); });
  EXPECT_THROW(controlRequest(path_, std::string(5000, 'x')), std::runtime_error);
  EXPECT_EQ(controlRequest(path_, "still there"), "");
}

TEST_F(ControlServerTest, TakesAStaleSocketsPlaceButNoFilesAndNoOtherDaemons) {
  serve([](std::string_view, UniqueFd) { return std::string("ok"); });
  EXPECT_INPUT_ERROR(ControlServer(path_, {}), HasSubstr("another depthscoped"));
  const std::string file = folder_.write("file", "x");
  EXPECT_INPUT_ERROR(ControlServer(file, {}), HasSubstr("is not a socket"));
  EXPECT_INPUT_ERROR(ControlServer(folder_.path() / "none" / "sock", {}), HasSubstr("none/sock"));
  EXPECT_INPUT_ERROR(ControlServer(std::string(200, 'x'), {}), HasSubstr("socket path"));
}

TEST(ControlClient, SaysWhenNoDaemonRuns) {
  const TemporaryFolder folder;
  EXPECT_INPUT_ERROR(controlRequest(folder.path() / "none.sock", "status"), HasSubstr("none.sock"),
                     HasSubstr("depthscoped"));
}

}  // namespace
}  // namespace depthscope::platform
