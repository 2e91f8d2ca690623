#include "capture/frame_source.hpp"

namespace depthscope::capture {

std::string_view toString(SourceStatus status) {
  switch (status) {
    case SourceStatus::Ok:
      return "ok";
    case SourceStatus::Timeout:
      return "timeout";
    case SourceStatus::EndOfStream:
      return "end of stream";
    case SourceStatus::NoDevice:
      return "no device";
    case SourceStatus::NoCable:
      return "no cable";
    case SourceStatus::NoSignal:
      return "no signal";
    case SourceStatus::UnstableSync:
      return "unstable sync";
    case SourceStatus::UnsupportedMode:
      return "unsupported mode";
    case SourceStatus::PermissionDenied:
      return "permission denied";
    case SourceStatus::ReadError:
      return "read error";
    case SourceStatus::DeviceBusy:
      return "device busy";
    case SourceStatus::NoFrames:
      return "no frames";
    case SourceStatus::DamagedFrames:
      return "damaged frames";
  }
  return "unknown";
}

}  // namespace depthscope::capture
