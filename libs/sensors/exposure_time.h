#pragma once

#include <algorithm>
#include <cmath>

#include "effects/registry.h"

/// The vehicle file states an exposure, and `motion-blur` another one that counts instead. Models add up, so
/// inside of a fit the effect's parameter is what its square is beyond the stated one's; calibrations,
/// simulations and reports have the whole.
namespace fathom {

/// For how long the shutter is open, in an image t_s after the recording's first entry, by a calibration that
/// has the whole.
inline double exposureOf(const EffectParameters<double>& whole, double t_s, double stated_s) {
  constexpr std::size_t kBlur = kEffectIndex<MotionBlur>;
  return whole.isActive(kBlur, t_s) ? std::sqrt(std::max(0.0, *whole.of<MotionBlur>())) : stated_s;
}

/// A calibration that has the whole, as a fit takes it.
inline EffectParameters<double> beyondStated(EffectParameters<double> whole, double stated_s) {
  if (whole.has<MotionBlur>()) *whole.of<MotionBlur>() -= stated_s * stated_s;
  return whole;
}

/// And back.
inline EffectParameters<double> wholeOf(EffectParameters<double> beyond, double stated_s) {
  if (beyond.has<MotionBlur>()) *beyond.of<MotionBlur>() += stated_s * stated_s;
  return beyond;
}

/// The same of one scalar.
inline double wholeOf(std::size_t scalar, double beyond, double stated_s) {
  return scalar == kEffectOffsets[kEffectIndex<MotionBlur>] ? beyond + stated_s * stated_s : beyond;
}

}  // namespace fathom
