#pragma once
#include <algorithm>

#include "tests/fake_kernel/fake_v4l2_card.hpp"

namespace depthscope::fake {

/// What the kernel keeps for an open file; lives, as there, until the file is closed and nothing of
/// it is mapped any more.
struct FakeV4l2Card::Session {
  explicit Session(FakeV4l2Card& owner) : card(owner) { card.sessions_.push_back(this); }
  ~Session() {
    card.release(*this);
    std::erase(card.sessions_, this);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  FakeV4l2Card& card;
  bool subscribed = false, gone = false;
  std::deque<v4l2_event> events;
};

struct FakeV4l2Card::File final : FakeFile {
  explicit File(std::shared_ptr<Session> opened) : session(std::move(opened)) {}
  int ioctl(unsigned long request, void* argument) override {
    session->card.catchUp();
    if (session->gone) return -ENODEV;
    return session->card.answer(*session, request, argument);
  }
  std::shared_ptr<std::byte[]> map(std::size_t length, off_t offset, int& error) override {
    return session->card.map(session, length, offset, error);
  }
  short events() override {
    session->card.catchUp();
    if (session->gone) return POLLERR | POLLHUP | POLLPRI;
    const FakeV4l2Card& card = session->card;
    int events = session->events.empty() ? 0 : POLLPRI;
    if (card.owner_ == session.get() && !card.outgoing_.empty()) events |= POLLIN;
    return static_cast<short>(events);
  }
  std::optional<Time> nextEvent() override {
    const FakeV4l2Card& card = session->card;
    std::optional<Time> next;
    if (!card.schedule_.empty()) next = card.schedule_.begin()->first;
    if (card.streaming_ && (!next || card.nextFrame() < *next)) next = card.nextFrame();
    return next;
  }

  std::shared_ptr<Session> session;
};

}  // namespace depthscope::fake
