#pragma once
#include <linux/videodev2.h>

#include <string>

#include "capture/frame_source.hpp"
#include "capture/v4l2_node.hpp"

namespace depthscope::capture {

/// One of a card's inputs.
struct V4l2Input {
  bool known = false;  // drivers without the notion of inputs have one that is always fine
  int index = 0;
  std::string name;
  __u32 status = 0;           // V4L2_IN_ST_...
  bool has_timings = false;   // digital video: HDMI, DVI, SDI
  bool has_standard = false;  // analogue: PAL, NTSC
};

/// What arrives at an input.
struct SignalState {
  SourceStatus status = SourceStatus::Ok;
  std::string detail;         // why not Ok
  bool has_timings = false;   // the next one is meant
  v4l2_dv_timings timings{};  // as the signal has them
};

/// All inputs of a card; none where the driver knows no inputs.
std::vector<V4l2Input> listInputs(const V4l2Node& node);

/// Switches to the input of this name or number; empty: the one that is set. 0 or -errno with the
/// reason in `detail`.
int selectInput(const V4l2Node& node, const std::string& wanted, V4l2Input& input,
                std::string& detail);

/// What the card says about the signal now. Tells apart no cable (the tower's 5 V are missing,
/// where the driver has an eye on them), no signal, a signal that does not hold still, and one that
/// the card cannot take.
SignalState querySignal(const V4l2Node& node, const V4l2Input& input);

/// Makes the card expect these timings, or the analogue standard that it finds. 0 or -errno.
int adoptTimings(const V4l2Node& node, const V4l2Input& input, const SignalState& signal);

/// Whether both are the same video mode; a pixel clock may be measured, so it may differ by half a
/// percent.
bool sameMode(const v4l2_dv_timings& a, const v4l2_dv_timings& b);

/// Frames a second of a mode; 0 when it does not say. Interlaced: both fields make one.
double frameRate(const v4l2_dv_timings& timings);

/// "1920x1080 at 60.00" or "1920x1080 at 25.00, interlaced".
std::string modeText(const v4l2_dv_timings& timings);

/// What V4L2_IN_ST_... flags say, in words; "ok" for none.
std::string inputStateText(__u32 status);

}  // namespace depthscope::capture
