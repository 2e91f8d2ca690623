#pragma once
#include <drm.h>
#include <drm_fourcc.h>
#include <drm_mode.h>

#include <map>
#include <set>

#include "tests/fake_kernel/fake_kernel.hpp"

namespace depthscope::fake {

/// Memory that devices share by descriptor.
struct FakeDmabuf final : FakeFile {
  explicit FakeDmabuf(std::size_t bytes) : memory(new std::byte[bytes]), size(bytes) {}
  std::shared_ptr<std::byte[]> memory;
  std::size_t size;
};

/// Timings at this size and rate, with blanking as real modes have.
drm_mode_modeinfo makeMode(int width, int height, double refresh_hz, bool preferred = false);

/// A graphics card with one CRTC behind the ioctls of DRM atomic modesetting: objects with
/// properties, master and clients, dumb buffers, framebuffers, blobs, TEST_ONLY, non-blocking
/// commits that end at a vblank of the simulated clock. It refuses what the kernel refuses.
class FakeKmsCard final : public FakeDevice {
 public:
  struct Connector {
    std::uint32_t type = DRM_MODE_CONNECTOR_HDMIA, type_id = 1;
    bool connected = true;
    std::vector<drm_mode_modeinfo> modes;
  };
  struct PlaneKind {
    std::uint64_t type = 1;  // 0 overlay, 1 primary, 2 cursor
    std::vector<std::uint32_t> formats{DRM_FORMAT_XRGB8888, DRM_FORMAT_ARGB8888};
    int zpos = -1;            // -1: the driver does not tell
    bool has_colors = false;  // COLOR_ENCODING and COLOR_RANGE
  };

  static constexpr std::uint64_t no_fence = ~std::uint64_t{0};  // of the property IN_FENCE_FD

  /// Puts itself at /dev/dri/`name`, its connectors under /sys/class/drm. One plane of each kind.
  FakeKmsCard(FakeKernel& kernel, std::string name, std::vector<Connector> connectors,
              std::vector<PlaneKind> planes = {{}});
  ~FakeKmsCard() override;

  int open(int flags, std::unique_ptr<FakeFile>& file) override;

  /// Plugs a monitor in or out; the kernel notices at once.
  void setConnected(std::size_t connector, bool connected);
  void setModes(std::size_t connector, std::vector<drm_mode_modeinfo> modes);
  /// The whole card comes or goes; open files answer ENODEV from then on.
  void setPresent(bool present);

  // What a test may turn about the driver.
  bool atomic = true;
  bool vblanks = true;                // false: flips never end
  bool refuse_test_of_modes = false;  // TEST_ONLY of anything that sets a mode: EINVAL
  int refused_width = 0;              // modes of this width do not pass the check
  std::set<std::uint32_t> refused_framebuffer_formats;
  bool planes_work = true;    // false: no commit with two planes passes the check
  bool other_master = false;  // another program is master

  // What a test may look at.
  bool lit(std::size_t connector = 0) const;
  const drm_mode_modeinfo* mode() const;  // of the first CRTC that is on
  /// A pixel as the monitor shows it now, 0xRRGGBB: all planes that hold RGB, one over the other.
  std::uint32_t pixel(int x, int y);
  /// A property of the n-th plane as committed.
  std::uint64_t planeValue(std::size_t plane, const std::string& name) const;
  std::uint64_t flips() const { return flips_; }
  std::uint64_t modesets() const { return modesets_; }
  std::uint64_t probes() const { return probes_; }
  std::uint64_t timesSwitchedOff() const { return switched_off_; }
  bool consoleShown() const;
  std::size_t buffers() const { return buffers_.size(); }
  std::size_t framebuffers() const { return framebuffers_.size() - 1; }  // less the console's
  std::size_t blobs() const { return blobs_.size(); }
  std::size_t clients() const { return clients_.size(); }

 private:
  class File;
  struct Buffer {
    std::shared_ptr<std::byte[]> memory;
    std::uint32_t width, height, pitch;
    std::uint64_t size;
    const File* owner;
  };
  struct Framebuffer {
    std::uint32_t buffer, width, height, pitch, format;
    const File* owner;
  };
  struct Blob {
    std::vector<std::byte> bytes;
    const File* owner;
  };
  struct Object {
    std::uint32_t type;
    std::size_t index;
    std::map<std::string, std::uint64_t> values;
  };
  using State = std::map<std::uint32_t, Object>;
  struct Pending {
    Time at;
    bool wants_event;
    std::uint64_t user_data;
    const File* client;
  };

  Time nextVblank() const;
  void settle();
  std::uint32_t propertyId(const std::string& name);
  std::string propertyName(std::uint32_t id) const;
  int apply(const drm_mode_atomic& a, State& next) const;
  int check(const State& next, bool allow_modeset) const;
  int checkPlane(const State& next, const Object& plane) const;
  bool needsModeset(const State& next) const;
  void clientClosed(const File* client);
  void showConsole();
  std::uint32_t framebufferPixel(const Framebuffer& fb, int x, int y) const;
  void removeFramebuffer(std::uint32_t id);

  int ioctl(File& client, unsigned long request, void* argument);
  int getResources(drm_mode_card_res& r);
  int getConnector(drm_mode_get_connector& c);
  int getEncoder(drm_mode_get_encoder& e);
  int getCrtc(drm_mode_crtc& c);
  int setCrtc(const drm_mode_crtc& c);
  int getPlanes(drm_mode_get_plane_res& r);
  int getPlane(drm_mode_get_plane& p);
  int getProperties(drm_mode_obj_get_properties& p);
  int getProperty(drm_mode_get_property& p);
  int createBlob(const File& client, drm_mode_create_blob& b);
  int createDumb(const File& client, drm_mode_create_dumb& d);
  int addFramebuffer(const File& client, drm_mode_fb_cmd2& f);
  int importDmabuf(const File& client, drm_prime_handle& p);
  int atomicCommit(File& client, const drm_mode_atomic& a);

  FakeKernel& kernel_;
  std::string name_;
  std::vector<Connector> connectors_;
  std::vector<PlaneKind> planes_;
  State state_;                          // as committed
  State screen_;                         // as scanned out since the last vblank
  std::vector<std::string> properties_;  // id - 1000: name
  std::map<std::uint32_t, Buffer> buffers_;
  std::map<std::uint32_t, Framebuffer> framebuffers_;
  std::map<std::uint32_t, Blob> blobs_;
  std::vector<File*> clients_;
  const File* master_ = nullptr;
  std::vector<std::unique_ptr<FakeDevice>> status_files_;
  std::optional<Pending> pending_;
  std::uint32_t console_framebuffer_ = 0, next_id_ = 5000;
  std::uint64_t flips_ = 0, modesets_ = 0, probes_ = 0, switched_off_ = 0;
  drm_mode_modeinfo console_mode_{};
  bool present_ = true;
};

}  // namespace depthscope::fake
