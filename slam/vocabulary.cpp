#include "slam/vocabulary.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "types/error.hpp"

namespace depthscope::slam {

namespace {

[[noreturn]] void refuse(std::string_view name, const std::string& what) {
  throw InputError(std::string(name) + ": " + what + ", expected a vocabulary of words");
}

/// Number of words, after every link has been checked.
int checkedWords(std::span<const Vocabulary::Node> nodes, std::string_view name) {
  if (nodes.size() < 2 || nodes[0].children == 0) refuse(name, "has no words");
  std::uint64_t next_child = 1;
  std::uint32_t next_word = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vocabulary::Node& node = nodes[i];
    const auto where = [&] { return "node " + std::to_string(i) + " of the tree"; };
    if (node.children == 0) {
      if (node.first != next_word++) refuse(name, where() + " has a word out of order");
      if (!(node.weight >= 0) || !std::isfinite(node.weight))
        refuse(name, where() + " has a weight that is none");
    } else {
      if (node.first != next_child || next_child <= i || node.first + node.children > nodes.size())
        refuse(name, where() + " has children that are not there");
      next_child += node.children;
    }
  }
  if (next_child != nodes.size()) refuse(name, "the tree has loose ends");
  return static_cast<int>(next_word);
}

}  // namespace

Vocabulary::Vocabulary(std::vector<Node> nodes, std::string_view name)
    : nodes_(std::move(nodes)), words_(checkedWords(nodes_, name)) {}

const Vocabulary::Node& Vocabulary::leafOf(const Descriptor& descriptor) const {
  const Node* node = nodes_.data();
  while (node->children > 0) {
    const Node* const first = nodes_.data() + node->first;
    const Node* nearest = first;
    int least = hammingDistance(descriptor, first->centre);
    for (const Node* child = first + 1; child < first + node->children; ++child) {
      const int d = hammingDistance(descriptor, child->centre);
      if (d >= least) continue;
      least = d;
      nearest = child;
    }
    node = nearest;
  }
  return *node;
}

void Vocabulary::describe(std::span<const Descriptor> descriptors,
                          std::vector<WordWeight>& bag) const {
  bag.clear();
  for (const Descriptor& d : descriptors) {
    const Node& leaf = leafOf(d);
    if (leaf.weight > 0) bag.push_back({leaf.first, leaf.weight});
  }
  std::sort(bag.begin(), bag.end(),
            [](const WordWeight& a, const WordWeight& b) { return a.word < b.word; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < bag.size(); ++i) {
    if (kept > 0 && bag[kept - 1].word == bag[i].word)
      bag[kept - 1].weight += bag[i].weight;
    else
      bag[kept++] = bag[i];
  }
  bag.resize(kept);
  double sum = 0;
  for (const WordWeight& w : bag) sum += w.weight;
  for (WordWeight& w : bag) w.weight = static_cast<float>(w.weight / sum);
}

double similarity(std::span<const WordWeight> a, std::span<const WordWeight> b) {
  double common = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].word == b[j].word)
      common += std::min(a[i++].weight, b[j++].weight);
    else if (a[i].word < b[j].word)
      ++i;
    else
      ++j;
  }
  return common;  // for bags of sum 1 the same as 1 - |a - b| / 2
}

}  // namespace depthscope::slam
