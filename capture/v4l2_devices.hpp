#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "capture/v4l2_node.hpp"
#include "capture/v4l2_settings.hpp"

namespace depthscope::capture {

/// What a card can be set to.
struct CaptureInput {
  int index = 0;
  std::string name;
  std::string state;     // "ok", or what is missing, in words
  bool current = false;  // the one that is set
};
struct CaptureFormat {
  std::string fourcc, description;
  bool usable = false;             // one that the source can turn into a picture
  std::vector<std::string> sizes;  // "1920x1080 at 60, 30", as far as the driver tells
};

/// A video node as found.
struct CaptureDevice {
  std::string path, driver, card, bus;
  std::vector<std::string> links;  // under /dev/v4l, by which it can be named too
  std::string error;  // why it cannot be opened; empty: it can, and what follows is known
  bool multiplanar = false;
  std::vector<CaptureInput> inputs;
  std::vector<CaptureFormat> formats;
  std::string signal;     // at the current input: "1920x1080 at 60.00", or what is wrong with it
  bool has_edid = false;  // there is a memory for one
};

/// Every node under /dev that captures video, in the order of their numbers, and those that cannot
/// be asked. Changes nothing of them.
std::vector<CaptureDevice> listCaptureDevices(kernel::SystemCalls& calls);

/// What a source with these settings would take now.
struct CaptureChoice {
  std::string path;    // empty: nothing, `reason` tells why
  std::string input;   // its name; may be empty
  std::string format;  // "NV12 1920x1080"; empty: none, `reason` tells why
  std::string reason;
};
CaptureChoice chooseCapture(kernel::SystemCalls& calls, const V4l2Settings& settings);

/// Paths of the video nodes under /dev in the order of their numbers.
std::vector<std::string> videoNodes(kernel::SystemCalls& calls);

/// Opens the node that `selection` means (see V4l2Settings::device), the first in the order of
/// numbers. 0 or -errno with the reason in `detail`: -ENODEV none there, -EACCES nodes are there
/// but may not be opened.
int openSelected(kernel::SystemCalls& calls, std::string_view selection, V4l2Node& node,
                 std::string& detail);

/// What errno value `error` (of either sign) means, in words.
std::string errorText(int error);

/// Throws InputError unless `selection` has one of the forms that V4l2Settings::device names.
void requireSelection(const std::string& selection);

}  // namespace depthscope::capture
