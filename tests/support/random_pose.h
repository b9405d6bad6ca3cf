#pragma once

#include "core/geometry.h"
#include "core/random.h"

namespace fathom::test {

/// Any attitude, metres from the origin.
inline Pose randomPose(Random& random) {
  return {expSO3<double>(2.0 * random.normal3()), 2.0 * random.normal3()};
}

}  // namespace fathom::test
