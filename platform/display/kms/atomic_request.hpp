#pragma once
#include <array>

#include "platform/display/kms/card.hpp"

namespace depthscope::platform::kms {

/// A set of properties that change together (DRM_IOCTL_MODE_ATOMIC), in fixed memory.
class AtomicRequest {
 public:
  /// All properties of one object are added one after the other. A property that the driver does
  /// not have (id 0) is left out.
  void add(std::uint32_t object, std::uint32_t property, std::uint64_t value) {
    if (property == 0) return;
    if (count_ == property_room || (newObject(object) && object_count_ == object_room)) {
      overflow_ = true;
      return;
    }
    if (newObject(object)) {
      objects_[object_count_] = object;
      counts_[object_count_++] = 0;
    }
    ++counts_[object_count_ - 1];
    properties_[count_] = property;
    values_[count_++] = value;
  }

  /// 0 or -errno. `flags`: DRM_MODE_ATOMIC_... and DRM_MODE_PAGE_FLIP_EVENT; `user_data` comes back
  /// in the event.
  int commit(const Card& card, std::uint32_t flags, std::uint64_t user_data) const {
    if (overflow_) return -E2BIG;
    drm_mode_atomic atomic{};
    atomic.flags = flags;
    atomic.count_objs = object_count_;
    atomic.objs_ptr = reinterpret_cast<std::uintptr_t>(objects_.data());
    atomic.count_props_ptr = reinterpret_cast<std::uintptr_t>(counts_.data());
    atomic.props_ptr = reinterpret_cast<std::uintptr_t>(properties_.data());
    atomic.prop_values_ptr = reinterpret_cast<std::uintptr_t>(values_.data());
    atomic.user_data = user_data;
    return card.ioctl(DRM_IOCTL_MODE_ATOMIC, &atomic);
  }

 private:
  static constexpr std::size_t object_room = 32, property_room = 160;

  bool newObject(std::uint32_t object) const {
    return object_count_ == 0 || objects_[object_count_ - 1] != object;
  }

  std::array<std::uint32_t, object_room> objects_, counts_;
  std::array<std::uint32_t, property_room> properties_;
  std::array<std::uint64_t, property_room> values_;
  std::uint32_t object_count_ = 0, count_ = 0;
  bool overflow_ = false;
};

}  // namespace depthscope::platform::kms
