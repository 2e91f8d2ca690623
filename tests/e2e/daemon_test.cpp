// The two processes for real, on a clip: the picture goes on whatever happens to AR.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "../platform/temporary_folder.hpp"
#include "capture/file_source.hpp"
#include "capture/pixel_convert.hpp"
#include "platform/daemon/child_process.hpp"
#include "platform/tool/control_client.hpp"
#include "platform/video_writer.hpp"
#include "program.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using Clock = std::chrono::steady_clock;

constexpr int width = 320, height = 240;

/// The start of the sample clip at half its size, so that a busy machine keeps up with it in real
/// time.
void writeSmallClip(const fs::path& path, int frames) {
  capture::FileSourceSettings settings;
  settings.path = fs::path(DEPTHSCOPE_TEST_DATA) / "sample" / "video.mp4";
  const auto source = capture::openFileSource(settings);
  VideoWriter writer(path, width, height, 10);
  std::vector<std::uint8_t> whole(4 * width * height * 4), half(width * height * 4);
  for (int i = 0; i < frames; ++i) {
    const auto read = source->read(std::chrono::seconds(5));
    ASSERT_EQ(read.status, capture::SourceStatus::Ok);
    capture::toRgba(read.frame, whole);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x)
        std::copy_n(&whole[(2 * y * 2 * width + 2 * x) * 4], 4, &half[(y * width + x) * 4]);
    writer.write({half.data(), width, height, width * 4}, i);
  }
  writer.finish();
}

class DaemonRun : public ::testing::Test {
 protected:
  static constexpr int frames = 60;

  void SetUp() override {
    writeSmallClip(folder_.path() / "clip.mp4", frames);
    folder_.write("camera.yaml",
                  "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\nfps: 10\ncamera_model: "
                  "pinhole\nfx: 228.5\nfy: 228.5\n"
                  "cx: 159.5\ncy: 119.5\nk1: 0\nk2: 0\np1: 0\np2: 0\n");
    folder_.write("depthscope.toml",
                  "[capture]\ninput = \"" + (folder_.path() / "clip.mp4").string() +
                      "\"\ncamera = \"" + (folder_.path() / "camera.yaml").string() +
                      "\"\nloop = false\n[daemon]\ncontrol_socket = \"" + socket_ +
                      "\"\nstate_dir = \"" + (folder_.path() / "state").string() +
                      "\"\nrealtime_priority = 0\nlock_memory = false\nrestart_min_s = 0.2\n");
  }
  void start(const std::vector<std::string>& more = {}) {
    log_ = std::fopen((folder_.path() / "log").c_str(), "w");
    std::vector<std::string> words{programPath("depthscoped"), "--config",
                                   folder_.path() / "depthscope.toml"};
    words.insert(words.end(), more.begin(), more.end());
    const std::array<std::pair<int, int>, 1> descriptors{{{fileno(log_), 2}}};
    daemon_ = ChildProcess(words, descriptors);
  }
  void TearDown() override {
    daemon_.kill();
    if (log_ != nullptr) std::fclose(log_);
  }
  std::string log() const { return readFile(folder_.path() / "log"); }
  std::string ask(const std::string& line) const { return controlRequest(socket_, line); }

  /// Asks for the status until `condition` holds of it; the time limit only ends a test that
  /// failed.
  template <class Condition>
  nlohmann::json waitFor(Condition&& condition) {
    const auto end = Clock::now() + std::chrono::seconds(60);
    nlohmann::json status;
    while (Clock::now() < end) {
      try {
        status = nlohmann::json::parse(ask("status"));
        if (condition(status)) return status;
      } catch (const std::exception&) {
        // not up yet
      }
      ::usleep(20000);
    }
    ADD_FAILURE() << "waited in vain; status " << status << "\n" << log();
    return status;
  }
  /// Waits for the daemon's own end and gives its exit status.
  int exitStatus() {
    int status = 0;
    const auto end = Clock::now() + std::chrono::seconds(60);
    while (!daemon_.ended(status)) {
      if (Clock::now() > end) return -1;
      ::usleep(20000);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  TemporaryFolder folder_;
  std::string socket_ = folder_.path() / "control.sock";
  ChildProcess daemon_;
  FILE* log_ = nullptr;
};

TEST_F(DaemonRun, ThePictureGoesOnWhenTheArProcessIsKilled) {
  start();
  const auto before = waitFor([](const auto& s) { return s["ar_alive"] && s["frames_shown"] > 5; });
  ASSERT_EQ(::kill(before["ar_pid"].get<pid_t>(), SIGKILL), 0);
  waitFor([&](const auto& s) {
    return s["ar_restarts"] == 1 && s["ar_alive"] && s["ar_pid"] != before["ar_pid"];
  });
  EXPECT_EQ(exitStatus(), 0) << log();
  EXPECT_THAT(log(), HasSubstr("signal 9"));
  EXPECT_THAT(log(), HasSubstr("stopped frames=" + std::to_string(frames) +
                               " skipped=0 damaged=0 given_up=0"));
}

TEST_F(DaemonRun, AHungArProcessIsReplaced) {
  start({"--set", "capture.loop=true", "--set", "daemon.heartbeat_timeout_s=4"});
  const auto before = waitFor([](const auto& s) {
    return s["ar_alive"] && s.contains("keyframes") && s["frames_shown"] > 5;
  });
  ASSERT_EQ(::kill(before["ar_pid"].get<pid_t>(), SIGSTOP), 0);
  const auto after = waitFor(
      [&](const auto& s) { return s["ar_restarts"] > before["ar_restarts"] && s["ar_alive"]; });
  EXPECT_GT(after["frames_shown"], before["frames_shown"]);
  EXPECT_THAT(log(), HasSubstr("silent for too long"));
}

TEST_F(DaemonRun, AnArProcessThatCannotStartIsTriedAgainEverLater) {
  start({"--set", "daemon.ar_program=/bin/false"});
  EXPECT_EQ(exitStatus(), 0) << log();
  EXPECT_THAT(log(), HasSubstr("restart_in_s=0.2"));
  EXPECT_THAT(log(), HasSubstr("restart_in_s=0.8"));
  EXPECT_THAT(log(), HasSubstr("stopped frames=" + std::to_string(frames) +
                               " skipped=0 damaged=0 given_up=0 tracked=0"));
}

TEST_F(DaemonRun, AnArProcessThatRunsOutOfMemoryIsReplacedAndThePictureGoesOn) {
  start({"--set", "daemon.ar_memory_mb=32"});
  EXPECT_EQ(exitStatus(), 0) << log();
  EXPECT_THAT(log(), HasSubstr("depthscope-ar failed error=std::bad_alloc"));
  EXPECT_THAT(log(), HasSubstr("AR process ended, the picture goes on how=\"exit status 1\""));
  EXPECT_THAT(log(), HasSubstr("stopped frames=" + std::to_string(frames) +
                               " skipped=0 damaged=0 given_up=0 tracked=0"));
}

TEST_F(DaemonRun, ExactRegistrationCostsNoPictureWhenTheArProcessIsKilledOrHangs) {
  start({"--set", "display.registration=exact"});
  const auto before =
      waitFor([](const auto& s) { return s["ar_alive"] && s["frames_shown"] > 15; });
  ASSERT_EQ(::kill(before["ar_pid"].get<pid_t>(), SIGKILL), 0);
  const auto after = waitFor([](const auto& s) { return s["ar_restarts"] == 1 && s["ar_alive"]; });
  ASSERT_EQ(::kill(after["ar_pid"].get<pid_t>(), SIGSTOP), 0);
  EXPECT_EQ(exitStatus(), 0) << log();
  EXPECT_THAT(log(), HasSubstr("stopped frames=" + std::to_string(frames) +
                               " skipped=0 damaged=0 given_up=0"));
}

TEST_F(DaemonRun, AnswersOnTheControlSocket) {
  start({"--set", "capture.loop=true", "--set", "recon.period_s=0"});
  waitFor([](const auto& s) { return s["ar_alive"] && s["frames_shown"] > 1; });
  const ProgramResult status = runProgram({"depthscope", "status", "--socket", socket_});
  EXPECT_EQ(status.status, 0) << status.err;
  EXPECT_THAT(status.out, HasSubstr("frames_shown"));
  const ProgramResult none =
      runProgram({"depthscope", "export", folder_.path() / "a.ply", "--socket", socket_});
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("no surface yet"));
  EXPECT_FALSE(fs::exists(folder_.path() / "a.ply"));
  const ProgramResult unknown =
      runProgram({"depthscope", "export", folder_.path() / "a.txt", "--socket", socket_});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("a.txt"));
  EXPECT_EQ(ask("overlay mesh"), "");
  EXPECT_THROW(ask("overlay rainbow"), std::runtime_error);
  EXPECT_EQ(ask("reconstruct"), "");
  EXPECT_EQ(ask("label vessel"), "");
  EXPECT_EQ(ask("label-at 10,20 vessel"), "");
  EXPECT_THROW(ask("label-at 10,2000 vessel"), std::runtime_error);
  EXPECT_EQ(ask("reset"), "");
  EXPECT_THROW(ask("fly"), std::runtime_error);
  EXPECT_GT(fs::file_size(ask("snapshot")), 1000u);
}

TEST_F(DaemonRun, MeasuresTheScaleOfItsMapAndExportsMillimetres) {
  start({"--set", "capture.loop=true", "--set", "recon.period_s=1"});
  const auto tool = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "depthscope");
    words.insert(words.end(), {"--socket", socket_});
    return runProgram(words);
  };
  const auto before =
      waitFor([](const auto& s) { return s.contains("surfaces") && s["surfaces"] > 0; });
  EXPECT_EQ(before["scale"], "up to scale");
  EXPECT_TRUE(before["mm_per_unit"].is_null());
  const ProgramResult outside = tool({"scale", "10", "100,120", "220,1200"});
  EXPECT_EQ(outside.status, 1);
  EXPECT_THAT(outside.err, HasSubstr("220,1200 is outside the picture of 320x240"));
  // A busy machine's newest pose may just be too old, and the clip starts over now and then.
  const auto measured = waitFor([&](const auto&) {
    tool({"snapshot"});
    return tool({"scale", "--in-snapshot", "40", "110,120", "210,120"}).status == 0;
  });
  (void)measured;
  const auto known = waitFor([](const auto& s) { return !s["mm_per_unit"].is_null(); });
  EXPECT_EQ(known["scale"], "40 mm between two points");
  EXPECT_GT(known["mm_per_unit"], 1);
  EXPECT_GT(known["mm_per_unit_uncertainty"], 0);
  const fs::path file = folder_.path() / "tissue.obj";
  waitFor([&](const auto&) {
    return tool({"export", file}).status == 0 &&
           readFile(file).find("in mm, scale: ") != std::string::npos;
  });
  const fs::path colored = folder_.path() / "tissue.ply";
  ASSERT_EQ(tool({"export", colored}).status, 0);
  EXPECT_THAT(readFile(colored), HasSubstr("property uchar red\n"));
  EXPECT_EQ(ask("reset"), "");
  const auto after = waitFor([](const auto& s) { return s["scale"] == "up to scale"; });
  EXPECT_TRUE(after["mm_per_unit"].is_null());
  ASSERT_EQ(tool({"export", file}).status, 0);
  EXPECT_THAT(readFile(file), HasSubstr("up to scale"));
}

TEST_F(DaemonRun, ReadsItsConfigurationAgainOnSighup) {
  start({"--set", "capture.loop=true"});
  const auto before = waitFor([](const auto& s) { return s["ar_alive"] && s["frames_shown"] > 1; });
  const std::string config = readFile(folder_.path() / "depthscope.toml");
  const auto reload = [&](const std::string& text, const std::string& logged) {
    folder_.write("depthscope.toml", text);
    ::kill(daemon_.pid(), SIGHUP);
    waitFor([&](const auto&) { return log().find(logged) != std::string::npos; });
  };
  reload(config + "[overlay]\nopacity = 0.3\n[recon]\nperiod_s = 1.5\nmin_points = 99\n",
         "applied=\"recon.period_s, overlay.opacity\" needs_restart=recon.min_points");
  reload(config + "[overlay]\nopacity = 3\n", "not read again, the old one stays in force error=");
  EXPECT_THAT(log(), HasSubstr("overlay.opacity = 3: expected a number from 0 to 1"));
  // An AR process that starts now gets the settings in force, not the broken file.
  ASSERT_EQ(::kill(before["ar_pid"].get<pid_t>(), SIGKILL), 0);
  waitFor([](const auto& s) { return s["ar_restarts"] == 1 && s.contains("keyframes"); });
  EXPECT_THAT(log(), Not(HasSubstr("cannot start")));
}

TEST_F(DaemonRun, StopsCleanlyWhenAsked) {
  start({"--set", "capture.loop=true", "--set", "display.kind=file", "--set",
         "display.path=" + (folder_.path() / "shown.mp4").string()});
  const auto status =
      waitFor([](const auto& s) { return s["ar_alive"] && s["frames_shown"] > 10; });
  ASSERT_EQ(::kill(daemon_.pid(), SIGTERM), 0);
  EXPECT_EQ(exitStatus(), 0) << log();
  EXPECT_FALSE(fs::exists(socket_));
  EXPECT_NE(::kill(status["ar_pid"].get<pid_t>(), 0), 0);
  capture::FileSourceSettings shown;
  shown.path = folder_.path() / "shown.mp4";
  EXPECT_EQ(capture::openFileSource(shown)->format().width, width);
}

TEST_F(DaemonRun, TheArProcessDoesNotOutliveTheDaemon) {
  start({"--set", "capture.loop=true"});
  const auto status =
      waitFor([](const auto& s) { return s["ar_alive"] && s.contains("keyframes"); });
  daemon_.kill();
  const auto end = Clock::now() + std::chrono::seconds(20);
  const pid_t pid = status["ar_pid"].get<pid_t>();
  // A zombie that nobody reaps in a container still counts as gone.
  const auto gone = [&] {
    const std::string stat = readFile("/proc/" + std::to_string(pid) + "/stat");
    return stat.empty() || stat.find(") Z") != std::string::npos;
  };
  while (!gone() && Clock::now() < end) ::usleep(20000);
  EXPECT_TRUE(gone());
}

TEST(DaemonArguments, ChecksAConfigurationWithoutRunning) {
  const TemporaryFolder folder;
  const ProgramResult good =
      runProgram({"depthscoped", "--check",
                  folder.write("a.toml", "[overlay]\nopacity = 0.5\n[capture]\ninput = \"a\"\n")});
  EXPECT_EQ(good.status, 0) << good.err;
  const ProgramResult bad =
      runProgram({"depthscoped", "--check", folder.write("b.toml", "[overlay]\nopacity = 5\n")});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("b.toml:2: overlay.opacity = 5: expected a number from 0 to 1"));
  EXPECT_EQ(runProgram({"depthscoped"}).status, 2);
  EXPECT_EQ(runProgram({"depthscoped", "--version"}).status, 0);
}

TEST(DaemonArguments, TheInstalledConfigurationIsSound) {
  const ProgramResult result = runProgram({"depthscoped", "--print-config"});
  EXPECT_EQ(result.status, 0);
  const TemporaryFolder folder;
  // The defaults name no source of pictures.
  std::string documented = result.out;
  const std::string input = "#input = \"\"";
  ASSERT_NE(documented.find(input), std::string::npos);
  documented.replace(documented.find(input), input.size(), "input = \"clip.mp4\"");
  EXPECT_EQ(runProgram({"depthscoped", "--check", folder.write("a.toml", documented)}).status, 0);
  // The shipped file names files that are there once installed: they are looked at in the source
  // tree here.
  std::string shipped = readFile(fs::canonical(DEPTHSCOPE_TEST_DATA).parent_path().parent_path() /
                                 "systemd" / "depthscope.toml");
  ASSERT_FALSE(shipped.empty());
  const std::string prefix = "@CMAKE_INSTALL_FULL_DATADIR@/depthscope";
  for (std::size_t at = shipped.find(prefix); at != std::string::npos; at = shipped.find(prefix))
    shipped.replace(at, prefix.size(), DEPTHSCOPE_TEST_DATA);
  const ProgramResult checked =
      runProgram({"depthscoped", "--check", folder.write("b.toml", shipped)});
  EXPECT_EQ(checked.status, 0) << checked.err;
}

}  // namespace
}  // namespace depthscope::platform
