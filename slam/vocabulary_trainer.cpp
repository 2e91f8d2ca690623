#include "slam/vocabulary_trainer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "types/error.hpp"

namespace depthscope::slam {

namespace {

/// A node whose descriptors have not been clustered yet.
struct Pending {
  std::size_t begin, end;  // of its descriptors
  int level;
};

/// The descriptor that differs least from all of a cluster: bit by bit what most of them have.
class MajorityVote {
 public:
  void add(const Descriptor& d) {
    for (int bit = 0; bit < 256; ++bit) ones_[bit] += (d.bits[bit / 64] >> (bit % 64)) & 1;
    ++count_;
  }
  std::uint32_t count() const { return count_; }
  Descriptor winner() const {
    Descriptor d;
    for (int bit = 0; bit < 256; ++bit)
      if (2 * ones_[bit] > count_) d.bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
    return d;
  }

 private:
  std::array<std::uint32_t, 256> ones_{};
  std::uint32_t count_ = 0;
};

class Clustering {
 public:
  Clustering(const VocabularyTraining& settings) : settings_(settings), generator_(settings.seed) {}

  /// Sorts `descriptors` by cluster; returns the clusters' centres and sizes, none of them empty.
  /// A single cluster: the descriptors cannot be told apart.
  void cluster(std::span<Descriptor> descriptors) {
    spreadCentres(descriptors);
    nearest_.assign(descriptors.size(), 0);
    for (int i = 0; i < settings_.iterations; ++i) {
      const bool moved = assign(descriptors);
      if (i > 0 && !moved) break;
      moveCentres(descriptors);
    }
    assign(descriptors);
    sortByCluster(descriptors);
  }
  std::span<const Descriptor> centres() const { return centres_; }
  std::span<const std::size_t> sizes() const { return sizes_; }

 private:
  void spreadCentres(std::span<const Descriptor> descriptors) {
    const auto draw = [&](std::uint64_t below) {
      return ((static_cast<std::uint64_t>(generator_()) << 32) | generator_()) % below;
    };
    centres_.assign(1, descriptors[draw(descriptors.size())]);
    distance2_.assign(descriptors.size(), ~std::uint64_t{0});
    while (static_cast<int>(centres_.size()) < settings_.branching) {
      std::uint64_t sum = 0;
      for (std::size_t i = 0; i < descriptors.size(); ++i) {
        const auto d = static_cast<std::uint64_t>(hammingDistance(descriptors[i], centres_.back()));
        distance2_[i] = std::min(distance2_[i], d * d);
        sum += distance2_[i];
      }
      if (sum == 0) return;  // every descriptor is a centre already
      std::uint64_t ticket = draw(sum);
      std::size_t chosen = 0;
      while (ticket >= distance2_[chosen]) ticket -= distance2_[chosen++];
      centres_.push_back(descriptors[chosen]);
    }
  }

  bool assign(std::span<const Descriptor> descriptors) {
    bool moved = false;
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      std::uint32_t best = 0;
      int least = 257;
      for (std::uint32_t c = 0; c < centres_.size(); ++c) {
        const int d = hammingDistance(descriptors[i], centres_[c]);
        if (d >= least) continue;
        least = d;
        best = c;
      }
      moved = moved || nearest_[i] != best;
      nearest_[i] = best;
    }
    return moved;
  }

  void moveCentres(std::span<const Descriptor> descriptors) {
    std::vector<MajorityVote> votes(centres_.size());
    for (std::size_t i = 0; i < descriptors.size(); ++i) votes[nearest_[i]].add(descriptors[i]);
    for (std::size_t c = 0; c < centres_.size(); ++c)
      if (votes[c].count() > 0) centres_[c] = votes[c].winner();
  }

  void sortByCluster(std::span<Descriptor> descriptors) {
    std::vector<std::vector<Descriptor>> clusters(centres_.size());
    for (std::size_t i = 0; i < descriptors.size(); ++i)
      clusters[nearest_[i]].push_back(descriptors[i]);
    sizes_.clear();
    auto out = descriptors.begin();
    std::size_t kept = 0;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      if (clusters[c].empty()) continue;
      centres_[kept++] = centres_[c];
      sizes_.push_back(clusters[c].size());
      out = std::copy(clusters[c].begin(), clusters[c].end(), out);
    }
    centres_.resize(kept);
  }

  VocabularyTraining settings_;
  std::mt19937 generator_;
  std::vector<Descriptor> centres_;
  std::vector<std::size_t> sizes_;
  std::vector<std::uint32_t> nearest_;    // per descriptor: index of its centre
  std::vector<std::uint64_t> distance2_;  // per descriptor, to the nearest centre so far
};

/// Nodes in breadth-first order; `pending[i]` belongs to node i.
std::vector<Vocabulary::Node> growTree(std::vector<Descriptor>& descriptors,
                                       const VocabularyTraining& settings) {
  Clustering clustering(settings);
  std::vector<Vocabulary::Node> nodes(1);
  std::vector<Pending> pending{{0, descriptors.size(), 0}};
  std::uint32_t words = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Pending p = pending[i];
    const std::size_t size = p.end - p.begin;
    const bool divisible =
        p.level < settings.levels && size >= 2 * static_cast<std::size_t>(settings.branching);
    if (divisible) clustering.cluster(std::span(descriptors).subspan(p.begin, size));
    if (!divisible || clustering.sizes().size() < 2) {
      nodes[i].first = words++;
      continue;
    }
    nodes[i].first = static_cast<std::uint32_t>(nodes.size());
    nodes[i].children = static_cast<std::uint32_t>(clustering.sizes().size());
    std::size_t begin = p.begin;
    for (std::size_t c = 0; c < clustering.sizes().size(); ++c) {
      nodes.push_back({clustering.centres()[c], 0, 0, 0});
      pending.push_back({begin, begin + clustering.sizes()[c], p.level + 1});
      begin += clustering.sizes()[c];
    }
  }
  return nodes;
}

/// Inverse document frequency: ln(pictures / pictures that show the word).
void weighWords(std::vector<Vocabulary::Node>& nodes,
                std::span<const std::vector<Descriptor>> pictures) {
  const Vocabulary unweighted(nodes, "training");
  std::vector<int> shown(unweighted.words(), 0), last(unweighted.words(), -1);
  for (std::size_t p = 0; p < pictures.size(); ++p) {
    for (const Descriptor& d : pictures[p]) {
      const WordId word = unweighted.wordOf(d);
      shown[word] += last[word] != static_cast<int>(p);
      last[word] = static_cast<int>(p);
    }
  }
  for (Vocabulary::Node& node : nodes)
    if (node.children == 0)
      node.weight = static_cast<float>(
          std::log(static_cast<double>(pictures.size()) / std::max(1, shown[node.first])));
}

}  // namespace

Vocabulary trainVocabulary(std::span<const std::vector<Descriptor>> pictures,
                           const VocabularyTraining& settings) {
  std::vector<Descriptor> all;
  for (const auto& picture : pictures) all.insert(all.end(), picture.begin(), picture.end());
  if (all.empty()) throw InputError("training: no features were found, expected textured pictures");
  std::vector<Vocabulary::Node> nodes = growTree(all, settings);
  if (nodes.size() < 3)
    throw InputError("training: too few different features were found, expected textured pictures");
  weighWords(nodes, pictures);
  return Vocabulary(std::move(nodes), "training");
}

}  // namespace depthscope::slam
