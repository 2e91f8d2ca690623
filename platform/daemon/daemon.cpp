#include "platform/daemon/daemon.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <systemd/sd-daemon.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "platform/config/live_settings.hpp"
#include "platform/daemon/open_source.hpp"
#include "platform/daemon/real_time.hpp"
#include "platform/log.hpp"

namespace depthscope::platform {
namespace {

constexpr int tick_ms = 50;

UniqueFd makeSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, signal);
  ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  UniqueFd fd(::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
  if (!fd.valid()) throw std::system_error(errno, std::generic_category(), "signalfd");
  return fd;
}

/// systemd holds the job of a reload open until READY=1; newer ones ask for the time it began.
void sayReloading() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  ::sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%lld",
               static_cast<long long>(now.tv_sec) * 1000000 + now.tv_nsec / 1000);
}

SharedCapacity capacity(const DaemonOptions& options) {
  return {static_cast<std::uint32_t>(options.camera.width),
          static_cast<std::uint32_t>(options.camera.height),
          static_cast<std::uint32_t>(options.settings.daemon.max_vertices),
          static_cast<std::uint32_t>(options.settings.daemon.max_triangles)};
}

std::vector<std::string> arCommand(const DaemonOptions& options) {
  std::string program = options.settings.daemon.ar_program;
  if (program.empty())
    program = std::filesystem::read_symlink("/proc/self/exe").replace_filename("depthscope-ar");
  return {program, "--camera", options.settings.capture.camera};
}

}  // namespace

Daemon::Daemon(const DaemonOptions& options)
    : options_(options),
      settings_(options.settings),
      signals_(makeSignals()),
      source_(openSource(options.settings.capture, options.camera)),
      fps_(source_->fps() > 0 ? source_->fps() : 30),
      memory_(SharedMemory::create(capacity(options))),
      display_(makeDisplay(options.settings.display, kernel::realSystemCalls(),
                           options.camera.width, options.camera.height, fps_)),
      link_(memory_, options.settings.overlay.max_age_ms),
      pose_wait_(memory_, kernel::realSystemCalls()),
      ar_(arCommand(options), memory_, settings_),
      gpio_(makeGpioChips()),
      footswitch_(options.settings.footswitch, *gpio_, kernel::realSystemCalls()),
      scale_(options.camera, memory_, link_, pose_wait_),
      control_requests_(settings_, options.camera, memory_, ar_, video_requests_, report_,
                        footswitch_, scale_),
      control_(options.settings.daemon.control_socket,
               [this](std::string_view line, UniqueFd attached) {
                 return control_requests_.handle(line, std::move(attached));
               }) {}

void Daemon::run() {
  if (options_.settings.daemon.lock_memory) lockMemory();
  if (const std::string& path = options_.settings.daemon.frame_log; !path.empty())
    frame_log_.emplace(path);
  // The first to open a graphics card is its master, who alone may show pictures; where there is no
  // GPU, EGL would open the monitor's card to draw with.
  display_->acquire(options_.camera.width, options_.camera.height);
  const bool exact = options_.settings.display.registration == Registration::Exact;
  OverlayThread layers([this, exact] {
    auto painter = std::make_unique<LayerPainter>(options_.camera, options_.settings.overlay, link_,
                                                  video_requests_);
    painter->waitForPoses(exact ? &pose_wait_ : nullptr);
    return painter;
  });
  VideoThread video([&] { return makeLoop(layers); }, options_.settings.daemon.realtime_priority,
                    report_);
  const LifeSigns life_signs(report_, options_.settings.heartbeat);
  const CaptureSettings& capture = options_.settings.capture;
  log(LogPriority::Info, "started",
      {{"input", capture.card.device.empty() ? capture.input : capture.card.device},
       {"fps", fps_}});
  serviceLoop();
  ::sd_notify(0, "STOPPING=1");
  video.stop();
  if (frame_log_) frame_log_->flush();
  logEnd();
}

std::unique_ptr<VideoLoop> Daemon::makeLoop(LayerSource& layers) {
  const VideoLoop::Parts parts{*source_,
                               *display_,
                               layers,
                               link_,
                               video_requests_,
                               report_,
                               frame_log_ ? &*frame_log_ : nullptr,
                               kernel::realSystemCalls()};
  const DisplaySettings& display = options_.settings.display;
  const double wait = display.registration == Registration::Exact
                          ? display.exact_wait
                          : options_.settings.daemon.overlay_wait;
  const VideoLoopSettings settings{static_cast<float>(wait), options_.settings.overlay.max_age_ms,
                                   options_.settings.daemon.stale_s};
  return std::make_unique<VideoLoop>(parts, settings, options_.settings.overlay.font_file,
                                     options_.camera.width, options_.camera.height);
}

void Daemon::serviceLoop() {
  for (;;) {
    std::array<pollfd, 2 + Footswitch::max_pedals> wait{
        {{signals_.get(), POLLIN, 0}, {control_.fd(), POLLIN, 0}}};
    const auto pedals = std::span(wait).subspan(2, footswitch_.pedals());
    footswitch_.addTo(pedals);
    ::poll(wait.data(), 2 + pedals.size(),
           footswitch_.waitAtMost(std::chrono::steady_clock::now(), tick_ms));
    if (wait[0].revents != 0 && !handleSignals()) return;
    if (report_.ended.load(std::memory_order_acquire)) return;
    ar_.tick(std::chrono::steady_clock::now());
    link_.setAlive(ar_.alive());
    if (std::exchange(ar_restarts_, ar_.restarts()) != ar_.restarts()) scale_.arStarted();
    serveFootswitch(pedals);
    if (wait[1].revents != 0) control_.serve();
    if (frame_log_) frame_log_->flush();
    logSource();
  }
}

/// False when the daemon is to stop.
bool Daemon::handleSignals() {
  signalfd_siginfo info;
  while (::read(signals_.get(), &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
    if (info.ssi_signo != SIGHUP) return false;
    reload();
  }
  return true;
}

void Daemon::serveFootswitch(std::span<const pollfd> descriptors) {
  if (footswitch_.service(std::chrono::steady_clock::now(), descriptors) == 0) return;
  const std::string answer = control_requests_.footswitchPressed();
  log(answer.starts_with("ok") ? LogPriority::Info : LogPriority::Warning, "footswitch pressed",
      {{"answer", answer}});
}

/// Reads the configuration again and applies what may change at run time; a file with a mistake in
/// it changes nothing.
void Daemon::reload() {
  sayReloading();
  try {
    const double period_s = settings_.recon.period_s;
    const SettingsChange change =
        adoptLiveSettings(settings_, readSettings(options_.config, options_.overrides));
    ar_.configure(settings_);
    if (settings_.recon.period_s != period_s)
      ar_.send(encodeSurfacePeriod(settings_.recon.period_s));
    video_requests_.setOverlay(settings_.overlay);
    log(LogPriority::Notice, "configuration read again",
        {{"applied", change.applied}, {"needs_restart", change.needs_restart}});
  } catch (const std::exception& error) {
    log(LogPriority::Error, "configuration not read again, the old one stays in force",
        {{"error", error.what()}});
  }
  ::sd_notify(0, "READY=1");
}

void Daemon::logSource() {
  const auto note = report_.source_note.take();
  if (!note) return;
  const bool ok = note->status == capture::SourceStatus::Ok;
  log(ok ? LogPriority::Info : LogPriority::Warning, "source",
      {{"status", toString(note->status)}, {"detail", note->detail}});
}

void Daemon::logEnd() const {
  log(LogPriority::Info, "stopped",
      {{"frames", report_.frames.load()},
       {"skipped", report_.skipped.load()},
       {"damaged", report_.damaged.load()},
       {"given_up", report_.given_up.load()},
       {"tracked", report_.tracked.load()},
       {"ar_restarts", ar_.restarts()}});
}

}  // namespace depthscope::platform
