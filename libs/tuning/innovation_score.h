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
  void add(double t_s, double nis);
  /// How much more a second's NIS varies than chance has it where noise and drive are constant: 1 then, with
  /// a standard deviation of sqrt(2 / seconds).
  double unevenness() const;

 private:
  long second_ = 0;                                                          ///< the one that is under way
  double of_second_ = 0.0, readings_ = 0.0;                                  ///< its NIS, its readings
  double square_ = 0.0, product_ = 0.0, readings_square_ = 0.0, all_ = 0.0;  ///< sums over those before
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
  /// Short: of white innovations the parts scatter independently of each other, and there are many of them.
  static constexpr double kPart_s = 0.1;

  InnovationScore fit, judged;
  std::vector<double> fit_parts;       ///< its log likelihood by time, in parts of kPart_s
  std::map<Regime, double> regimes_s;  ///< time in each
};

/// The filter over the whole recording once.
Scores score(const TunedRecording& recording, const LocalizationOptions& options, const Blocks& blocks);

}  // namespace fathom
