#include "platform/display/kms/mode_choice.hpp"

#include <cmath>
#include <functional>

namespace depthscope::platform::kms {
namespace {

// 59.94 counts as 60: a capture card's rate is seldom known better, and the drift between two free
// running clocks is no smaller a trouble.
constexpr double rate_tolerance = 0.002;

bool usable(const drm_mode_modeinfo& m) {
  constexpr unsigned refused =
      DRM_MODE_FLAG_INTERLACE | DRM_MODE_FLAG_DBLSCAN | DRM_MODE_FLAG_3D_MASK;
  return (m.flags & refused) == 0 && m.hdisplay > 0 && m.vdisplay > 0;
}

bool near(double a, double b) {
  return std::abs(a - b) <= rate_tolerance * b;
}

double area(const drm_mode_modeinfo& m) {
  return static_cast<double>(m.hdisplay) * m.vdisplay;
}

/// Times that the rate holds the picture's, 0 when it is no whole multiple.
double multiple(double refresh, double fps) {
  if (fps <= 0) return 0;
  const double times = std::round(refresh / fps);
  return times >= 1 && near(refresh, times * fps) ? times : 0;
}

using Accept = std::function<bool(const drm_mode_modeinfo&)>;
using Better = std::function<bool(const drm_mode_modeinfo&, const drm_mode_modeinfo&)>;

std::optional<std::size_t> best(std::span<const drm_mode_modeinfo> modes, const Accept& accept,
                                const Better& better) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < modes.size(); ++i)
    if (usable(modes[i]) && accept(modes[i]) && (!found || better(modes[i], modes[*found])))
      found = i;
  return found;
}

}  // namespace

double refreshRate(const drm_mode_modeinfo& m) {
  const double total = static_cast<double>(m.htotal) * m.vtotal;
  if (m.clock == 0 || total <= 0) return m.vrefresh;
  double rate = m.clock * 1000.0 / total;
  if (m.flags & DRM_MODE_FLAG_INTERLACE) rate *= 2;
  if (m.flags & DRM_MODE_FLAG_DBLSCAN) rate /= 2;
  if (m.vscan > 1) rate /= m.vscan;
  return rate;
}

std::optional<std::size_t> chooseMode(std::span<const drm_mode_modeinfo> modes,
                                      const PictureRate& picture, const ModeRequest& request) {
  using Mode = drm_mode_modeinfo;
  const auto faster = [](const Mode& a, const Mode& b) { return refreshRate(a) > refreshRate(b); };
  const auto smaller = [](const Mode& a, const Mode& b) { return area(a) < area(b); };
  const auto first = [](const Mode&, const Mode&) { return false; };
  const auto fewer_repeats = [&](const Mode& a, const Mode& b) {
    return multiple(refreshRate(a), picture.fps) < multiple(refreshRate(b), picture.fps);
  };
  const auto sized = [](const Mode& m, int width, int height) {
    return m.hdisplay == width && m.vdisplay == height;
  };
  const auto in_step = [&](const Mode& m) { return multiple(refreshRate(m), picture.fps) > 0; };
  const auto fits = [&](const Mode& m) {
    return m.hdisplay >= picture.width && m.vdisplay >= picture.height;
  };

  if (!request.automatic()) {
    const auto asked = [&](const Mode& m) { return sized(m, request.width, request.height); };
    const auto at_rate = [&](const Mode& m) {
      return asked(m) && std::abs(refreshRate(m) - request.refresh_hz) < 0.5;
    };
    if (request.refresh_hz > 0) {
      const auto closer = [&](const Mode& a, const Mode& b) {
        return std::abs(refreshRate(a) - request.refresh_hz) <
               std::abs(refreshRate(b) - request.refresh_hz);
      };
      if (const auto found = best(modes, at_rate, closer)) return found;
    } else {
      const auto asked_in_step = [&](const Mode& m) { return asked(m) && in_step(m); };
      if (const auto found = best(modes, asked_in_step, fewer_repeats)) return found;
      if (const auto found = best(modes, asked, faster)) return found;
    }
  }
  const auto same = [&](const Mode& m) { return sized(m, picture.width, picture.height); };
  const auto same_in_step = [&](const Mode& m) { return same(m) && in_step(m); };
  const auto preferred = [&](const Mode& m) {
    return (m.type & DRM_MODE_TYPE_PREFERRED) != 0 && fits(m);
  };
  if (const auto found = best(modes, same_in_step, fewer_repeats)) return found;
  if (const auto found = best(modes, same, faster)) return found;
  if (const auto found = best(modes, preferred, first)) return found;
  if (const auto found = best(modes, fits, smaller)) return found;
  return best(
      modes, [](const Mode&) { return true; },
      [](const Mode& a, const Mode& b) { return area(a) > area(b); });
}

}  // namespace depthscope::platform::kms
