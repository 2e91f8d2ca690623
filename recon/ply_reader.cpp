#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "recon/mesh_geometry.hpp"
#include "recon/mesh_io.hpp"
#include "types/error.hpp"

namespace depthscope::recon {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is read as the machine stores it");

enum class Scalar { I8, U8, I16, U16, I32, U32, F32, F64 };

struct Property {
  std::string name;
  Scalar type = Scalar::F32;
  std::optional<Scalar> count_type;  // set: a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

std::size_t sizeOf(Scalar s) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(s)];
}

/// One PLY file in memory, read value by value.
class PlyFile {
 public:
  explicit PlyFile(const std::filesystem::path& path) : path_(path) {
    std::error_code ec;
    if (!std::filesystem::is_regular_file(path, ec)) fail("not a readable file");
    std::ifstream in(path, std::ios::binary);
    if (!in) fail("cannot be opened for reading");
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
    readHeader();
  }

  const std::vector<Element>& elements() const { return elements_; }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_.string() + ": " + what);
  }

  /// The next value of the body as a number.
  double next(Scalar type) { return ascii_ ? nextAscii() : nextBinary(type); }

  /// The length of the next list; bounded by what is left of the file.
  std::size_t nextCount(Scalar type) {
    const double n = next(type);
    if (!(n >= 0) || n > static_cast<double>(bytes_.size() - at_))
      fail("a list longer than the file");
    return static_cast<std::size_t>(n);
  }

 private:
  void readHeader() {
    if (headerLine() != "ply") fail("not a PLY file (its first line is not 'ply')");
    bool has_format = false;
    for (;;) {
      std::istringstream line(headerLine());
      std::string keyword;
      line >> keyword;
      if (keyword == "end_header") break;
      if (keyword == "format") {
        readFormat(line);
        has_format = true;
      } else if (keyword == "element") {
        readElement(line);
      } else if (keyword == "property") {
        readProperty(line);
      } else if (keyword != "comment" && keyword != "obj_info") {
        fail("unknown PLY header line '" + line.str() + "'");
      }
    }
    if (!has_format) fail("PLY header without a format line");
  }

  std::string headerLine() {
    const auto end =
        std::find(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), bytes_.end(), '\n');
    if (end == bytes_.end()) fail("PLY header is cut short (no 'end_header')");
    std::string line(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), end);
    at_ += line.size() + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

  void readFormat(std::istringstream& line) {
    std::string format;
    line >> format;
    ascii_ = format == "ascii";
    if (!ascii_ && format != "binary_little_endian")
      fail("PLY format '" + format + "', expected ascii or binary_little_endian");
  }

  void readElement(std::istringstream& line) {
    Element e;
    if (!(line >> e.name >> e.count)) fail("bad PLY header line '" + line.str() + "'");
    // Every element takes at least one byte: a count beyond the file's size is a damaged header.
    if (e.count > bytes_.size())
      fail(std::to_string(e.count) + " of element '" + e.name + "' do not fit in the file");
    elements_.push_back(std::move(e));
  }

  void readProperty(std::istringstream& line) {
    if (elements_.empty()) fail("PLY property before any element");
    Property p;
    std::string type;
    line >> type;
    if (type == "list") {
      line >> type;
      p.count_type = scalar(type);
      line >> type;
    }
    p.type = scalar(type);
    if (!(line >> p.name)) fail("bad PLY header line '" + line.str() + "'");
    elements_.back().properties.push_back(std::move(p));
  }

  Scalar scalar(const std::string& type) const {
    constexpr const char* kNames[][2] = {
        {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
        {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    for (std::size_t i = 0; i < std::size(kNames); ++i)
      if (type == kNames[i][0] || type == kNames[i][1]) return static_cast<Scalar>(i);
    fail("unknown PLY type '" + type + "'");
  }

  double nextAscii() {
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
    if (at_ >= bytes_.size()) fail("cut short");
    char* end = nullptr;
    const double value = std::strtod(bytes_.c_str() + at_, &end);  // std::string ends in a zero
    const auto after = static_cast<std::size_t>(end - bytes_.c_str());
    if (after == at_) fail("a number was expected at byte " + std::to_string(at_));
    at_ = after;
    return value;
  }

  template <typename T>
  double load() {
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return static_cast<double>(value);
  }

  double nextBinary(Scalar type) {
    if (bytes_.size() - at_ < sizeOf(type)) fail("cut short");
    switch (type) {
      case Scalar::I8:
        return load<std::int8_t>();
      case Scalar::U8:
        return load<std::uint8_t>();
      case Scalar::I16:
        return load<std::int16_t>();
      case Scalar::U16:
        return load<std::uint16_t>();
      case Scalar::I32:
        return load<std::int32_t>();
      case Scalar::U32:
        return load<std::uint32_t>();
      case Scalar::F32:
        return load<float>();
      case Scalar::F64:
        return load<double>();
    }
    return 0;
  }

  std::filesystem::path path_;
  std::string bytes_;
  std::size_t at_ = 0;  // next byte to be read
  bool ascii_ = false;
  std::vector<Element> elements_;
};

void skip(PlyFile& file, const Element& element) {
  for (std::size_t i = 0; i < element.count; ++i)
    for (const Property& p : element.properties)
      for (std::size_t n = p.count_type ? file.nextCount(*p.count_type) : 1; n > 0; --n)
        file.next(p.type);
}

void readVertices(PlyFile& file, const Element& element, SurfaceMesh& mesh) {
  constexpr const char* kNames[] = {"x", "y", "z", "nx", "ny", "nz", "confidence"};
  std::array<bool, 7> has{};
  std::vector<std::size_t> slot;  // of each property among kNames; 7: skipped
  for (const Property& p : element.properties) {
    const auto i = static_cast<std::size_t>(std::find(kNames, kNames + 7, p.name) - kNames);
    slot.push_back(p.count_type ? 7 : i);
    if (slot.back() < 7) has[i] = true;
  }
  if (!has[0] || !has[1] || !has[2]) file.fail("PLY vertices without x, y and z");
  const bool has_normal = has[3] && has[4] && has[5];
  for (std::size_t v = 0; v < element.count; ++v) {
    std::array<float, 8> value{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      for (std::size_t n = property.count_type ? file.nextCount(*property.count_type) : 1; n > 0;
           --n)
        value[slot[p]] = static_cast<float>(file.next(property.type));
    }
    for (std::size_t i = 0; i < 7; ++i)
      if (!std::isfinite(value[i])) file.fail("vertex " + std::to_string(v) + " is not finite");
    mesh.vertices.emplace_back(value[0], value[1], value[2]);
    if (has_normal) mesh.normals.emplace_back(value[3], value[4], value[5]);
    mesh.confidence.push_back(has[6] ? std::clamp(value[6], 0.f, 1.f) : 1.f);
  }
}

void readFaces(PlyFile& file, const Element& element, SurfaceMesh& mesh) {
  for (std::size_t f = 0; f < element.count; ++f) {
    for (const Property& p : element.properties) {
      const std::size_t n = p.count_type ? file.nextCount(*p.count_type) : 1;
      const bool corners = p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
      std::array<std::uint32_t, 3> t{};  // first, previous and current corner: a fan
      for (std::size_t i = 0; i < n; ++i) {
        const double index = file.next(p.type);
        if (!corners) continue;
        if (!(index >= 0) || index >= static_cast<double>(mesh.vertices.size()))
          file.fail("face " + std::to_string(f) + " names a vertex that does not exist");
        t[1] = t[2];
        t[2] = static_cast<std::uint32_t>(index);
        if (i == 0) t[0] = t[2];
        if (i >= 2) mesh.triangles.push_back(t);
      }
    }
  }
}

}  // namespace

SurfaceMesh readPly(const std::filesystem::path& path) {
  PlyFile file(path);
  SurfaceMesh mesh;
  bool has_vertices = false;
  for (const Element& element : file.elements()) {
    if (element.name == "vertex") {
      readVertices(file, element, mesh);
      has_vertices = true;
    } else if (element.name == "face") {
      readFaces(file, element, mesh);
    } else {
      skip(file, element);
    }
  }
  if (!has_vertices) file.fail("PLY file without vertices");
  if (mesh.normals.empty()) computeNormals(mesh);
  return mesh;
}

}  // namespace depthscope::recon
