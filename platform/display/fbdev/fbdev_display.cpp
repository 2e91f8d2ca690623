#include "platform/display/fbdev/fbdev_display.hpp"

#include <fcntl.h>
#include <linux/fb.h>

#include <algorithm>
#include <system_error>

#include "platform/display/display_errors.hpp"
#include "platform/log.hpp"

namespace depthscope::platform::fbdev {
namespace {

using std::chrono::milliseconds;

constexpr const char* usual_device = "/dev/fb0";
constexpr auto retry_interval = milliseconds(200);
constexpr auto watch_interval = milliseconds(200);
constexpr int strikes_allowed = 3;

int request(kernel::SystemCalls& calls, int fd, unsigned long what, void* argument) {
  const int result = kernel::retryInterrupted([&] { return calls.ioctl(fd, what, argument); });
  return result < 0 ? result : 0;
}

bool layoutOf(const fb_var_screeninfo& v, PixelLayout& layout) {
  const bool blue_first = v.blue.offset == 0 && v.green.offset == 8 && v.red.offset == 16;
  const bool red_first = v.red.offset == 0 && v.green.offset == 8 && v.blue.offset == 16;
  if (v.bits_per_pixel == 32 && blue_first)
    layout = PixelLayout::Bgrx32;
  else if (v.bits_per_pixel == 32 && red_first)
    layout = PixelLayout::Rgbx32;
  else if (v.bits_per_pixel == 24 && blue_first)
    layout = PixelLayout::Bgr24;
  else if (v.bits_per_pixel == 16 && v.red.offset == 11 && v.green.offset == 5 &&
           v.blue.offset == 0)
    layout = PixelLayout::Rgb565;
  else
    return false;
  return true;
}

}  // namespace

FbdevDisplay::FbdevDisplay(const DisplaySettings& settings, kernel::SystemCalls& calls)
    : device_(settings.device == "auto" ? usual_device : settings.device), calls_(calls) {}

FbdevDisplay::~FbdevDisplay() {
  if (!open_) return;
  const auto screen = page(0);
  std::copy_n(before_.begin(), std::min(before_.size(), screen.size()), screen.begin());
  if (shown_page_ != 0) pan(0);
}

DisplayMode FbdevDisplay::mode() const {
  return open_ ? DisplayMode{screen_.width, screen_.height, 0} : DisplayMode{};
}

std::span<std::uint8_t> FbdevDisplay::acquire(int width, int height) {
  const Time now = calls_.now();
  picture_width_ = width;
  picture_height_ = height;
  if (open_) watch(now);
  if (!open_ && now >= next_try_) {
    const int error = open();
    if (error != 0) fail(error);
  }
  if (!open_) return {};
  const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  if (memory_.size() < bytes) memory_.resize(bytes);
  return std::span(memory_).first(bytes);
}

void FbdevDisplay::present(std::int64_t) {
  if (!open_) return;
  const int target = pages_ > 1 ? 1 - shown_page_ : 0;
  if (picture_width_ != drawn_width_ || picture_height_ != drawn_height_) {
    const auto all = mapping_.bytes();
    std::fill(all.begin(), all.end(), std::byte{0});
    drawn_width_ = picture_width_;
    drawn_height_ = picture_height_;
  }
  copier_.copy(
      {memory_.data(), picture_width_, picture_height_, picture_width_ * 4},
      {page(target).data(), screen_.width, screen_.height, screen_.stride, screen_.layout});
  if (pages_ > 1)
    if (const int error = pan(target)) {
      // One failure is nothing: the next picture goes to the same place. But it may be that the
      // mode was changed: the next turn looks at once.
      next_watch_ = {};
      if (error == -ENODEV || ++strikes_ >= strikes_allowed) fail(error);
      return;
    }
  strikes_ = 0;
  report(DisplayState::Ok, 0);
}

std::span<std::uint8_t> FbdevDisplay::page(int index) const {
  const auto all = mapping_.bytes();
  const auto bytes =
      static_cast<std::size_t>(screen_.stride) * static_cast<std::size_t>(screen_.height);
  return {reinterpret_cast<std::uint8_t*>(all.data()) + bytes * static_cast<std::size_t>(index),
          bytes};
}

/// 0 or -errno. Shows a page; drivers may wait for the next vblank with it.
int FbdevDisplay::pan(int index) {
  fb_var_screeninfo v{};
  if (const int error = request(calls_, fd_.get(), FBIOGET_VSCREENINFO, &v)) return error;
  v.xoffset = 0;
  v.yoffset = static_cast<std::uint32_t>(index * screen_.height);
  const int error = request(calls_, fd_.get(), FBIOPAN_DISPLAY, &v);
  if (error == 0) shown_page_ = index;
  return error;
}

int FbdevDisplay::open() {
  fd_ = kernel::OwnedFd(
      calls_, kernel::retryInterrupted([&] { return calls_.open(device_.c_str(), O_RDWR); }));
  if (!fd_.valid()) return fd_.get();
  askForTwoScreens();
  if (const int error = readScreen(screen_)) return error;
  fb_fix_screeninfo fix{};
  if (const int error = request(calls_, fd_.get(), FBIOGET_FSCREENINFO, &fix)) return error;
  const auto bytes =
      static_cast<std::size_t>(screen_.stride) * static_cast<std::size_t>(screen_.height);
  if (bytes == 0 || fix.smem_len < bytes) return -EOPNOTSUPP;
  if (fix.smem_len < 2 * bytes) pages_ = 1;
  int error = 0;
  mapping_ =
      kernel::Mapping(calls_, fd_.get(), bytes * static_cast<std::size_t>(pages_), true, 0, error);
  if (!mapping_.valid()) return error;
  shown_page_ = 0;
  if (pages_ > 1 && pan(0) != 0) pages_ = 1;
  const auto screen = page(0);
  before_.assign(screen.begin(), screen.end());
  // A console that was left alone may have gone dark; drivers without a way to say so refuse.
  calls_.ioctl(fd_.get(), FBIOBLANK, reinterpret_cast<void*>(std::uintptr_t{FB_BLANK_UNBLANK}));
  drawn_width_ = drawn_height_ = 0;
  open_ = true;
  log(LogPriority::Info, "framebuffer found",
      {{"device", device_},
       {"width", screen_.width},
       {"height", screen_.height},
       {"bits", bytesPerPixel(screen_.layout) * 8},
       {"pages", pages_}});
  return 0;
}

void FbdevDisplay::askForTwoScreens() {
  fb_var_screeninfo v{};
  pages_ = 1;
  if (request(calls_, fd_.get(), FBIOGET_VSCREENINFO, &v) != 0) return;
  if (v.yres_virtual < 2 * v.yres) {
    v.yres_virtual = 2 * v.yres;
    if (request(calls_, fd_.get(), FBIOPUT_VSCREENINFO, &v) != 0) return;
    if (request(calls_, fd_.get(), FBIOGET_VSCREENINFO, &v) != 0) return;
  }
  fb_fix_screeninfo fix{};
  if (request(calls_, fd_.get(), FBIOGET_FSCREENINFO, &fix) != 0) return;
  if (v.yres_virtual >= 2 * v.yres && fix.ypanstep != 0 && v.yres % fix.ypanstep == 0) pages_ = 2;
}

int FbdevDisplay::readScreen(Screen& screen) {
  fb_var_screeninfo v{};
  fb_fix_screeninfo fix{};
  if (const int error = request(calls_, fd_.get(), FBIOGET_VSCREENINFO, &v)) return error;
  if (const int error = request(calls_, fd_.get(), FBIOGET_FSCREENINFO, &fix)) return error;
  if (fix.type != FB_TYPE_PACKED_PIXELS || !layoutOf(v, screen.layout)) return -EOPNOTSUPP;
  screen.width = static_cast<int>(v.xres);
  screen.height = static_cast<int>(v.yres);
  screen.stride = static_cast<int>(fix.line_length);
  return screen.stride >= screen.width * bytesPerPixel(screen.layout) ? 0 : -EOPNOTSUPP;
}

/// Another program may set another mode, and a device may go, without a word to us.
void FbdevDisplay::watch(Time now) {
  if (now < next_watch_) return;
  next_watch_ = now + watch_interval;
  Screen screen;
  const int error = readScreen(screen);
  if (error == 0 && screen == screen_) return;
  if (error != 0 && error != -ENODEV && error != -EOPNOTSUPP && ++strikes_ < strikes_allowed)
    return;
  fail(error);
  if (error == 0) next_try_ = now;
}

void FbdevDisplay::fail(int error) {
  next_try_ = calls_.now() + retry_interval;
  close();
  report(error == 0 ? DisplayState::Starting : displayStateOf(error), error);
}

void FbdevDisplay::close() {
  open_ = false;
  mapping_.reset();
  fd_.reset();
  strikes_ = 0;
}

/// Keeps the state; says so once when it changes.
void FbdevDisplay::report(DisplayState state, int error) {
  const bool news = state != state_ || (state != DisplayState::Ok && error != reported_error_);
  state_ = state;
  reported_error_ = error;
  if (!news) return;
  if (state == DisplayState::Ok)
    log(LogPriority::Notice, "the picture is on the framebuffer", {{"device", device_}});
  else
    log(LogPriority::Warning, "no picture on the framebuffer",
        {{"device", device_},
         {"why", toString(state)},
         {"error", std::generic_category().message(-error)}});
}

}  // namespace depthscope::platform::fbdev
