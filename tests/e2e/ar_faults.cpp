// Plays a clip of 1280x720 through the daemon at 30 pictures a second while the AR process is
// killed and stopped again and again, and looks at the daemon's own record of every picture: none
// dropped, none repeated, the first one there within a second, the overlay gone within its age
// limit each time, and back afterwards.
//
//   ar_faults [SECONDS [KILLS [STOPS [SPARED_MS]]]]     60 20 5 0 when nothing is said
//
// SPARED_MS is for machines that others use too: for so long in all the machine may have kept the
// processor from the daemon (pictures that the source passed over for that reason, and a later
// start).
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "capture/file_source.hpp"
#include "capture/pixel_convert.hpp"
#include "overlay/overlay_state.hpp"
#include "platform/camera_file.hpp"
#include "platform/daemon/child_process.hpp"
#include "platform/tool/control_client.hpp"
#include "platform/video_writer.hpp"
#include "tests/e2e/program.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr int width = 1280, height = 720;
constexpr int tracking = static_cast<int>(overlay::Status::Tracking);
constexpr long long age_limit_us = 120000;

struct Picture {
  long sequence = 0;
  long long captured_us = 0, submitted_us = 0;
  int status = 0;
  bool overlay = false;  // something that hangs on a pose lies over it, be it fading
};

struct Fault {
  const char* kind;
  long long at_us, over_us;  // begun; AR could come back from here on
};

long long nowUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
      .count();
}

/// The sample clip, stretched to the size, and its camera.
void makeClip(const fs::path& folder) {
  const fs::path sample = fs::path(DEPTHSCOPE_TEST_DATA) / "sample";
  const CameraModel camera = loadCameraFile(sample / "camera.yaml");
  const double sx = static_cast<double>(width) / camera.width,
               sy = static_cast<double>(height) / camera.height;
  std::ofstream(folder / "camera.yaml")
      << "%YAML:1.0\n---\nimage_width: " << width << "\nimage_height: " << height
      << "\nfps: 30\ncamera_model: pinhole\nfx: " << camera.fx * sx << "\nfy: " << camera.fy * sy
      << "\ncx: " << (camera.cx + 0.5) * sx - 0.5 << "\ncy: " << (camera.cy + 0.5) * sy - 0.5
      << "\nk1: 0\nk2: 0\np1: 0\np2: 0\n";
  capture::FileSourceSettings settings;
  settings.path = sample / "video.mp4";
  const auto source = capture::openFileSource(settings);
  VideoWriter writer(folder / "clip.mp4", width, height, 30);
  std::vector<std::uint8_t> from(static_cast<std::size_t>(camera.width * camera.height) * 4),
      to(static_cast<std::size_t>(width * height) * 4);
  for (std::int64_t i = 0;; ++i) {
    const auto result = source->read(std::chrono::seconds(1));
    if (result.status != capture::SourceStatus::Ok) break;
    capture::toRgba(result.frame, from);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int fx = x * camera.width / width, fy = y * camera.height / height;
        std::copy_n(&from[static_cast<std::size_t>(fy * camera.width + fx) * 4], 4,
                    &to[static_cast<std::size_t>(y * width + x) * 4]);
      }
    writer.write({to.data(), width, height, width * 4}, i);
  }
  writer.finish();
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found(1);
  for (char c : line)
    if (c == ',')
      found.emplace_back();
    else
      found.back() += c;
  return found;
}

/// The daemon's record of the pictures that went out, by the names of its columns.
std::vector<Picture> readLog(const fs::path& file) {
  std::vector<Picture> pictures;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = cells(line);
  while (std::getline(in, line)) {
    const std::vector<std::string> values = cells(line);
    if (values.size() != names.size()) continue;  // a remark
    const auto value = [&](const char* name) -> const std::string& {
      return values.at(
          static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
    };
    Picture p;
    p.sequence = std::stol(value("sequence"));
    p.captured_us = std::stoll(value("captured_us"));
    p.submitted_us = p.captured_us + std::stoll(value("submitted_us"));
    p.status = std::stoi(value("overlay_status"));
    p.overlay = !value("overlay_age_ms").empty();
    pictures.push_back(p);
  }
  return pictures;
}

json status(const std::string& socket) {
  try {
    return json::parse(controlRequest(socket, "status"));
  } catch (const std::exception&) {
    return json::object();
  }
}

/// Waits until the overlay is up; false when it does not come.
bool waitForOverlay(const std::string& socket, std::chrono::seconds limit) {
  for (const auto end = Clock::now() + limit; Clock::now() < end; ::usleep(20000))
    if (status(socket).value("overlay", "") == "tracking") return true;
  return false;
}

class Run {
 public:
  Run(double seconds, int kills, int stops, double spared_ms)
      : seconds_(seconds), kills_(kills), stops_(stops), spared_ms_(spared_ms) {
    std::string pattern = (fs::temp_directory_path() / "ar-faults-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~Run() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  int go();

 private:
  void breakThings(const std::string& socket);
  int judge(const json& last);

  double seconds_;
  int kills_, stops_;
  double spared_ms_;
  fs::path folder_;
  long long started_us_ = 0;
  std::vector<Fault> faults_;
};

/// Faults evenly over the time, each once the overlay is up again.
void Run::breakThings(const std::string& socket) {
  const int total = kills_ + stops_;
  const auto start = Clock::now();
  for (int i = 0; i < total; ++i) {
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(seconds_ * i / total)));
    if (!waitForOverlay(socket, std::chrono::seconds(20))) return;
    const pid_t pid = status(socket).value("ar_pid", -1);
    if (pid <= 0) return;
    const bool stop = i * stops_ / total != (i + 1) * stops_ / total;
    const long long at = nowUs();
    ::kill(pid, stop ? SIGSTOP : SIGKILL);
    if (stop) ::usleep(600000);
    faults_.push_back({stop ? "stopped" : "killed", at, stop ? nowUs() : at + 150000});
    if (stop) ::kill(pid, SIGCONT);
  }
  std::this_thread::sleep_until(
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_)));
}

int Run::judge(const json& last) {
  const std::vector<Picture> pictures = readLog(folder_ / "frames.csv");
  long dropped = 0, repeated = 0;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    const long step = pictures[i].sequence - pictures[i - 1].sequence;
    if (step > 1) dropped += step - 1;
    if (step < 1) ++repeated;
  }
  const double first_ms =
      pictures.empty() ? 1e9 : static_cast<double>(pictures[0].submitted_us - started_us_) / 1000;
  std::printf("first picture %.0f ms after the start of the process\n", first_ms);
  int late = 0, gone = 0;
  long long longest_us = 0;
  for (const Fault& fault : faults_) {
    long long overlay_until = fault.at_us;
    bool back = false;
    for (const Picture& p : pictures) {
      if (p.captured_us < fault.at_us) continue;
      if (p.captured_us >= fault.over_us)
        back |= p.status == tracking;
      else if (p.overlay)
        overlay_until = p.captured_us;
    }
    longest_us = std::max(longest_us, overlay_until - fault.at_us);
    late += overlay_until - fault.at_us > age_limit_us;
    gone += !back;
  }
  std::printf("pictures %zu, dropped %ld, repeated %ld, not taken by the display %ld\n",
              pictures.size(), dropped, repeated, last.value("frames_given_up", -1L));
  std::printf(
      "faults %zu of %d, overlay gone after at most %.0f ms, late %d times, not back %d times\n",
      faults_.size(), kills_ + stops_, static_cast<double>(longest_us) / 1000, late, gone);
  std::printf("video delay %s\noverlay age %s\nstages %s\n", last["video_delay_ms"].dump().c_str(),
              last["overlay_age_ms"].dump().c_str(), last["stages_ms"].dump().c_str());
  const double passed_over_ms = static_cast<double>(dropped) * 1000 / 30;
  const bool good = passed_over_ms <= spared_ms_ && repeated == 0 &&
                    last.value("frames_given_up", -1L) == 0 && first_ms <= 1000 + spared_ms_ &&
                    late == 0 && gone == 0 && static_cast<int>(faults_.size()) == kills_ + stops_;
  std::printf("%s\n", good ? "as promised" : "NOT as promised");
  return good ? 0 : 1;
}

int Run::go() {
  makeClip(folder_);
  const std::string socket = folder_ / "control.sock";
  std::ofstream(folder_ / "depthscope.toml")
      << "[capture]\ninput = \"" << (folder_ / "clip.mp4").string() << "\"\ncamera = \""
      << (folder_ / "camera.yaml").string() << "\"\n[daemon]\ncontrol_socket = \"" << socket
      << "\"\nstate_dir = \"" << folder_.string() << "\"\nframe_log = \""
      << (folder_ / "frames.csv").string() << "\"\nrestart_max_s = 0.2\nlock_memory = false\n";
  started_us_ = nowUs();
  ChildProcess daemon({programPath("depthscoped"), "--config", folder_ / "depthscope.toml"}, {});
  if (!waitForOverlay(socket, std::chrono::seconds(30))) {
    std::fprintf(stderr, "ar_faults: no overlay within 30 s\n");
    return 1;
  }
  breakThings(socket);
  waitForOverlay(socket, std::chrono::seconds(20));
  ::usleep(1500000);  // for the summary to be brought up to date
  const json last = status(socket);
  ::kill(daemon.pid(), SIGTERM);
  int end = 0;
  for (int i = 0; i < 200 && !daemon.ended(end); ++i) ::usleep(20000);
  return judge(last);
}

}  // namespace
}  // namespace depthscope::platform

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60;
  const int kills = argc > 2 ? std::atoi(argv[2]) : 20, stops = argc > 3 ? std::atoi(argv[3]) : 5;
  const double spared_ms = argc > 4 ? std::atof(argv[4]) : 0;
  try {
    return depthscope::platform::Run(seconds, kills, stops, spared_ms).go();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ar_faults: %s\n", error.what());
    return 1;
  }
}
