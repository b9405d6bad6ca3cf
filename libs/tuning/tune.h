#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tuning/innovation_score.h"

namespace fathom {

/// A size of the noise, before and after, with its 95 % interval.
struct TunedParameter {
  std::string name, unit;
  double before = 0.0, after = 0.0, low = 0.0, high = 0.0;
  bool is_told = true;  ///< false: the recordings hardly tell it, the interval is mostly the prior's
  /// False: the innovations that show it scatter unevenly. It changes in time, or the motion is not driven by
  /// white noise; then what was found is what suits the filter, not what the sensor has, and the interval is
  /// too narrow.
  bool is_constant = true;
};

struct Tuning {
  LocalizationOptions before, after;  ///< all written out
  std::vector<TunedParameter> parameters;
  std::vector<Scores> scores_before, scores_after;  ///< of each recording
  int runs = 0;                                     ///< of the filter over all recordings

  /// On the stretches that were not fitted: how much likelier, log likelihood an innovation.
  std::optional<double> judgedGain() const;
};

struct TuneOptions {
  Blocks blocks;
  int most_iterations = 40;
};

/// Maximum likelihood of the innovations on the stretches to fit by, over the logarithms of all sizes
/// (scoring and BFGS, gradients by central differences), begun at the likeliest of decades, one size after
/// the other. Each logarithm has a prior of one decade, so that what no recording tells stays where it was.
/// Intervals are by the curvature at the maximum; a dive of 150 s, half of which is fitted, tells the noise
/// of five readings a second to 7 %. All recordings are of one vehicle. Throws Error where there is none with
/// enough readings; Interrupted.
Tuning tune(const std::vector<TunedRecording>& recordings, const LocalizationOptions& options,
            const TuneOptions& how, const std::function<void(double fraction)>& progress);

/// The same noise as parameters for robot_localization's ekf_localization_node: YAML.
std::string robotLocalizationYaml(const Tuning& tuning, const Vehicle& vehicle);

}  // namespace fathom
