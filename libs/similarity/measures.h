#pragma once

#include <array>
#include <span>

#include "similarity/detection_agreement_measure.h"
#include "similarity/fsim_measures.h"
#include "similarity/rmse_linear_measure.h"
#include "similarity/ssim_measure.h"

/// To add a measure: write libs/similarity/NAME_measure.h (see measure.h), include it here and add it to
/// kMeasures. Whoever measures pairs, and the test over all measures, then know it.
namespace fathom {

/// A measure as a value.
struct RegisteredMeasure {
  std::string_view id, about;
  std::span<const Quantity> quantities;
  MeasureOutcome (*measure)(const PairView& pair);
};

template <class Measure>
constexpr RegisteredMeasure registered() {
  return {Measure::id, Measure::about, Measure::quantities, &Measure::measure};
}

/// The only registration.
inline constexpr std::array kMeasures{
    registered<FsimMeasure>(),
    registered<FsimcMeasure>(),
    registered<SsimMeasure>(),
    registered<RmseLinearMeasure>(),
    registered<DetectionAgreementMeasure>(),
};

/// What a measure gave for a pair.
struct Measurement {
  const RegisteredMeasure* measure;  ///< names, units and directions of the values are its quantities'
  MeasureOutcome outcome;
};

/// Why a pair's images cannot be compared at all, or an empty string: one is empty, of another type or size,
/// or saturated, that is all but 1 % of its pixels have every channel at an end of the scale (blinded by a
/// lamp, or dark).
std::string whyNotComparable(const ImagePair& pair);

/// Measures pair after pair. One object may be shared by threads; a pair's numbers do not depend on others.
class PairMeasurer {
 public:
  PairMeasurer();  ///< all measures
  /// Throws Error{"measures", id, …} for an unknown id or one that is there twice.
  explicit PairMeasurer(const std::vector<std::string>& ids);

  /// One measurement a measure, in order. A pair that cannot be measured is no error: its measurements say
  /// why, and the next one is as good as ever.
  std::vector<Measurement> measure(const ImagePair& pair) const;

 private:
  std::vector<const RegisteredMeasure*> measures_;
  FsimComparer comparer_;
};

}  // namespace fathom
