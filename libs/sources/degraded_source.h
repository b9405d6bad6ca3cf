#pragma once

#include <memory>
#include <vector>

#include "recording/sample_source.h"
#include "sources/degradation.h"

namespace fathom {

/// Any source with faults on the way. Stages act one after the other; a sample that none concerns passes as
/// it is. Deterministic: a stage's draws depend on its seed, its place in the list and the sensor, not on
/// other sensors. MARKERS and PANEL of the same stamp get the same draws, so they share their fate whichever
/// of them is there.
///
/// Order of arrival: the stream's clock is the newest stamp so far; a sample arrives when it is read, plus
/// its delays, and comes out as soon as the clock has passed that; of equal arrivals, in the order of the
/// source. A step of the stamps of more than kLongestPause_s, up or down, does not move the clock: a broken
/// stamp must not set free, or hold for ever, what is delayed.
///
/// Memory: what is delayed, at most kMostHeld samples (the earliest comes out before its time, then).
class DegradedSource : public SampleSource {
 public:
  DegradedSource(std::unique_ptr<SampleSource> source, std::vector<DegradationStage> stages);
  ~DegradedSource() override;

  const RecordingHeader& header() const override { return source_->header(); }
  std::optional<Sample> next() override;
  std::filesystem::path imageFolder() const override { return source_->imageFolder(); }
  double fraction() const override { return source_->fraction(); }
  std::optional<RecordingLoss> loss() const override { return source_->loss(); }

  static constexpr double kLongestPause_s = 600.0;
  static constexpr std::size_t kMostHeld = 200'000;

 private:
  class RunningStage;
  struct Held {
    Arrival arrival;
    std::uint64_t number;
  };
  struct Later {
    bool operator()(const Held& a, const Held& b) const;
  };

  void admit(Sample sample);
  void advanceClock(Time stamp);

  std::unique_ptr<SampleSource> source_;
  std::vector<std::unique_ptr<RunningStage>> stages_;
  std::vector<Held> held_;  // a heap, earliest arrival first
  std::uint64_t admitted_ = 0;
  std::optional<Time> first_;
  Time newest_{};
  double clock_s_ = 0.0;
  bool ended_ = false;
};

}  // namespace fathom
