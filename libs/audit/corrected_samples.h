#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "audit/correction.h"
#include "recording/sample_source.h"

namespace fathom {

/// Samples as they come, corrected, and handed on in the order of their corrected stamps. Held are
/// those that one yet to come may precede: as long as the clocks are corrected by.
class CorrectedSamples {
 public:
  CorrectedSamples(std::vector<Correction> corrections, Vehicle vehicle, std::function<void(Sample)> sink);

  void push(Sample sample);
  /// Hands on all that are held.
  void flush();

 private:
  void release();

  const std::vector<Correction> corrections_;
  const Vehicle vehicle_;
  const std::function<void(Sample)> sink_;
  double slowest_ = 1, earlier_s_ = 0;
  std::optional<Time> time_zero_;
  std::multimap<Time, Sample> held_;
};

/// The same of a source that is asked.
class CorrectedSource : public SampleSource {
 public:
  CorrectedSource(std::unique_ptr<SampleSource> source, std::vector<Correction> corrections, Vehicle vehicle)
      : source_(std::move(source)),
        corrected_(std::move(corrections), std::move(vehicle),
                   [this](Sample sample) { ready_.push_back(std::move(sample)); }) {}

  const RecordingHeader& header() const override { return source_->header(); }
  std::optional<Sample> next() override;
  std::filesystem::path imageFolder() const override { return source_->imageFolder(); }
  double fraction() const override { return source_->fraction(); }
  std::optional<RecordingLoss> loss() const override { return source_->loss(); }

 private:
  std::unique_ptr<SampleSource> source_;
  CorrectedSamples corrected_;
  std::deque<Sample> ready_;
};

}  // namespace fathom
