#pragma once
#include "platform/display/dma_picture.hpp"
#include "platform/display/kms/card.hpp"

namespace depthscope::platform::kms {

/// A captured picture made known to a card as a framebuffer, without a copy. It is made anew for
/// each picture: a descriptor's number says nothing about which memory is behind it once a capture
/// card was opened again, and an old picture that is taken for a new one is the worst there is.
class ImportedPicture {
 public:
  ImportedPicture() = default;
  /// 0 or -errno. The card outlives the picture at its place.
  static int import(Card& card, const DmaPicture& picture, ImportedPicture& imported);
  ImportedPicture(ImportedPicture&& other) noexcept { *this = std::move(other); }
  ImportedPicture& operator=(ImportedPicture&& other) noexcept;
  ~ImportedPicture() { reset(); }

  std::uint32_t framebuffer() const { return framebuffer_; }
  void reset();

 private:
  Card* card_ = nullptr;
  std::uint32_t framebuffer_ = 0;
  std::array<std::uint32_t, 3> handles_{};  // 0: none
};

}  // namespace depthscope::platform::kms
