#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "capture/clip_reader.hpp"
#include "capture/file_source.hpp"
#include "capture/picture_converter.hpp"

namespace depthscope::capture {

/// Where a player stands in its clip, and what there is to show.
struct ClipPosition {
  std::uint64_t sequence = 0;  // counted over all passes
  double media_time_s = 0;     // sequence / fps
  double delay_ms = 0;         // by script
  SourceStatus status = SourceStatus::Ok;
};

/// A clip acted out: looped, with its script of faults, in frames of its own pools. Knows no clock;
/// the sources that pace it do. Used from one thread at a time.
class ClipPlayer {
 public:
  /// Opens the clip and decodes its first picture. Throws InputError.
  explicit ClipPlayer(const FileSourceSettings& settings);

  /// Decodes on to the next position; false at the end of the clip. Does not throw.
  bool advance();
  const ClipPosition& position() const { return position_; }
  /// A buffer for the picture at this position, or an empty frame when none is free.
  Frame acquire();
  /// Draws the picture at this position, whose status is Ok, into a buffer from acquire().
  bool render(Frame& frame);

  const FrameFormat& format() const { return outputs_.front().pool->format(); }
  double fps() const { return fps_; }
  ClipDamage damage() const { return reader_->damage(); }

 private:
  /// The clip's own format, or one that the script resizes to.
  struct Output {
    std::shared_ptr<FramePool> pool;
    PictureConverter converter;
  };
  ClipReader::Outcome decodeNext();
  std::size_t outputFor(const FaultEvent* resize) const;

  FileSourceSettings settings_;
  std::unique_ptr<ClipReader> reader_;
  std::vector<Output> outputs_;  // the clip's own first
  double fps_ = 0;               // [1/s]

  AvPtr<AVFrame> decoded_;  // at this position
  AvPtr<AVFrame> shown_;    // to be drawn: decoded_ itself, or an earlier one that is repeated
  bool first_is_decoded_ = true;
  std::int64_t clip_frame_ = -1;  // within this pass
  std::uint64_t next_sequence_ = 0;
  ClipPosition position_;
  std::size_t output_ = 0;
  bool damage_picture_ = false;  // by script
};

/// One line for FrameSource::damage().
std::string describe(const ClipDamage& damage, const std::filesystem::path& path);

}  // namespace depthscope::capture
