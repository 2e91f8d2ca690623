#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>

struct AVFrame;

namespace depthscope::capture {

/// What was found wrong with a clip so far.
struct ClipDamage {
  std::uint64_t unreadable = 0;  // packets or images that did not decode
  std::uint64_t concealed = 0;   // pictures that came out damaged
  std::int64_t read = 0;         // pictures of the last pass that broke off early
  std::int64_t announced = 0;    // what its container had announced; 0: none broke off
};

/// The pictures of a clip in their order, decoded. Used from one thread. The same clip gives the
/// same pictures, bit for bit, damaged or not, in every pass.
class ClipReader {
 public:
  enum class Outcome : std::uint8_t { Picture, Unreadable, End };

  virtual ~ClipReader() = default;
  /// Decodes the next picture into `picture`, whose former content is let go. Unreadable: this one
  /// could not be decoded, the next may. Does not throw.
  virtual Outcome next(AVFrame& picture) = 0;
  /// Back to the first picture; false when the clip can no longer be opened. Does not throw.
  virtual bool rewind() = 0;
  /// [1/s], 0 when the clip does not say.
  virtual double fps() const = 0;
  /// 0 when the clip does not say.
  virtual std::int64_t frameCount() const = 0;
  virtual ClipDamage damage() const = 0;
};

/// A VideoDecoder or an ImageFolder, by what `path` is. Throws InputError.
std::unique_ptr<ClipReader> openClip(const std::filesystem::path& path);

}  // namespace depthscope::capture
