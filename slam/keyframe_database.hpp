#pragma once
#include <memory>
#include <span>
#include <vector>

#include "slam/map.hpp"
#include "slam/vocabulary.hpp"

namespace depthscope::slam {

/// A keyframe that looks like a picture.
struct PlaceMatch {
  KeyframeId keyframe = kNone;
  float score = 0;  // similarity of the bags of words, 0..1
};

/// Scratch of fixed size for asking a KeyframeDatabase; one a thread.
struct PlaceQuery {
  explicit PlaceQuery(const SlamSettings& settings) {
    bag.reserve(settings.extractor.capacity());
    scores.resize(settings.capacity.keyframes);
    matches.reserve(settings.capacity.keyframes);
  }
  std::vector<WordWeight> bag;      // of the picture in question
  std::vector<float> scores;        // per keyframe
  std::vector<PlaceMatch> matches;  // the answer
};

/// Bags of words of the map's keyframes, and for every word the keyframes that show it (inverted
/// index). Lives in memory set aside at construction: one posting for every feature of every
/// keyframe. Written and read under the same rule as the Map. A keyframe that has left the map need
/// not be taken out: it is recognised by its serial and never reported.
class KeyframeDatabase {
 public:
  /// Throws InputError when the vocabulary has more words than the settings have room for.
  KeyframeDatabase(const SlamSettings& settings, Vocabulary vocabulary);

  /// Takes a keyframe of the map in; what was known of its slot's former owner is forgotten.
  void add(const Map& map, KeyframeId keyframe);
  /// Whether it has been taken in.
  bool contains(const Map& map, KeyframeId keyframe) const {
    return map.keyframe(keyframe).alive && serials_[keyframe] == map.keyframe(keyframe).serial;
  }

  /// Live keyframes that share words with a picture, the most similar first, the newer first of
  /// equals. The answer lives in `query` until the next call with it.
  std::span<const PlaceMatch> find(const Map& map, std::span<const Descriptor> picture,
                                   PlaceQuery& query) const;
  /// The same for a keyframe that was taken in; itself left out.
  std::span<const PlaceMatch> find(const Map& map, KeyframeId keyframe, PlaceQuery& query) const;
  /// Similarity of two keyframes that were taken in.
  double score(KeyframeId a, KeyframeId b, PlaceQuery& query) const;

  const Vocabulary& vocabulary() const { return vocabulary_; }
  std::size_t bytes() const;

 private:
  /// An entry of a keyframe's bag and at once a link in the list of its word.
  struct Posting {
    WordId word;
    float weight;
    std::int32_t previous, next;  // postings of the same word, kNone: no more
  };
  std::span<const Posting> postings(KeyframeId keyframe) const {
    return {postings_.get() + static_cast<std::size_t>(keyframe) * features_,
            static_cast<std::size_t>(sizes_[keyframe])};
  }
  void remove(KeyframeId keyframe);
  void copyBag(KeyframeId keyframe, std::vector<WordWeight>& bag) const;
  std::span<const PlaceMatch> answer(const Map& map, KeyframeId except, PlaceQuery& query) const;

  Vocabulary vocabulary_;
  int features_;  // postings set aside for a keyframe
  // Keyframe by keyframe, each ascending by word. Not written to before it is used, so that what no
  // keyframe needs takes no memory.
  std::unique_ptr<Posting[]> postings_;
  std::vector<std::int32_t> heads_;    // per word: its first posting
  std::vector<int> sizes_;             // per keyframe
  std::vector<std::int64_t> serials_;  // per keyframe, -1: none taken in
  std::vector<WordWeight> bag_;        // scratch of add()
};

}  // namespace depthscope::slam
