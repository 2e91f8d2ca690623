#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "slam/vocabulary.hpp"

namespace depthscope::slam {

struct VocabularyTraining {
  int branching = 10;      // children of a node, at most
  int levels = 4;          // below the root: up to branching^levels words
  int iterations = 12;     // of clustering at each node, at most
  std::uint32_t seed = 1;  // of the first centres
};

/// Clusters the descriptors of many pictures into a vocabulary: at every node k-majority under the
/// Hamming distance from centres spread by k-means++ (Galvez-Lopez and Tardos 2012, section III;
/// Arthur and Vassilvitskii 2007). A word weighs the log of how few of the pictures show it. The
/// same pictures and settings give the same vocabulary. Throws InputError when there are too few
/// descriptors for two words.
Vocabulary trainVocabulary(std::span<const std::vector<Descriptor>> pictures,
                           const VocabularyTraining& settings);

}  // namespace depthscope::slam
