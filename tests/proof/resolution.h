#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "diagnosis/refit.h"
#include "estimation/batch_estimate.h"

namespace fathom::proof {

/// An effect of a size, as the program has it.
struct Hidden {
  Candidate candidate;
  EffectParameters<double> effects;  ///< the candidate's on, at its values
};

/// By the names that `fathom effects` documents; "marker_id", "time_s" among them.
nlohmann::json parametersOf(const Hidden& hidden);
/// The same effect, so many times as large.
Hidden scaled(const Hidden& hidden, double factor);
/// Whether no parameter is larger than anybody would hide.
bool isWithinLimits(const Hidden& hidden);

/// What a dive lets its recording resolve, from a recording of it that hides nothing: by the program's
/// Jacobians there, in units of the noise that it shows. Sizes are sqrt(lambda) of that, as in
/// discrepancy.md.
class Resolution {
 public:
  /// Throws Error where the nominal model cannot be fitted.
  explicit Resolution(const BatchInput& null);

  double sqrtLambda(const Hidden& hidden) const;
  /// All effects that the dive can show: for good, of each marker, at tenths of the recording.
  const std::vector<Candidate>& rivals() const { return rivals_; }
  /// |c| of each rival: the cosine between what the effect does and the nearest that the rival can, at
  /// most 1.
  std::vector<double> alignments(const Hidden& hidden) const;
  bool canShow(std::size_t effect) const;

  /// What a recording of the same dive without noise shows besides the nominal model, and of it what no
  /// single effect of the catalogue imitates, to first order: lambda, lambda (1 - c^2).
  struct Shown {
    double lambda = 0, left = 0;
  };
  Shown shownBy(const BatchInput& without_noise) const;

  const NoiseModel& noise() const { return noise_; }
  const std::vector<int>& markerIds() const { return marker_ids_; }
  Interval span() const { return span_; }

 private:
  NoiseModel noise_;
  BatchOptions options_;
  std::shared_ptr<const WhitenedModel> model_;
  std::vector<Candidate> rivals_;
  std::vector<int> marker_ids_;
  Interval span_;
};

}  // namespace fathom::proof
