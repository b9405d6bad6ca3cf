#pragma once

#include <map>
#include <vector>

#include "localization/localizer.h"

/// How well a filter's noise explains a recording: by the innovations alone, without any truth.
namespace fathom {

/// A recording as a filter is fed with it.
struct TunedRecording {
  LocalizationSetup setup;
  std::vector<Sample> samples;
};

/// Which innovations count where: blocks in turn, one to fit by, one to judge by. None of the first seconds,
/// in which the filter settles.
struct Blocks {
  double block_s = 20.0, settling_s = 10.0;

  bool counts(double t_s) const { return t_s >= settling_s; }
  bool isJudged(double t_s) const { return static_cast<long>((t_s - settling_s) / block_s) % 2 == 1; }
};

/// Of a channel's innovations.
struct ChannelScore {
  int degrees_of_freedom = 0;
  std::size_t count = 0, gated = 0;
  double nis_sum = 0.0;

  double nisMean() const { return count == 0 ? 0.0 : nis_sum / static_cast<double>(count); }
};

/// Prediction-error decomposition of the likelihood (Schweppe 1965; Harvey 1989, sec. 3.4): the sum over
/// innovations of -(NIS + log det S + M log 2 pi) / 2. Beyond the gate NIS counts by its
/// root (Huber 1964): an outlier is not to set the noise.
struct InnovationScore {
  double log_likelihood = 0.0;
  std::map<Channel, ChannelScore> channels;

  void add(const Innovation& innovation, double gate);
};

struct Scores {
  InnovationScore fit, judged;
  std::map<Regime, double> regimes_s;  ///< time in each
};

/// The filter over the whole recording once.
Scores score(const TunedRecording& recording, const LocalizationOptions& options, const Blocks& blocks);

}  // namespace fathom
