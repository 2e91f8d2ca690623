#pragma once
#include "platform/arguments.hpp"

namespace depthscope::platform {

/// `depthscope train-vocabulary --input DIR... --out FILE [--every N] [--branching N] [--levels N]
/// [--seed N]`. Returns the exit status; throws InputError for bad arguments or clips.
int trainVocabularyCommand(Arguments arguments);

}  // namespace depthscope::platform
