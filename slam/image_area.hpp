#pragma once

namespace depthscope::slam {

/// Part of a picture: columns left..right-1 of rows top..bottom-1. Empty where right <= left or
/// bottom <= top.
struct Area {
  int left = 0, top = 0, right = 0, bottom = 0;  // [px]
};

}  // namespace depthscope::slam
