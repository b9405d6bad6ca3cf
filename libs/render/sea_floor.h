#pragma once

#include "core/random.h"
#include "panel/surface.h"

namespace fathom {

struct SeaFloor {
  Vector3d centre_odom = Vector3d::Zero();  ///< of the square, m; its z is the sea floor's
  double side_m = 20;
  Eigen::Vector3f mean_albedo{0.34f, 0.28f, 0.20f};  ///< wet sand
  double contrast = 0.25;                            ///< standard deviation of the albedo, relative
};

/// A level square of sand, so that pictures do not look flat: patches of 3 m down to 10 cm, brighter and
/// darker (value noise, each octave 0.7 of the one before), a little redder and greener, clipped to
/// [0.02, 0.9]. Its 2888 triangles are six times smaller in the middle than at the rim: put the centre below
/// what is looked at. The same random numbers give the same sand. Throws std::invalid_argument: a side that
/// is not positive.
Surface seaFloor(const SeaFloor& floor, Random random);

}  // namespace fathom
