#pragma once

#include "effects/registry.h"
#include "sensors/vehicle.h"

/// The vehicle file states an exposure, and `motion-blur` another one that counts instead. Models add up, so
/// inside of a fit the effect's parameter is what its square is beyond the stated one's; calibrations,
/// simulations and reports have the whole.
namespace fathom {

/// 0 without a camera.
inline double statedExposure_s(const Vehicle& vehicle) {
  return vehicle.camera ? vehicle.camera->exposure_s : 0;
}

/// For how long the shutter is open in an image t_s after the recording's first entry, with effects as a fit
/// has them.
template <class T>
ExposureTime<T> exposureTime(const EffectParameters<T>& beyond, double t_s, double stated_s) {
  ExposureTime<T> exposure{T(stated_s * stated_s)};
  applyEffects(beyond, t_s, exposure);
  return exposure;
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
