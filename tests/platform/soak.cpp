// Runs the picture's whole way, capture card to monitor and overlay, on a kernel in memory for
// hours of simulated time, and looks at what the process holds: memory, descriptors, threads. What
// it holds when warm is what it must hold at the end.
//
//   soak [HOURS]     2 when nothing is said
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "platform/ipc/frame_ring.hpp"
#include "platform/ipc/surface_mailbox.hpp"
#include "tests/platform/direct_layers.hpp"
#include "tests/platform/simulated_box.hpp"
#include "tests/types/grid_mesh.hpp"

namespace depthscope::platform {
namespace {

// Turns after which everything comes again. Only the same moments of two cycles can be compared.
constexpr std::uint64_t cycle_turns = 4000;
constexpr int warm_cycles = 3;
// The graphics driver holds a block of 1 MiB more at some moments than at others. The least of a
// few cycles leaves it out; a short run has too few of them, and is only a look at descriptors,
// threads and gross leaks.
constexpr std::size_t cycles_of_a_long_run = 20;
struct Slack {
  std::size_t heap_bytes;
  long resident_kb;
};
// Once in a while a rare moment touches pages for the first time; 2 MiB over hours are still less
// than 3 kB for each new surface.
constexpr Slack long_slack{256 << 10, 2048}, short_slack{3 << 20, 4096};

struct Held {
  std::size_t heap_bytes = 0;
  long resident_kb = 0;
  long descriptors = 0, threads = 0;
};

long entries(const char* folder) {
  return std::distance(std::filesystem::directory_iterator(folder),
                       std::filesystem::directory_iterator());
}

Held measure() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return {mallinfo2().uordblks, resident * 4, entries("/proc/self/fd"), entries("/proc/self/task")};
}

/// The least of each that was held at one of these moments.
Held least(std::span<const Held> moments) {
  Held held = moments[0];
  for (const Held& moment : moments) {
    held.heap_bytes = std::min(held.heap_bytes, moment.heap_bytes);
    held.resident_kb = std::min(held.resident_kb, moment.resident_kb);
    held.descriptors = std::min(held.descriptors, moment.descriptors);
    held.threads = std::min(held.threads, moment.threads);
  }
  return held;
}

/// Whether the last quarter of the moments holds no more than the first one.
bool isFlat(std::span<const Held> moments) {
  const std::size_t quarter = (moments.size() + 3) / 4;
  const Held early = least(moments.first(quarter)), late = least(moments.last(quarter));
  const Slack& slack = moments.size() >= cycles_of_a_long_run ? long_slack : short_slack;
  std::printf("from the first quarter to the last: heap %+ld bytes, resident %+ld kB\n",
              static_cast<long>(late.heap_bytes) - static_cast<long>(early.heap_bytes),
              late.resident_kb - early.resident_kb);
  return late.heap_bytes <= early.heap_bytes + slack.heap_bytes &&
         late.resident_kb <= early.resident_kb + slack.resident_kb &&
         late.descriptors == early.descriptors && late.threads == early.threads;
}

void print(const char* when, double hours, const Held& held) {
  std::printf("%-8s %6.2f h: heap %zu bytes, resident %ld kB, %ld descriptors, %ld threads\n", when,
              hours, held.heap_bytes, held.resident_kb, held.descriptors, held.threads);
}

CameraModel boxCamera() {
  CameraModel camera;
  camera.width = box_width;
  camera.height = box_height;
  camera.fx = camera.fy = 50;
  camera.cx = 31.5;
  camera.cy = 23.5;
  return camera;
}

/// Plays the AR process: finds every picture at once, has a new surface now and then, goes away and
/// comes back.
class ArPlayer {
 public:
  explicit ArPlayer(SimulatedBox& box)
      : box_(box),
        frames_(box.memory),
        surfaces_(box.memory),
        pixels_(box_width * box_height),
        color_(box.memory.colorSize().pixels()) {
    mesh_ = gridMesh(
        8, [](float u, float v) { return Eigen::Vector3f(-10 + 20 * u, -5 + 16 * v, 50 + 8 * u); });
  }
  void play() {
    ++turns_;
    box_.link.setAlive(turns_ % cycle_turns > 100);
    WireFrameInfo info;
    if (!frames_.takeNewest(pixels_, color_, info)) return;
    PoseEstimate pose;
    pose.frame = info.frame;
    pose.state = TrackingState::Tracking;
    pose.confidence = 1;
    box_.memory.block().pose.write(encodePose(pose));
    if (turns_ % 400 != 0) return;
    ++mesh_.version;
    surfaces_.publish(mesh_);
  }

 private:
  SimulatedBox& box_;
  FrameRingReader frames_;
  SurfaceMailboxWriter surfaces_;
  std::vector<std::uint8_t> pixels_;
  std::vector<Rgb> color_;
  SurfaceMesh mesh_;
  std::uint64_t turns_ = 0;
};

/// Every way in which things go wrong, over and over.
void upset(SimulatedBox& box, std::uint64_t turn) {
  using Signal = FakeV4l2Card::Signal;
  switch (turn % cycle_turns) {
    case 500:
      return box.card.setSignal(Signal::Missing);
    case 550:
      return box.card.setSignal(Signal::Good);
    case 1000:
      return box.card.disconnect();
    case 1050:
      return box.card.reconnect();
    case 1500:
      return box.monitor.setConnected(0, false);
    case 1550:
      return box.monitor.setConnected(0, true);
    case 2000:
      return box.card.setMode(fake::timingsSmall(80, 60, 50));
    case 3000:
      return box.card.setMode(fake::timingsSmall(box_width, box_height, box_rate));
    default:
      return;
  }
}

int soak(double hours) {
  SimulatedBox box;
  LayerPainter painter(boxCamera(), {}, box.link, box.requests);
  DirectLayers layers(painter);
  ArPlayer ar(box);
  box.start(&layers);
  const Time start = box.kernel.now();
  const auto elapsed_h = [&] {
    return std::chrono::duration<double>(box.kernel.now() - start).count() / 3600;
  };
  std::vector<Held> moments;
  moments.reserve(10000);
  for (int cycle = 1; cycle <= warm_cycles || elapsed_h() < hours; ++cycle) {
    for (std::uint64_t turn = 0; turn < cycle_turns; ++turn) {
      upset(box, turn);
      ar.play();
      box.turn();
    }
    if (cycle < warm_cycles) continue;
    moments.push_back(measure());
    print(cycle == warm_cycles ? "warm" : "", elapsed_h(), moments.back());
  }
  std::printf("%llu pictures shown, %llu fault pictures\n",
              static_cast<unsigned long long>(box.report.frames.load()),
              static_cast<unsigned long long>(box.report.faults.load()));
  const bool flat = isFlat(moments);
  std::printf("%s\n", flat ? "flat" : "GROWS");
  return flat && !testing::Test::HasFailure() ? 0 : 1;
}

}  // namespace
}  // namespace depthscope::platform

int main(int argc, char** argv) {
  return depthscope::platform::soak(argc > 1 ? std::atof(argv[1]) : 2);
}
