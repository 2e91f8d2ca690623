#include "slam/rolling_shutter.hpp"

#include <algorithm>

namespace depthscope::slam {
namespace {

constexpr double kShortestInterval_s = 0.002;  // anything below is a fault of the time stamps
// Breathing tissue and lenses that are known badly look like readouts of up to a fifth of the time
// between two frames; sensors read out for half of it or more.
constexpr double kLeastShare = 0.3;
constexpr double kKeptShare = 0.2;  // once it was found
constexpr double kBeyondDoubt = 6;  // [sigma]

}  // namespace

void RollingShutter::noteInterval(double seconds) {
  if (seconds >= kShortestInterval_s && seconds < interval_s_) interval_s_ = seconds;
}

void RollingShutter::correct(double offset_s, double sigma_s) {
  const double readout_s = readout() + offset_s;
  const bool known = readout() > 0;
  const bool rolls = readout_s >= (known ? kKeptShare : kLeastShare) * interval_s_ &&
                     (known || readout_s >= kBeyondDoubt * sigma_s);
  readout_s_ = rolls ? std::min<double>(readout_s, interval_s_) : 0;
}

}  // namespace depthscope::slam
