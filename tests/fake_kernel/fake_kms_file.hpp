// The inside of the fake card, for its own source files.
#pragma once
#include <cstring>
#include <deque>

#include "tests/fake_kernel/fake_kms_card.hpp"

namespace depthscope::fake {

// Objects of one kind have ids in a row.
constexpr std::uint32_t first_crtc = 100, first_connector = 200, first_encoder = 300,
                        first_plane = 400, first_property = 1000;

/// One client of the card.
class FakeKmsCard::File final : public FakeFile {
 public:
  explicit File(FakeKmsCard& card) : card_(card) {}
  ~File() override { card_.clientClosed(this); }
  int ioctl(unsigned long request, void* argument) override {
    return card_.ioctl(*this, request, argument);
  }
  std::shared_ptr<std::byte[]> map(std::size_t length, off_t offset, int& error) override {
    const auto found = card_.buffers_.find(static_cast<std::uint32_t>(offset >> 12));
    if (found == card_.buffers_.end() || length > found->second.size) {
      error = -EINVAL;
      return nullptr;
    }
    return found->second.memory;
  }
  ssize_t read(std::span<std::byte> into) override {
    if (!card_.present_) return -ENODEV;
    card_.settle();
    if (events_.empty()) return -EAGAIN;
    std::size_t at = 0;
    while (!events_.empty() && at + sizeof(drm_event_vblank) <= into.size()) {
      std::memcpy(&into[at], &events_.front(), sizeof(drm_event_vblank));
      at += sizeof(drm_event_vblank);
      events_.pop_front();
    }
    return static_cast<ssize_t>(at);
  }
  short events() override {
    card_.settle();
    if (!card_.present_) return POLLIN | POLLERR | POLLHUP;
    return events_.empty() ? 0 : POLLIN;
  }
  std::optional<Time> nextEvent() override {
    return card_.pending_ ? std::optional(card_.pending_->at) : std::nullopt;
  }

  std::deque<drm_event_vblank> events_;
  bool atomic_ = false;

 private:
  FakeKmsCard& card_;
};

}  // namespace depthscope::fake
