#include "capture/image_folder.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

#include "capture/file_source.hpp"
#include "types/error.hpp"

namespace depthscope::capture {

namespace {

namespace fs = std::filesystem;

bool hasPictureName(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return path.filename().string().front() != '.' &&
         (extension == ".png" || extension == ".jpg" || extension == ".jpeg");
}

std::string sizeText(const ImageHeader& header) {
  return std::to_string(header.width) + "x" + std::to_string(header.height);
}

AvPtr<AVCodecContext> openImageDecoder(AVCodecID codec) {
  AVCodecParameters parameters{};
  parameters.codec_type = AVMEDIA_TYPE_VIDEO;
  parameters.codec_id = codec;
  parameters.format = AV_PIX_FMT_NONE;
  AvPtr<AVCodecContext> decoder = openDecoder(parameters, true);
  if (!decoder)
    throw InputError(std::string("libavcodec on this machine cannot decode ") +
                     avcodec_get_name(codec) + " pictures");
  return decoder;
}

/// Names alone, in their order: a path takes ten times as much memory, and a clip may have many.
std::vector<std::string> listNames(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (hasPictureName(it->path()) && it->is_regular_file(error))
      names.push_back(it->path().filename().string());
  if (error) throw InputError(folder.string() + ": cannot be listed (" + error.message() + ")");
  if (names.empty())
    throw InputError(folder.string() + ": no pictures (.png, .jpg) in this folder");
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::vector<fs::path> listPictures(const fs::path& folder) {
  std::vector<fs::path> pictures;
  for (const std::string& name : listNames(folder)) pictures.push_back(folder / name);
  return pictures;
}

ImageFolder::ImageFolder(const fs::path& path) : folder_(path), packet_(makeAvPacket()) {
  silenceAv();
  std::optional<ImageHeader> first;
  for (std::string& name : listNames(path)) {
    const fs::path picture = path / name;
    const std::optional<ImageHeader> header = readImageHeader(picture);
    if (!header)
      throw InputError(picture.string() + ": empty, truncated or not a PNG or JPEG picture");
    if (!first) first = header;
    if (header->width != first->width || header->height != first->height)
      throw InputError(picture.string() + ": is " + sizeText(*header) + ", expected " +
                       sizeText(*first) + " like the first picture of the folder");
    files_.push_back({std::move(name), header->kind});
  }
  png_ = openImageDecoder(AV_CODEC_ID_PNG);
  jpeg_ = openImageDecoder(AV_CODEC_ID_MJPEG);
}

ClipReader::Outcome ImageFolder::next(AVFrame& picture) {
  if (next_ == files_.size()) return Outcome::End;
  if (!decode(files_[next_++], picture)) {
    ++damage_.unreadable;
    return Outcome::Unreadable;
  }
  if (isDamaged(picture)) ++damage_.concealed;
  return Outcome::Picture;
}

bool ImageFolder::decode(const File& file, AVFrame& picture) {
  if (!loadPacket(file)) return false;
  AVCodecContext* codec = file.kind == ImageKind::Png ? png_.get() : jpeg_.get();
  const bool sent = avcodec_send_packet(codec, packet_.get()) >= 0;
  av_packet_unref(packet_.get());
  const bool decoded = sent && avcodec_receive_frame(codec, &picture) >= 0;
  // Each picture stands alone: nothing of a broken one may reach the next.
  avcodec_flush_buffers(codec);
  if (!decoded) return false;
  // Still pictures are full range and, if YUV, BT.601 (JFIF 1.02) unless they say otherwise.
  if (picture.color_range == AVCOL_RANGE_UNSPECIFIED) picture.color_range = AVCOL_RANGE_JPEG;
  if (picture.colorspace == AVCOL_SPC_UNSPECIFIED) picture.colorspace = AVCOL_SPC_SMPTE170M;
  return true;
}

/// The whole file as one packet.
bool ImageFolder::loadPacket(const File& file) {
  std::ifstream in(folder_ / file.name, std::ios::binary | std::ios::ate);
  const std::streamoff bytes = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  if (bytes <= 0 || bytes > std::numeric_limits<int>::max() - AV_INPUT_BUFFER_PADDING_SIZE)
    return false;
  if (av_new_packet(packet_.get(), static_cast<int>(bytes)) < 0) return false;
  in.seekg(0);
  in.read(reinterpret_cast<char*>(packet_->data), bytes);
  // A packet that is no key frame would be taken as a difference from the picture before.
  packet_->flags |= AV_PKT_FLAG_KEY;
  if (in.gcount() == bytes) return true;
  av_packet_unref(packet_.get());
  return false;
}

bool ImageFolder::rewind() {
  next_ = 0;
  return true;
}

}  // namespace depthscope::capture
