#pragma once
#include "platform/arguments.hpp"

namespace depthscope::platform {

/// `depthscope calibrate --pattern chessboard|charuco --size COLSxROWS --square MM --input PATH
/// --out FILE
/// [--model pinhole|fisheye]`. Returns the exit status; throws InputError for bad arguments or
/// pictures.
int calibrateCommand(Arguments arguments);

}  // namespace depthscope::platform
