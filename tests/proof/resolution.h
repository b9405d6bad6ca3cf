#pragma once

#include <memory>
#include <vector>

#include "diagnosis/refit.h"
#include "estimation/batch_estimate.h"
#include "support/hidden_effect.h"

namespace fathom::proof {

using test::Hidden;

/// An effect that a hidden one may be taken for.
struct Rival {
  Candidate candidate;
  double alignment = 0;  ///< |c|: the cosine between what is hidden and the nearest that the rival can do
  /// How large the rival would have to be for that, in units of what an engineer expects: the largest of its
  /// parameters. 0 of what is drawn for each image.
  double prior_sigmas = 0;
};

/// What a dive lets its recording resolve, from a recording of it that hides nothing: by the program's
/// Jacobians there, in units of the noise that it shows, with the error budget as it is declared. Sizes are
/// sqrt(lambda) of that, as in discrepancy.md.
class Resolution {
 public:
  /// Throws Error where the nominal model cannot be fitted.
  explicit Resolution(const BatchInput& null);

  double sqrtLambda(const Hidden& hidden) const;
  /// All other effects that the dive can show: for good, of each marker, at tenths of the recording; where
  /// the hidden effect is on for a part of it, each for that part too.
  std::vector<Rival> rivalsOf(const Hidden& hidden) const;
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
  /// The vehicle file's.
  double exposure_s() const { return exposure_s_; }

 private:
  NoiseModel noise_;
  BatchOptions options_;
  std::shared_ptr<const WhitenedModel> model_;
  std::vector<Candidate> candidates_;  // all that the dive can show
  std::vector<int> marker_ids_;
  Interval span_;
  double exposure_s_ = 0;
};

}  // namespace fathom::proof
