#include "platform/display/kms/kms_display.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <system_error>

#include "platform/display/display_errors.hpp"
#include "platform/display/kms/flip_events.hpp"
#include "platform/display/kms/monitor_watch.hpp"
#include "platform/log.hpp"

namespace depthscope::platform::kms {
namespace {

using std::chrono::milliseconds;

constexpr auto retry_interval = milliseconds(200);
constexpr auto watch_interval = milliseconds(100);
constexpr auto flip_patience = milliseconds(200);      // a vblank that takes longer never comes
constexpr auto modeset_patience = milliseconds(3000);  // link training on real cables
constexpr int strikes_allowed = 3;

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(s));
}

}  // namespace

KmsDisplay::KmsDisplay(const DisplaySettings& settings, kernel::SystemCalls& calls, double fps,
                       GpuComposerMaker make_gpu)
    : settings_(settings),
      mode_request_(parseModeRequest(settings.mode)),
      make_gpu_(make_gpu),
      calls_(calls),
      fps_(fps) {}

KmsDisplay::~KmsDisplay() {
  if (output_) restoreConsole();
  dropCard();
}

DisplayMode KmsDisplay::mode() const {
  return output_ ? output_->mode() : DisplayMode{};
}

std::span<std::uint8_t> KmsDisplay::acquire(int width, int height) {
  const Time now = calls_.now();
  const bool resized = width != picture_.width || height != picture_.height;
  picture_ = {width, height, fps_};
  if (output_) takeEvents();
  if (output_) watchMonitor(now);
  if (output_ && resized && !changeOutput()) return {};
  if (!output_ && (now < next_try_ || !start(now))) return {};
  const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  if (memory_.size() < bytes) memory_.resize(bytes);
  return std::span(memory_).first(bytes);
}

void KmsDisplay::present(std::int64_t index) {
  if (!output_) return;
  if (flip_) waitForFlip();
  if (!output_) return;
  waiting_.reset();
  Output::Shot shot;
  shot.buffer = freeOf(&Output::Shot::buffer);
  output_->draw(shot.buffer, {memory_.data(), picture_.width, picture_.height, picture_.width * 4},
                copier_);
  waiting_ = Waiting{std::move(shot), index};
  if (!flip_) submit();
}

bool KmsDisplay::takesFrame(const capture::Frame& frame) const {
  switch (settings_.route) {
    case DisplayRoute::Auto:
      return dmaPicture(frame).has_value();
    case DisplayRoute::Gpu:
      return true;
    case DisplayRoute::Cpu:
      break;
  }
  return false;
}

const capture::Frame* KmsDisplay::presentFrame(capture::Frame& frame, const LayerView& layer,
                                               std::int64_t index) {
  // The mode is set with a composed picture, so that nothing but the route is new here.
  if (!output_ || !lit_ || !takesFrame(frame)) return nullptr;
  if (flip_) waitForFlip();
  if (!output_) return nullptr;
  waiting_.reset();
  Output::Shot shot;
  const int error = makeShot(frame, layer, shot);
  noteRoute(error == 0);
  if (error != 0) return nullptr;
  shot.frame = std::move(frame);
  waiting_ = Waiting{std::move(shot), index};
  if (flip_) return &waiting_->shot.frame;
  submit();
  if (flip_) return &flip_->shot.frame;
  if (waiting_) return &waiting_->shot.frame;
  frame = std::exchange(refused_frame_, {});
  return nullptr;
}

int KmsDisplay::makeShot(const capture::Frame& frame, const LayerView& layer, Output::Shot& shot) {
  if (settings_.route == DisplayRoute::Gpu) {
    shot.gpu = freeOf(&Output::Shot::gpu);
    return output_->drawByGpu(frame, layer, make_gpu_, shot);
  }
  if (const int error = output_->import(*dmaPicture(frame), shot.picture)) return error;
  shot.layer = freeOf(&Output::Shot::layer);
  output_->drawLayer(shot.layer, layer);
  return 0;
}

void KmsDisplay::noteRoute(bool direct) {
  if (direct == std::exchange(direct_, direct)) return;
  log(LogPriority::Info, !direct ? "pictures are composed by the processor"
                         : settings_.route == DisplayRoute::Gpu
                             ? "pictures are composed by the graphics processor"
                             : "pictures go to the monitor on a plane of their own");
}

std::optional<ShownPicture> KmsDisplay::takeShown() {
  if (output_) takeEvents();
  return shown_.take();
}

// ---- From nothing to a lit monitor

bool KmsDisplay::start(Time now) {
  next_try_ = now + retry_interval;
  if (state_ == DisplayState::NoMonitor && !monitorMayBeThere()) return false;
  int error = openCard();
  if (error == 0) error = lightOutput();
  if (error != 0) fail(error);
  return error == 0;
}

/// The card that is open already comes first: it may be that only the monitor changed.
int KmsDisplay::openCard() {
  if (card_ && findMonitor(*card_, settings_.connector, connector_) == 0) return 0;
  const bool any = settings_.device == "auto";
  const auto paths = any ? cardPaths(calls_) : std::vector<std::string>{settings_.device};
  int result = -ENODEV;
  for (const std::string& path : paths) {
    const int error = openOneCard(path);
    if (error == 0) return 0;
    // A card that works but has no monitor says more than one that does not work.
    if (result == -ENODEV || error == -ENOLINK) result = error;
  }
  return result;
}

int KmsDisplay::openOneCard(const std::string& path) {
  dropCard();
  card_ = std::make_unique<Card>();
  if (const int error = Card::open(calls_, path, *card_)) return error;
  return findMonitor(*card_, settings_.connector, connector_);
}

/// Lights the monitor that was found in the mode that fits, or in the next best the driver takes.
int KmsDisplay::lightOutput() {
  Pipeline pipeline;
  if (const int error = findPipeline(*card_, connector_, pipeline)) return error;
  drm_mode_crtc before;
  if (const int error = card_->crtc(pipeline.crtc, before)) return error;
  if (!console_ || console_->crtc_id != before.crtc_id) console_ = before;
  std::vector<drm_mode_modeinfo> modes = connector_.modes;
  for (output_.reset(); !output_;) {
    const auto chosen = chooseMode(modes, picture_, mode_request_);
    if (!chosen) return -ENOTSUP;
    const int error = Output::create(*card_, pipeline, modes[*chosen], output_);
    if (error != 0 && error != -EINVAL && error != -ENOSPC && error != -ERANGE) return error;
    modes.erase(modes.begin() + static_cast<std::ptrdiff_t>(*chosen));
  }
  lit_ = false;
  status_path_ = statusPath(*card_, connector_);
  const DisplayMode mode = output_->mode();
  log(LogPriority::Info, "monitor found",
      {{"card", card_->name()},
       {"connector", connector_.name},
       {"width", mode.width},
       {"height", mode.height},
       {"refresh_hz", std::round(mode.refresh_hz * 100) / 100}});
  if (mode.width < picture_.width || mode.height < picture_.height)
    log(LogPriority::Warning, "the monitor has no mode as large as the picture: it is scaled down",
        {{"picture_width", picture_.width}, {"picture_height", picture_.height}});
  return 0;
}

/// The picture has another size: it may go into another mode.
bool KmsDisplay::changeOutput() {
  const auto chosen = chooseMode(connector_.modes, picture_, mode_request_);
  if (chosen &&
      std::memcmp(&connector_.modes[*chosen], &output_->modeInfo(), sizeof(drm_mode_modeinfo)) == 0)
    return true;
  retired_ = std::move(output_);
  retired_front_ = std::exchange(front_, {});
  waiting_.reset();
  if (flip_) flip_->retired = true;
  const int error = lightOutput();
  if (error != 0) fail(error);
  return error == 0;
}

/// Once it was found that there is no monitor, the kernel's own word is enough to go on waiting:
/// asking the connectors takes long, and would hold the loop up.
bool KmsDisplay::monitorMayBeThere() {
  return !card_ ||
         monitorSeen(calls_, settings_.device == "auto" ? "" : card_->name(), settings_.connector);
}

/// The monitor's plug, by the kernel's word.
void KmsDisplay::watchMonitor(Time now) {
  if (now < next_watch_) return;
  next_watch_ = now + watch_interval;
  if (connection(calls_, status_path_) == Connection::Disconnected) fail(-ENOLINK);
}

// ---- Pictures on their way

/// A buffer that is neither on screen nor on its way there.
int KmsDisplay::freeOf(int Output::Shot::*number) const {
  for (int i = 0;; ++i)
    if (i != front_.*number && (!flip_ || i != flip_->shot.*number)) return i;
}

void KmsDisplay::submit() {
  const int error = output_->flip(waiting_->shot, !lit_, ++serial_);
  if (error == -EINVAL && waiting_->shot.buffer < 0) {
    output_->refuse(waiting_->shot);
    refused_frame_ = std::move(waiting_->shot.frame);
    waiting_.reset();
    return;
  }
  if (error != 0) return strike(error);
  const Time now = calls_.now();
  flip_ = Flip{std::move(waiting_->shot), false, serial_,
               waiting_->index,           now,   now + (lit_ ? flip_patience : modeset_patience)};
  waiting_.reset();
  lit_ = true;
}

/// A commit failed. One failure is nothing: the picture waits for the next turn. A card that fails
/// again and again is closed and opened afresh.
void KmsDisplay::strike(int error) {
  if (error == -ENODEV || ++strikes_ >= strikes_allowed) fail(error);
}

/// Takes in which pictures were shown, and hands over the one that waited for that.
void KmsDisplay::takeEvents() {
  const int error = readFlipEvents(calls_, card_->fd(), [&](std::uint64_t serial, Time shown) {
    if (flip_ && serial == flip_->serial) completeFlip(shown);
  });
  if (error != 0) return fail(error);
  if (flip_ && calls_.now() >= flip_->overdue) {
    if (!flip_->retired) front_ = std::move(flip_->shot);
    flip_.reset();
    strike(-ETIMEDOUT);
  }
  if (output_ && !flip_ && waiting_) submit();
  refused_frame_ = {};
}

void KmsDisplay::completeFlip(Time shown) {
  strikes_ = 0;
  if (!flip_->retired) {
    front_ = std::move(flip_->shot);
    retired_front_ = {};
    retired_.reset();
  }
  shown_.add({flip_->index, flip_->submitted, shown});
  flip_.reset();
  report(DisplayState::Ok, 0);
}

/// Waits for the picture that is on its way, so that the next one need not wait for a whole turn of
/// the loop; but no longer than half a picture's time, for the loop has a camera to listen to.
void KmsDisplay::waitForFlip() {
  const auto limit =
      std::min(seconds(0.5 / std::max(fps_, 30.0)), seconds(1 / std::max(mode().refresh_hz, 1.0)));
  const Time until = calls_.now() + limit;
  takeEvents();
  for (Time now = calls_.now(); output_ && flip_ && now < until; now = calls_.now()) {
    std::array<pollfd, 1> wait{{{card_->fd(), POLLIN, 0}}};
    const int ready = calls_.poll(wait, until - now);
    if (ready < 0 && ready != -EINTR) return;
    if (ready > 0) takeEvents();
  }
}

// ---- And back

/// Lets go of everything that may be in the way of the next try.
void KmsDisplay::fail(int error) {
  next_try_ = calls_.now() + retry_interval;
  dropOutput();
  if (error != -ENOLINK || (card_ && card_->leaked())) dropCard();
  report(displayStateOf(error), error);
}

void KmsDisplay::dropOutput() {
  flip_.reset();
  waiting_.reset();
  front_ = {};
  retired_front_ = {};
  output_.reset();
  retired_.reset();
  strikes_ = 0;
}

void KmsDisplay::dropCard() {
  dropOutput();
  console_.reset();
  card_.reset();
}

void KmsDisplay::restoreConsole() {
  if (console_->mode_valid == 0 || console_->fb_id == 0) return;
  std::uint32_t connector = connector_.id;
  console_->set_connectors_ptr = reinterpret_cast<std::uintptr_t>(&connector);
  console_->count_connectors = 1;
  card_->ioctl(DRM_IOCTL_MODE_SETCRTC, &*console_);
}

/// Keeps the state; says so once when it changes.
void KmsDisplay::report(DisplayState state, int error) {
  const bool news = state != state_ || (state != DisplayState::Ok && error != reported_error_);
  state_ = state;
  reported_error_ = error;
  if (!news) return;
  if (state == DisplayState::Ok)
    log(LogPriority::Notice, "the picture is on the monitor", {{"connector", connector_.name}});
  else if (state == DisplayState::NoMonitor)
    log(LogPriority::Warning, "no monitor is connected, the loop goes on without",
        {{"device", settings_.device}, {"connector", settings_.connector}});
  else
    log(LogPriority::Warning, "no picture on the monitor",
        {{"why", toString(state)}, {"error", std::generic_category().message(-error)}});
}

}  // namespace depthscope::platform::kms
