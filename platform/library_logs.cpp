#include "platform/library_logs.hpp"

extern "C" {
#include <libavutil/log.h>
}

namespace depthscope::platform {

void silenceLibraries() {
  av_log_set_level(AV_LOG_QUIET);
}

}  // namespace depthscope::platform
