#include "slam/descriptor_search.hpp"

#include <algorithm>
#include <array>
#include <bit>

#if DEPTHSCOPE_HAS_AVX2
#include <immintrin.h>
#endif

namespace depthscope::slam {
namespace {

// A candidate's distance and index in one number, so that the least is the nearest, and of those
// equally near the first.
constexpr int kIndexBits = 16;
constexpr std::int32_t kNobody = 257 << kIndexBits;

struct LeastTwo {
  std::int32_t least = kNobody, second = kNobody;

  void offer(std::int32_t key) {
    second = std::min(second, std::max(least, key));
    least = std::min(least, key);
  }
  DescriptorSearch::Nearest nearest() const {
    if (least == kNobody) return {};
    return {least & ((1 << kIndexBits) - 1), least >> kIndexBits, second >> kIndexBits};
  }
};

}  // namespace

DescriptorSearch::DescriptorSearch(int capacity) : blocks_((capacity + kLanes - 1) / kLanes) {}

void DescriptorSearch::assign(std::span<const Descriptor> descriptors) {
  size_ = static_cast<int>(std::min(descriptors.size(), blocks_.size() * kLanes));
  for (int i = 0; i < size_; ++i)
    for (int w = 0; w < 4; ++w) blocks_[i / kLanes].words[w][i % kLanes] = descriptors[i].bits[w];
}

DescriptorSearch::Nearest DescriptorSearch::nearest(const Descriptor& query, SimdPath path) const {
  return path == SimdPath::Avx2 ? nearestAvx2(query) : nearestPortable(query);
}

std::int32_t DescriptorSearch::key(const Descriptor& query, int i) const {
  int distance = 0;
  for (int w = 0; w < 4; ++w)
    distance += std::popcount(query.bits[w] ^ blocks_[i / kLanes].words[w][i % kLanes]);
  return distance << kIndexBits | i;
}

DescriptorSearch::Nearest DescriptorSearch::nearestPortable(const Descriptor& query) const {
  LeastTwo found;
  for (int i = 0; i < size_; ++i) found.offer(key(query, i));
  return found.nearest();
}

#if DEPTHSCOPE_HAS_AVX2
/// Bits are counted by a table of 16 entries, four bits at a time (Mula, Kurz and Lemire 2018).
DEPTHSCOPE_AVX2 DescriptorSearch::Nearest DescriptorSearch::nearestAvx2(
    const Descriptor& query) const {
  const __m256i bits_of = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                           0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low_half = _mm256_set1_epi8(0x0f);
  __m256i query_words[4];
  for (int w = 0; w < 4; ++w)
    query_words[w] = _mm256_set1_epi64x(static_cast<long long>(query.bits[w]));

  // In 64-bit lanes whose upper halves are zero.
  __m256i least = _mm256_set1_epi64x(kNobody), second = least;
  __m256i index = _mm256_setr_epi64x(0, 1, 2, 3);
  for (int b = 0; b < size_ / kLanes; ++b) {
    __m256i counts = _mm256_setzero_si256();  // of each byte, over the four words: at most 32
    for (int w = 0; w < 4; ++w) {
      const auto* words = reinterpret_cast<const __m256i*>(blocks_[b].words[w]);
      const __m256i differ = _mm256_xor_si256(query_words[w], _mm256_load_si256(words));
      const __m256i high = _mm256_and_si256(_mm256_srli_epi16(differ, 4), low_half);
      const __m256i low = _mm256_and_si256(differ, low_half);
      counts = _mm256_add_epi8(counts, _mm256_add_epi8(_mm256_shuffle_epi8(bits_of, high),
                                                       _mm256_shuffle_epi8(bits_of, low)));
    }
    const __m256i distances = _mm256_sad_epu8(counts, _mm256_setzero_si256());
    const __m256i keys = _mm256_or_si256(_mm256_slli_epi64(distances, kIndexBits), index);
    second = _mm256_min_epi32(second, _mm256_max_epi32(least, keys));
    least = _mm256_min_epi32(least, keys);
    index = _mm256_add_epi64(index, _mm256_set1_epi64x(kLanes));
  }

  LeastTwo found;
  std::array<std::int64_t, kLanes> lanes, seconds;
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(lanes.data()), least);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(seconds.data()), second);
  for (int lane = 0; lane < kLanes; ++lane) {
    found.offer(static_cast<std::int32_t>(lanes[lane]));
    found.offer(static_cast<std::int32_t>(seconds[lane]));
  }
  for (int i = size_ / kLanes * kLanes; i < size_; ++i) found.offer(key(query, i));
  return found.nearest();
}
#else
DescriptorSearch::Nearest DescriptorSearch::nearestAvx2(const Descriptor& query) const {
  return nearestPortable(query);
}
#endif

}  // namespace depthscope::slam
