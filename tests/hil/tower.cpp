// tower DEVICE FRAMES: stands for the endoscope tower. Sends the pictures of a file (640x480, YUYV,
// rows packed) into vivid's output, forth and back without an end. An emulated processor has no
// rate that it could be held to, so the tower goes by what the box says of itself: the next picture
// comes when AR has seen this one, and the scope moves by so much from one picture that AR sees to
// the next, however long AR takes. Where no AR runs a picture stays for a second. The newest one
// stays on the line until the next comes, also while this program is stopped (SIGSTOP).
#include <fcntl.h>
#include <linux/v4l2-dv-timings.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "platform/config/settings.hpp"
#include "platform/tool/control_client.hpp"

namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t width = 640, height = 480, frame_bytes = width * height * 2;
constexpr std::uint32_t buffer_count = 4;

void call(int fd, unsigned long request, void* argument, const char* name) {
  if (::ioctl(fd, request, argument) != 0)
    throw std::system_error(errno, std::generic_category(), name);
}

void setMode(int fd) {
  v4l2_dv_timings timings = V4L2_DV_BT_CEA_640X480P59_94;
  call(fd, VIDIOC_S_DV_TIMINGS, &timings, "VIDIOC_S_DV_TIMINGS");
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = width;
  format.fmt.pix.height = height;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_YUYV;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.colorspace = V4L2_COLORSPACE_SMPTE170M;
  call(fd, VIDIOC_S_FMT, &format, "VIDIOC_S_FMT");
  if (format.fmt.pix.width != width || format.fmt.pix.height != height ||
      format.fmt.pix.bytesperline != width * 2)
    throw std::system_error(EINVAL, std::generic_category(), "size refused");
}

std::vector<std::uint8_t*> mapBuffers(int fd) {
  v4l2_requestbuffers request{};
  request.count = buffer_count;
  request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  request.memory = V4L2_MEMORY_MMAP;
  call(fd, VIDIOC_REQBUFS, &request, "VIDIOC_REQBUFS");
  std::vector<std::uint8_t*> buffers;
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer{};
    buffer.index = i;
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    call(fd, VIDIOC_QUERYBUF, &buffer, "VIDIOC_QUERYBUF");
    void* memory =
        ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, buffer.m.offset);
    if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
    buffers.push_back(static_cast<std::uint8_t*>(memory));
  }
  return buffers;
}

/// A buffer that the driver is done with: one never used, then those that come back.
std::uint32_t freeBuffer(int fd, std::uint32_t& used, std::size_t count) {
  if (used < count) return used++;
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  buffer.memory = V4L2_MEMORY_MMAP;
  call(fd, VIDIOC_DQBUF, &buffer, "VIDIOC_DQBUF");
  return buffer.index;
}

/// How many pictures the AR process has worked through; nothing where none runs.
std::optional<std::int64_t> picturesSeenByAr() {
  using namespace depthscope::platform;
  try {
    const auto status =
        nlohmann::json::parse(controlRequest(DaemonSettings().control_socket, "status"));
    if (status.contains("ar_frames")) return status["ar_frames"].get<std::int64_t>();
  } catch (const std::exception&) {
    // No daemon, or one that is just starting or ending.
  }
  return std::nullopt;
}

/// Until AR has worked through a picture that it took after this call. The first one to be counted
/// may be of before.
void waitForAr() {
  constexpr std::int64_t pictures = 2;
  const auto second = std::chrono::steady_clock::now() + 1s;
  const auto before = picturesSeenByAr();
  for (;;) {
    std::this_thread::sleep_for(100ms);
    const auto seen = picturesSeenByAr();
    const bool same_process = before && seen && *seen >= *before;
    if (same_process ? *seen >= *before + pictures : std::chrono::steady_clock::now() >= second)
      return;
  }
}

void play(int fd, std::ifstream& frames) {
  const auto buffers = mapBuffers(fd);
  frames.seekg(0, std::ios::end);
  const auto count = static_cast<std::int64_t>(frames.tellg()) / frame_bytes;
  if (count < 1)
    throw std::system_error(EINVAL, std::generic_category(), "no pictures in the file");
  std::uint32_t used = 0;
  for (std::int64_t step = 0;; ++step) {
    const std::int64_t round = std::max<std::int64_t>(1, 2 * (count - 1)), position = step % round;
    const std::int64_t frame = std::min(position, round - position);
    const std::uint32_t index = freeBuffer(fd, used, buffers.size());
    frames.seekg(frame * frame_bytes);
    frames.read(reinterpret_cast<char*>(buffers[index]), frame_bytes);
    v4l2_buffer buffer{};
    buffer.index = index;
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.bytesused = frame_bytes;
    buffer.field = V4L2_FIELD_NONE;
    call(fd, VIDIOC_QBUF, &buffer, "VIDIOC_QBUF");
    if (step == 0) {
      int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
      call(fd, VIDIOC_STREAMON, &type, "VIDIOC_STREAMON");
    }
    waitForAr();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: tower DEVICE FRAMES\n", stderr), 2;
  try {
    const int fd = ::open(argv[1], O_RDWR | O_CLOEXEC);
    if (fd < 0) throw std::system_error(errno, std::generic_category(), argv[1]);
    setMode(fd);
    std::ifstream frames(argv[2], std::ios::binary);
    play(fd, frames);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tower: %s\n", error.what());
    return 1;
  }
}
