#include "platform/daemon/frame_ledger.hpp"

namespace depthscope::platform {

FrameLedger::~FrameLedger() {
  while (written_ < added_) writeOldest();
}

void FrameLedger::submitted(std::int64_t index, const FrameTimes& times) {
  clock_.add(times);
  if (added_ - written_ == waiting_.size()) writeOldest();
  waiting_[added_++ % waiting_.size()] = {index, times};
}

void FrameLedger::shown(std::int64_t index, Time at) {
  while (written_ < added_ && oldest().index <= index) {
    if (oldest().index == index) {
      oldest().times.shown = at;
      clock_.addShown(oldest().times.captured, at);
    }
    writeOldest();
  }
}

void FrameLedger::writeOldest() {
  if (log_ != nullptr) log_->add(oldest().times);
  ++written_;
}

}  // namespace depthscope::platform
