#include "sources/mixed_source.h"

#include <stdexcept>
#include <utility>

namespace fathom {
namespace {

void makeImagesAbsolute(Sample& sample, const std::filesystem::path& folder) {
  const auto make = [&](std::string& file) { file = std::filesystem::absolute(folder / file).string(); };
  if (auto* image = std::get_if<ImageSample>(&sample.reading)) make(image->file);
  if (auto* stereo = std::get_if<StereoSample>(&sample.reading)) {
    make(stereo->left_file);
    make(stereo->right_file);
  }
}

}  // namespace

MixedSource::MixedSource(std::unique_ptr<SampleSource> main, std::vector<Part> parts) {
  inputs_.push_back({std::move(main), {}});
  for (Part& part : parts) {
    for (const std::string& label : part.labels)
      if (!input_for_.emplace(label, inputs_.size()).second)
        throw std::logic_error(label + " is taken from two sources");
    inputs_.push_back({std::move(part.source), {}});
  }
  for (std::size_t i = 0; i < inputs_.size(); ++i) advance(i);
}

std::optional<Sample> MixedSource::next() {
  std::optional<std::size_t> earliest;
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (inputs_[i].next && (!earliest || inputs_[i].next->time < inputs_[*earliest].next->time)) earliest = i;
  if (!earliest) return std::nullopt;
  auto sample = std::exchange(inputs_[*earliest].next, std::nullopt);
  advance(*earliest);
  return sample;
}

/// Finds the input's next sample that is wanted from it.
void MixedSource::advance(std::size_t input) {
  Input& from = inputs_[input];
  while ((from.next = from.source->next())) {
    const auto it = input_for_.find(from.next->label);
    if ((it == input_for_.end() ? 0 : it->second) != input) continue;
    if (input > 0) makeImagesAbsolute(*from.next, from.source->imageFolder());
    return;
  }
}

std::optional<RecordingLoss> MixedSource::loss() const {
  for (const Input& input : inputs_)
    if (auto loss = input.source->loss()) return loss;
  return std::nullopt;
}

}  // namespace fathom
