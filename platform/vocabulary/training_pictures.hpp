#pragma once
#include <filesystem>
#include <vector>

#include "slam/descriptor.hpp"

namespace depthscope::platform {

/// Appends the features of every `every`-th picture of a clip: a sequence folder (video.* or
/// frames/, and camera.yaml, by which the lens is known), a folder of pictures, or a video.
/// Pictures without a feature are left out. Throws InputError naming the clip when it cannot be
/// read to its end.
void addTrainingPictures(const std::filesystem::path& input, int every,
                         std::vector<std::vector<slam::Descriptor>>& pictures);

}  // namespace depthscope::platform
