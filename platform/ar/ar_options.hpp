#pragma once
#include "platform/arguments.hpp"
#include "platform/config/settings.hpp"
#include "platform/unique_fd.hpp"
#include "types/camera_model.hpp"

namespace depthscope::platform {

/// What depthscoped hands to the AR process at its start.
struct ArOptions {
  UniqueFd shared_memory;  // memfd with frames, poses and surfaces
  UniqueFd commands;       // socket; its end means that the video process is gone
  CameraModel camera;
  Settings settings;
};

/// Throws InputError.
ArOptions parseArOptions(Arguments arguments);

}  // namespace depthscope::platform
