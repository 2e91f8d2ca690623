#pragma once
#include <drm.h>
#include <drm_mode.h>

#include <map>
#include <span>
#include <string>
#include <vector>

#include "kernel/owned_fd.hpp"

namespace depthscope::platform::kms {

struct Connector {
  std::uint32_t id = 0;
  std::string name;  // as the kernel calls it, e.g. "HDMI-A-1"
  bool connected = false;
  std::uint32_t encoder = 0;  // in use; 0: none
  std::vector<std::uint32_t> encoders;
  std::vector<drm_mode_modeinfo> modes;
};

struct Plane {
  std::uint32_t id = 0;
  std::uint32_t crtc = 0;            // in use; 0: none
  std::uint32_t possible_crtcs = 0;  // bit i: the i-th of the card
  std::vector<std::uint32_t> formats;
};

struct Property {
  std::uint32_t id = 0;
  std::uint64_t value = 0;
};
using Properties = std::map<std::string, Property, std::less<>>;

/// An open DRM card: its ioctls, one function each, with vectors in place of counts and pointers.
/// All return 0 or -errno and try again for a while when a signal cuts in. Setting up allocates;
/// commit and readEvents do not.
class Card {
 public:
  Card() = default;
  /// Opens the card's primary node (which makes us its master when nobody is) with atomic
  /// modesetting on. -EOPNOTSUPP: its driver has none.
  static int open(kernel::SystemCalls& calls, const std::string& path, Card& card);

  bool valid() const { return fd_.valid(); }
  int fd() const { return fd_.get(); }
  /// As in /sys/class/drm, e.g. "card0".
  const std::string& name() const { return name_; }
  kernel::SystemCalls& calls() const { return *calls_; }

  int crtcs(std::vector<std::uint32_t>& ids) const;
  int connectors(std::vector<std::uint32_t>& ids) const;
  /// `probe`: asks the monitor (EDID), which may take a good part of a second; else what the kernel
  /// last knew.
  int connector(std::uint32_t id, bool probe, Connector& out) const;
  int encoder(std::uint32_t id, drm_mode_get_encoder& out) const;
  int crtc(std::uint32_t id, drm_mode_crtc& out) const;
  int planes(std::vector<Plane>& out) const;
  /// `type`: DRM_MODE_OBJECT_...
  int properties(std::uint32_t object, std::uint32_t type, Properties& out) const;

  /// The values that an enumerated property takes, with their names.
  int enumValues(std::uint32_t property, std::vector<drm_mode_property_enum>& out) const;

  int ioctl(unsigned long request, void* argument) const;
  /// An ioctl that gives something back to the card. When it fails the thing is lost until the card
  /// is closed: leaked() says so.
  void release(unsigned long request, void* argument);
  bool leaked() const { return leaked_; }

 private:
  int resources(std::vector<std::uint32_t>& crtc_ids,
                std::vector<std::uint32_t>& connector_ids) const;

  kernel::SystemCalls* calls_ = nullptr;
  kernel::OwnedFd fd_;
  std::string name_;
  bool leaked_ = false;
};

/// Every card of the machine, as paths under /dev/dri.
std::vector<std::string> cardPaths(kernel::SystemCalls& calls);

}  // namespace depthscope::platform::kms
