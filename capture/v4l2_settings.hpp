#pragma once
#include <string>

namespace depthscope::capture {

/// Which capture card, what of it, and how patient to be with it.
struct V4l2Settings {
  /// "auto": the first there is; "/dev/...": a node or a link to one, such as
  /// /dev/v4l/by-path/...; "name:TEXT": the card's name has TEXT in it; "bus:TEXT": exactly this
  /// place on the bus.
  std::string device{};
  std::string input{};  // of the card, by number or name; empty: leave it as it is
  /// What a card with EDID memory tells the tower: "auto" the built-in one where the card has none,
  /// "builtin" that in any case, "none" to leave it alone, or a file.
  std::string edid = "auto";
  std::string pixel_format = "auto";  // four characters as v4l2-ctl shows them; "auto": the best
  int width = 0, height = 0;          // [px] wanted of cards that offer a choice; 0: their own
  double fps = 0;                     // [1/s] likewise; 0: the highest
  int buffers = 8;                    // pictures in the card's queue, 4 to 32
  int retry_ms = 100;                 // pause between two attempts to get a card or its signal back
  int restart_ms = 1000;  // no picture for so long although there is a signal: the card is reopened
};

}  // namespace depthscope::capture
