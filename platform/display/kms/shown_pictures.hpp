#pragma once
#include <array>
#include <optional>

#include "platform/display/display.hpp"

namespace depthscope::platform::kms {

/// The last pictures that were shown, until somebody asks for them; the oldest is forgotten first.
class ShownPictures {
 public:
  void add(const ShownPicture& shown) {
    if (count_ == pictures_.size()) {
      first_ = (first_ + 1) % pictures_.size();
      --count_;
    }
    pictures_[(first_ + count_++) % pictures_.size()] = shown;
  }
  std::optional<ShownPicture> take() {
    if (count_ == 0) return std::nullopt;
    const ShownPicture shown = pictures_[first_];
    first_ = (first_ + 1) % pictures_.size();
    --count_;
    return shown;
  }

 private:
  std::array<ShownPicture, 4> pictures_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace depthscope::platform::kms
