#pragma once

#include "core/random.h"
#include "dive.h"
#include "recording/samples.h"
#include "sealed_case.h"
#include "vehicle.h"

namespace fathom::sealed {

/// A bias that wanders: first-order Gauss-Markov with its stationary sigma (e.g. Brown & Hwang 2012,
/// sec. 4.7).
class WanderingBias {
 public:
  WanderingBias(double sigma, double time_constant_s, Random& random)
      : sigma_(sigma), time_constant_s_(time_constant_s), value_(sigma * random.normal3()) {}

  const Vector3d& value() const { return value_; }
  void step(double seconds, Random& random);

 private:
  double sigma_, time_constant_s_;
  Vector3d value_;
};

/// A strapdown IMU: each sample is the mean over its interval, which lies around its time of validity.
class InertialUnit {
 public:
  InertialUnit(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive);

  /// To be called for one sample after the other.
  InsSample read(double t_s);

 private:
  struct Felt {
    Vector3d rate_ins, force_ins;
  };
  Felt feltAt(double t_s, double stamp_s) const;
  Felt meanAround(double t_s, double stamp_s) const;

  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  const Dive& dive_;
  Random random_;
  WanderingBias gyro_bias_, accelerometer_bias_;
};

}  // namespace fathom::sealed
