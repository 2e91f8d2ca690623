// Vocabularies as bytes: files, and the one built into the program.
#include <bit>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

#include "slam/vocabulary.hpp"
#include "types/error.hpp"

// The bytes of the vocabulary that comes with the program, from the file named by CMake.
asm(".section .rodata\n"
    ".balign 8\n"
    ".global depthscope_vocabulary_begin\n"
    ".global depthscope_vocabulary_end\n"
    "depthscope_vocabulary_begin:\n"
    ".incbin \"" DEPTHSCOPE_VOCABULARY
    "\"\n"
    "depthscope_vocabulary_end:\n"
    ".byte 0\n"
    ".previous\n");
extern "C" const std::byte depthscope_vocabulary_begin[];
extern "C" const std::byte depthscope_vocabulary_end[];

namespace depthscope::slam {

namespace {

static_assert(std::endian::native == std::endian::little, "files are written as memory has them");

constexpr std::array<char, 8> kMagic{'D', 'S', 'V', 'O', 'C', 'A', 'B', 0};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = sizeof kMagic + 2 * sizeof(std::uint32_t);
constexpr std::size_t kNodeBytes = sizeof(Descriptor) + 2 * sizeof(std::uint32_t) + sizeof(float);
constexpr std::size_t kMaxFileBytes = 64 << 20;  // far above any that makes sense

std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 0x100000001b3u;
  return hash;
}

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
    return value;
  }

 private:
  std::span<const std::byte> bytes_;
};

template <class T>
void put(std::vector<std::byte>& bytes, const T& value) {
  const auto* p = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), p, p + sizeof value);
}

}  // namespace

Vocabulary Vocabulary::builtIn() {
  return parse({depthscope_vocabulary_begin, depthscope_vocabulary_end}, "built-in vocabulary");
}

Vocabulary Vocabulary::parse(std::span<const std::byte> bytes, std::string_view name) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(std::string(name) + ": " + what +
                     ", expected a file made by depthscope train-vocabulary");
  };
  if (bytes.size() < kHeaderBytes + sizeof(std::uint64_t)) refuse("is too short");
  Reader reader(bytes);
  if (reader.take<std::array<char, 8>>() != kMagic) refuse("is not a vocabulary");
  if (const auto version = reader.take<std::uint32_t>(); version != kVersion)
    refuse("has version " + std::to_string(version) + " instead of " + std::to_string(kVersion));
  const std::size_t count = reader.take<std::uint32_t>();
  const std::size_t content = kHeaderBytes + count * kNodeBytes;
  if (bytes.size() != content + sizeof(std::uint64_t)) refuse("is truncated or too long");
  if (Reader(bytes.subspan(content)).take<std::uint64_t>() != checksum(bytes.first(content)))
    refuse("is damaged (checksum)");
  std::vector<Node> nodes(count);
  for (Node& node : nodes) {
    node.centre = reader.take<Descriptor>();
    node.first = reader.take<std::uint32_t>();
    node.children = reader.take<std::uint32_t>();
    node.weight = reader.take<float>();
  }
  return Vocabulary(std::move(nodes), name);
}

Vocabulary Vocabulary::load(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  if (size < 0 || size > static_cast<std::streamoff>(kMaxFileBytes))
    throw InputError(file.string() +
                     ": cannot be read, expected a file made by depthscope train-vocabulary");
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), size))
    throw InputError(file.string() +
                     ": cannot be read, expected a file made by depthscope train-vocabulary");
  return parse(bytes, file.string());
}

void Vocabulary::save(const std::filesystem::path& file) const {
  std::vector<std::byte> bytes;
  bytes.reserve(kHeaderBytes + nodes_.size() * kNodeBytes + sizeof(std::uint64_t));
  put(bytes, kMagic);
  put(bytes, kVersion);
  put(bytes, static_cast<std::uint32_t>(nodes_.size()));
  for (const Node& node : nodes_) {
    put(bytes, node.centre);
    put(bytes, node.first);
    put(bytes, node.children);
    put(bytes, node.weight);
  }
  put(bytes, checksum(bytes));
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace depthscope::slam
