#include "slam/keyframe_database.hpp"

#include <algorithm>
#include <string>

#include "types/error.hpp"

namespace depthscope::slam {

KeyframeDatabase::KeyframeDatabase(const SlamSettings& settings, Vocabulary vocabulary)
    : vocabulary_(std::move(vocabulary)), features_(settings.extractor.capacity()) {
  if (vocabulary_.words() > settings.capacity.vocabulary_words)
    throw InputError("slam.capacity.vocabulary_words: there is room for " +
                     std::to_string(settings.capacity.vocabulary_words) +
                     ", expected at least the vocabulary's " + std::to_string(vocabulary_.words()));
  const std::size_t keyframes = settings.capacity.keyframes;
  postings_ = std::make_unique_for_overwrite<Posting[]>(keyframes * features_);
  heads_.resize(vocabulary_.words(), kNone);
  sizes_.resize(keyframes, 0);
  serials_.resize(keyframes, -1);
  bag_.reserve(features_);
}

void KeyframeDatabase::remove(KeyframeId keyframe) {
  for (const Posting& p : postings(keyframe)) {
    if (p.previous == kNone)
      heads_[p.word] = p.next;
    else
      postings_[p.previous].next = p.next;
    if (p.next != kNone) postings_[p.next].previous = p.previous;
  }
  sizes_[keyframe] = 0;
  serials_[keyframe] = -1;
}

void KeyframeDatabase::add(const Map& map, KeyframeId keyframe) {
  remove(keyframe);
  vocabulary_.describe(map.keyframe(keyframe).features.descriptors, bag_);
  const std::int32_t begin = keyframe * features_;
  for (std::size_t i = 0; i < bag_.size(); ++i) {
    const std::int32_t index = begin + static_cast<std::int32_t>(i);
    std::int32_t& head = heads_[bag_[i].word];
    postings_[index] = {bag_[i].word, bag_[i].weight, kNone, head};
    if (head != kNone) postings_[head].previous = index;
    head = index;
  }
  sizes_[keyframe] = static_cast<int>(bag_.size());
  serials_[keyframe] = map.keyframe(keyframe).serial;
}

void KeyframeDatabase::copyBag(KeyframeId keyframe, std::vector<WordWeight>& bag) const {
  bag.clear();
  for (const Posting& p : postings(keyframe)) bag.push_back({p.word, p.weight});
}

std::span<const PlaceMatch> KeyframeDatabase::find(const Map& map,
                                                   std::span<const Descriptor> picture,
                                                   PlaceQuery& query) const {
  vocabulary_.describe(picture, query.bag);
  return answer(map, kNone, query);
}

std::span<const PlaceMatch> KeyframeDatabase::find(const Map& map, KeyframeId keyframe,
                                                   PlaceQuery& query) const {
  copyBag(keyframe, query.bag);
  return answer(map, keyframe, query);
}

std::span<const PlaceMatch> KeyframeDatabase::answer(const Map& map, KeyframeId except,
                                                     PlaceQuery& query) const {
  std::fill(query.scores.begin(), query.scores.end(), 0.f);
  for (const WordWeight& w : query.bag)
    for (std::int32_t i = heads_[w.word]; i != kNone; i = postings_[i].next)
      query.scores[i / features_] += std::min(w.weight, postings_[i].weight);
  query.matches.clear();
  for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k)
    if (k != except && query.scores[k] > 0 && contains(map, k))
      query.matches.push_back({k, query.scores[k]});
  std::sort(query.matches.begin(), query.matches.end(),
            [&](const PlaceMatch& a, const PlaceMatch& b) {
              return a.score != b.score
                         ? a.score > b.score
                         : map.keyframe(a.keyframe).serial > map.keyframe(b.keyframe).serial;
            });
  return query.matches;
}

double KeyframeDatabase::score(KeyframeId a, KeyframeId b, PlaceQuery& query) const {
  copyBag(a, query.bag);
  double common = 0;
  auto word = query.bag.begin();
  for (const Posting& p : postings(b)) {
    while (word != query.bag.end() && word->word < p.word) ++word;
    if (word == query.bag.end()) break;
    if (word->word == p.word) common += std::min(word->weight, p.weight);
  }
  return common;
}

std::size_t KeyframeDatabase::bytes() const {
  return vocabulary_.bytes() + sizes_.size() * features_ * sizeof(Posting) +
         heads_.capacity() * sizeof(std::int32_t) +
         serials_.capacity() * (sizeof(std::int64_t) + sizeof(int));
}

}  // namespace depthscope::slam
