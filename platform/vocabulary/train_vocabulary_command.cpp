#include "platform/vocabulary/train_vocabulary_command.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>

#include "platform/vocabulary/training_pictures.hpp"
#include "slam/vocabulary_trainer.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr const char* kHelp =
    R"(depthscope train-vocabulary - make the vocabulary by which places are recognised

USAGE
  depthscope train-vocabulary --input DIR... --out FILE [OPTIONS]

OPTIONS
  --input DIR...   sequence folders (video.* or frames/, camera.yaml), folders of pictures, or videos
  --out FILE       the vocabulary to write; use it as slam.vocabulary
  --every N        take every N-th picture of a clip (default 5)
  --branching N    2 to 64: children of a node of the tree (default 10)
  --levels N       1 to 8: of the tree; it has up to branching^levels words (default 4)
  --seed N         of the random numbers (default 1): the same input gives the same file

A vocabulary of more words than slam.capacity.vocabulary_words is refused: raise that too.
Show it what the scope will see: thousands of pictures of many patients make better words than many
pictures of one.
)";

int integer(Arguments& arguments, const char* option, int standard, int min, int max) {
  const auto text = arguments.value(option);
  if (!text) return standard;
  int value = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc{} || end != text->data() + text->size() || value < min || value > max)
    throw InputError(std::string(option) + " " + *text + ": expected an integer from " +
                     std::to_string(min) + " to " + std::to_string(max));
  return value;
}

/// `--input A B C` as well as `--input A --input B`.
std::vector<std::filesystem::path> takeInputs(Arguments& arguments) {
  std::vector<std::filesystem::path> inputs;
  for (const std::string& value : arguments.values("--input")) inputs.emplace_back(value);
  if (inputs.empty()) throw InputError("--input: is missing (see --help)");
  for (const std::string& word : arguments.positionals()) inputs.emplace_back(word);
  return inputs;
}

}  // namespace

int trainVocabularyCommand(Arguments arguments) {
  if (arguments.flag("--help")) return std::fputs(kHelp, stdout), 0;
  const std::string out = arguments.required("--out");
  slam::VocabularyTraining training;
  training.branching = integer(arguments, "--branching", training.branching, 2, 64);
  training.levels = integer(arguments, "--levels", training.levels, 1, 8);
  training.seed = static_cast<std::uint32_t>(integer(arguments, "--seed", 1, 0, 1 << 30));
  const int every = integer(arguments, "--every", 5, 1, 100000);
  const auto inputs = takeInputs(arguments);
  arguments.finish();

  std::vector<std::vector<slam::Descriptor>> pictures;
  for (const auto& input : inputs) {
    const std::size_t before = pictures.size();
    addTrainingPictures(input, every, pictures);
    std::printf("%s: %zu pictures\n", input.c_str(), pictures.size() - before);
  }
  const slam::Vocabulary vocabulary = slam::trainVocabulary(pictures, training);
  vocabulary.save(out);
  std::printf("wrote %s: %d words from %zu pictures, %ju bytes\n", out.c_str(), vocabulary.words(),
              pictures.size(), static_cast<std::uintmax_t>(std::filesystem::file_size(out)));
  return 0;
}

}  // namespace depthscope::platform
