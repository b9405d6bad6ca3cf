#pragma once

#include "core/random.h"
#include "dive.h"
#include "recording/samples.h"
#include "sealed_case.h"
#include "vehicle.h"

namespace fathom::sealed {

/// Hydrostatic pressure below the surface, which is odom's z = 0. What pressure does to density is 2e-5 at
/// these depths (UNESCO 1981) and left out.
class PressureSensor {
 public:
  PressureSensor(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive);

  DepthSample read(double t_s);

 private:
  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  const Dive& dive_;
  Random random_;
  double zero_error_pa_;
};

}  // namespace fathom::sealed
