#include "platform/ar/capacity_text.hpp"

#include <cstdio>

namespace depthscope::platform {

std::string capacityText(const slam::SlamSettings& settings, const slam::SlamMemory& memory) {
  const slam::CapacitySettings& c = settings.capacity;
  const auto mb = [](std::size_t bytes) { return static_cast<double>(bytes) / (1024.0 * 1024.0); };
  char text[256];
  std::snprintf(text, sizeof text,
                "%d keyframes of %d features (%.1f MB), %d points of %d observations (%.1f MB), "
                "places (%.1f MB), adjustment (%.1f MB): %.1f MB",
                c.keyframes, settings.extractor.capacity(), mb(memory.keyframes), c.map_points,
                c.observations_per_point, mb(memory.points), mb(memory.places),
                mb(memory.adjustment), mb(memory.total()));
  return text;
}

}  // namespace depthscope::platform
