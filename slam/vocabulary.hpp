#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "slam/descriptor.hpp"

namespace depthscope::slam {

using WordId = std::uint32_t;

/// One word of a bag and how much it says about the picture.
struct WordWeight {
  WordId word = 0;
  float weight = 0;
};

/// A hierarchy of binary cluster centres that turns a descriptor into a word, and a picture into a
/// bag of words with which pictures of the same place are found fast (Galvez-Lopez and Tardos
/// 2012). Not changed after it was made; any number of threads may read it.
class Vocabulary {
 public:
  struct Node {
    Descriptor centre;
    std::uint32_t first = 0;     // index of the first child; of a leaf: its word
    std::uint32_t children = 0;  // 0: a leaf
    float weight = 0;            // of a leaf: inverse document frequency, >= 0
  };

  /// Takes nodes in breadth-first order, the root first. Throws InputError that begins with `name`
  /// unless they form a tree whose leaves carry the words 0, 1, 2... in order.
  Vocabulary(std::vector<Node> nodes, std::string_view name);

  /// The one that comes with the program.
  static Vocabulary builtIn();
  /// Reads a file made by save(). Throws InputError naming the file: unreadable, not a vocabulary,
  /// another version, truncated, damaged.
  static Vocabulary load(const std::filesystem::path& file);
  /// load() of bytes in memory; `name` stands for the file.
  static Vocabulary parse(std::span<const std::byte> bytes, std::string_view name);
  /// Little endian: "DSVOCAB", a zero byte, version, number of nodes, the nodes (centre, first,
  /// children, weight), FNV-1a 64 of all before. Throws std::runtime_error naming the file.
  void save(const std::filesystem::path& file) const;

  int words() const { return words_; }
  std::span<const Node> nodes() const { return nodes_; }
  /// Down the tree, to the nearest centre at each level.
  const Node& leafOf(const Descriptor& descriptor) const;
  WordId wordOf(const Descriptor& descriptor) const { return leafOf(descriptor).first; }

  /// The bag of words of a picture: ascending words, weights by term frequency and inverse document
  /// frequency, of sum 1 (of all zero: empty). Allocates nothing where `bag` has room for a word
  /// per descriptor.
  void describe(std::span<const Descriptor> descriptors, std::vector<WordWeight>& bag) const;
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node); }

 private:
  std::vector<Node> nodes_;
  int words_ = 0;
};

/// Similarity of two bags, 0..1: 1 - |a - b|_1 / 2.
double similarity(std::span<const WordWeight> a, std::span<const WordWeight> b);

}  // namespace depthscope::slam
