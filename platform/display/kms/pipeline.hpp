#pragma once
#include <optional>

#include "platform/display/kms/atomic_request.hpp"

namespace depthscope::platform::kms {

/// A plane and where it lies on the screen, by the ids of its properties.
struct PlaneProperties {
  std::uint32_t plane = 0;
  std::uint32_t fb = 0, crtc = 0;
  std::uint32_t src_x = 0, src_y = 0, src_w = 0, src_h = 0;
  std::uint32_t crtc_x = 0, crtc_y = 0, crtc_w = 0, crtc_h = 0;
  std::uint32_t in_fence = 0;

  /// Shows all of a framebuffer of `width` x `height` pixels at (x, y), one to one.
  void show(AtomicRequest& request, std::uint32_t crtc_id, std::uint32_t framebuffer, int x, int y,
            int width, int height) const;
  void hide(AtomicRequest& request) const;
};

/// A property that takes one of a few named values.
template <std::size_t Count>
struct EnumProperty {
  std::uint32_t id = 0;                                    // 0: the driver does not have it
  std::array<std::optional<std::uint64_t>, Count> values;  // none: the driver does not know it
};

/// All that is known of a plane.
struct PlaneUnit {
  PlaneProperties properties;
  bool primary = false;
  bool in_use = false;  // somebody left it on our CRTC
  std::vector<std::uint32_t> formats;
  std::optional<std::uint64_t> zpos;  // the higher lies above
  EnumProperty<4> encoding;           // by DmaPicture::Encoding
  EnumProperty<2> range;              // limited, full
};

/// The way from a framebuffer to the monitor: a primary plane, a CRTC, a connector.
struct Pipeline {
  Connector connector;
  std::uint32_t crtc = 0;
  std::uint32_t crtc_mode = 0, crtc_active = 0;                 // property ids
  std::uint32_t connector_crtc = 0, connector_link_status = 0;  // property ids; the latter may be 0
  PlaneUnit primary;
  std::vector<PlaneUnit> others;  // that this CRTC can have and no other one has
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      connectors_in_use;  // likewise: id, its CRTC_ID

  /// Adds all that lights the monitor in a mode (a blob) with nothing but the primary plane on.
  void light(AtomicRequest& request, std::uint32_t mode_blob) const;
};

/// Finds the CRTC and the planes that feed a connector, those in use already before others. 0 or
/// -errno; -ENOTSUP: the driver has no way there.
int findPipeline(const Card& card, const Connector& connector, Pipeline& out);

}  // namespace depthscope::platform::kms
