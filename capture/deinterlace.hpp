#pragma once
#include "capture/frame.hpp"

namespace depthscope::capture {

/// One field, and how its lines lie in the picture that it came in.
struct FieldLines {
  bool top = true;  // it is the even lines of the whole picture, counted from 0
  enum class Place {
    Alone,       // nothing else is in the picture
    Woven,       // every other line, where it belongs
    FirstHalf,   // upper half of every plane
    SecondHalf,  // lower half
  } place = Place::Alone;
};

/// Makes a whole picture of one field: its lines go where they belong, each line between two is
/// their mean, rounded up; at the border the nearest is taken twice. No line of the other field is
/// used, which was captured at another time: woven together, what moves would be torn into combs.
/// `whole` has the pixel format and width of `from` and the frame's full height; 8 bits a sample.
void deinterlace(const Frame& from, const FieldLines& lines, Frame& whole);

}  // namespace depthscope::capture
