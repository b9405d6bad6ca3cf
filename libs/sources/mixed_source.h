#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "recording/sample_source.h"

namespace fathom {

/// Each sensor from one of several sources, merged in time order; samples of one source keep their order, of
/// equal stamps the main source's come first, then the others' in their order. All must tell the same
/// absolute time.
class MixedSource : public SampleSource {
 public:
  /// A source and the labels taken from it.
  struct Part {
    std::unique_ptr<SampleSource> source;
    std::vector<std::string> labels;
  };

  /// Every label not taken from one of the parts, header and image folder are the main source's. Names of the
  /// parts' images become absolute. A label in two parts: std::logic_error.
  MixedSource(std::unique_ptr<SampleSource> main, std::vector<Part> parts);

  const RecordingHeader& header() const override { return inputs_.front().source->header(); }
  std::optional<Sample> next() override;
  std::filesystem::path imageFolder() const override { return inputs_.front().source->imageFolder(); }
  double fraction() const override { return inputs_.front().source->fraction(); }
  /// The first source's that lost something, the main one first.
  std::optional<RecordingLoss> loss() const override;

 private:
  struct Input {
    std::unique_ptr<SampleSource> source;
    std::optional<Sample> next;
  };

  void advance(std::size_t input);

  std::vector<Input> inputs_;                     // the main source first
  std::map<std::string, std::size_t> input_for_;  // of labels that are not the main source's
};

}  // namespace fathom
