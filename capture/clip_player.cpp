#include "capture/clip_player.hpp"

#include <cmath>
#include <utility>

#include "types/error.hpp"

namespace depthscope::capture {

namespace {

constexpr double kDefaultFps = 30;
constexpr double kMaxFps = 1000;
constexpr int kMinBuffers = 2;

double chooseFps(const FileSourceSettings& settings, double clip_fps) {
  if (!(settings.fps >= 0 && settings.fps <= kMaxFps))
    throw InputError(settings.path.string() + ": fps " + std::to_string(settings.fps) +
                     ": expected 0 (the clip's own) to 1000");
  if (settings.fps > 0) return settings.fps;
  return std::isfinite(clip_fps) && clip_fps > 0 && clip_fps <= kMaxFps ? clip_fps : kDefaultFps;
}

/// Overwrites the middle third of the picture with noise that depends on `seed` alone.
void scramble(Frame& frame, std::uint64_t seed) {
  std::uint64_t state = seed * 2 + 1;
  for (int plane = 0; plane < planeCount(frame.format.pixel_format); ++plane) {
    const PlaneSize size = planeSize(frame.format, plane);
    for (int row = size.rows / 3; row < size.rows * 2 / 3; ++row) {
      std::uint8_t* bytes = frame.planes[plane].data + row * frame.planes[plane].stride;
      for (int x = 0; x < size.row_bytes; ++x) {
        state = state * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX generator
        bytes[x] = static_cast<std::uint8_t>(state >> 56);
      }
    }
  }
}

}  // namespace

ClipPlayer::ClipPlayer(const FileSourceSettings& settings)
    : settings_(settings),
      reader_(openClip(settings.path)),
      fps_(chooseFps(settings, reader_->fps())),
      decoded_(makeAvFrame()),
      shown_(makeAvFrame()) {
  const std::string name = settings.path.string();
  if (settings.buffers < kMinBuffers || settings.buffers > FramePool::kMaxBuffers)
    throw InputError(name + ": " + std::to_string(settings.buffers) +
                     " frame buffers: expected 2 to 64");
  if (reader_->next(*decoded_) != ClipReader::Outcome::Picture)
    throw InputError(name + ": its first picture cannot be decoded (truncated or damaged)");
  const std::optional<FrameFormat> format = frameFormatOf(*decoded_);
  if (!format) throw InputError(name + ": its pixel format cannot be converted");
  outputs_.push_back({FramePool::create(*format, settings.buffers), {}});
  for (const FaultEvent& event : settings_.faults) {
    if (event.kind != FaultEvent::Kind::Resize || outputFor(&event) != 0) continue;
    FrameFormat resized = *format;
    resized.width = event.width;
    resized.height = event.height;
    if (resized != *format) outputs_.push_back({FramePool::create(resized, settings.buffers), {}});
  }
}

/// Index into outputs_; the clip's own when there is no resize or none of that size.
std::size_t ClipPlayer::outputFor(const FaultEvent* resize) const {
  for (std::size_t i = 1; resize && i < outputs_.size(); ++i) {
    const FrameFormat& format = outputs_[i].pool->format();
    if (format.width == resize->width && format.height == resize->height) return i;
  }
  return 0;
}

/// The next picture of this pass or, when looping, the first of the next pass.
ClipReader::Outcome ClipPlayer::decodeNext() {
  ++clip_frame_;
  if (std::exchange(first_is_decoded_, false)) return ClipReader::Outcome::Picture;
  const ClipReader::Outcome outcome = reader_->next(*decoded_);
  if (outcome != ClipReader::Outcome::End || !settings_.loop || !reader_->rewind()) return outcome;
  clip_frame_ = 0;
  return reader_->next(*decoded_);
}

bool ClipPlayer::advance() {
  const ClipReader::Outcome outcome = decodeNext();
  if (outcome == ClipReader::Outcome::End) return false;
  const FrameFaults faults = faultsAt(settings_.faults, clip_frame_);
  position_.sequence = next_sequence_++;
  position_.media_time_s = static_cast<double>(position_.sequence) / fps_;
  position_.delay_ms = faults.delay_ms;
  position_.status = SourceStatus::Ok;
  output_ = outputFor(faults.resize);
  damage_picture_ = faults.damaged;

  if (outcome == ClipReader::Outcome::Unreadable) {
    position_.status = SourceStatus::ReadError;
  } else if (decoded_->width != format().width || decoded_->height != format().height) {
    position_.status = SourceStatus::UnsupportedMode;
  } else if (!faults.repeated || shown_->data[0] == nullptr) {
    // Swapped, not copied: the decoder writes its next picture over the one before this.
    std::swap(decoded_, shown_);
  }
  if (faults.signal_lost) position_.status = SourceStatus::NoSignal;
  return true;
}

Frame ClipPlayer::acquire() {
  return outputs_[output_].pool->acquire();
}

bool ClipPlayer::render(Frame& frame) {
  if (!outputs_[output_].converter.convert(*shown_, frame)) return false;
  frame.sequence = position_.sequence;
  frame.media_time_s = position_.media_time_s;
  frame.damaged = damage_picture_ || isDamaged(*shown_);
  if (damage_picture_) scramble(frame, position_.sequence);
  return true;
}

std::string describe(const ClipDamage& damage, const std::filesystem::path& path) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (damage.unreadable > 0)
    add(std::to_string(damage.unreadable) + " unreadable packets or images");
  if (damage.concealed > 0) add(std::to_string(damage.concealed) + " damaged pictures");
  if (damage.announced > 0)
    add("breaks off after " + std::to_string(damage.read) + " of " +
        std::to_string(damage.announced) + " announced frames");
  return text.empty() ? text : path.string() + ": " + text;
}

}  // namespace depthscope::capture
