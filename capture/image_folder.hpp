#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/av_support.hpp"
#include "capture/clip_reader.hpp"
#include "capture/image_header.hpp"

namespace depthscope::capture {

/// The .png, .jpg and .jpeg files of a folder as a clip, in the byte order of their names; hidden
/// files are passed over.
class ImageFolder final : public ClipReader {
 public:
  /// Looks into every file's header. Throws InputError when there is no picture, when one is
  /// neither PNG nor JPEG or broken off in its header, or when sizes differ.
  explicit ImageFolder(const std::filesystem::path& path);

  Outcome next(AVFrame& picture) override;
  bool rewind() override;
  double fps() const override { return 0; }
  std::int64_t frameCount() const override { return static_cast<std::int64_t>(files_.size()); }
  ClipDamage damage() const override { return damage_; }

 private:
  struct File {
    std::string name;
    ImageKind kind;
  };
  bool decode(const File& file, AVFrame& picture);
  bool loadPacket(const File& file);

  std::filesystem::path folder_;
  std::vector<File> files_;
  std::size_t next_ = 0;
  AvPtr<AVCodecContext> png_, jpeg_;
  AvPtr<AVPacket> packet_;
  ClipDamage damage_;
};

}  // namespace depthscope::capture
