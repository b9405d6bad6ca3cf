#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry.h"

namespace fathom {

/// A spot light: uniform inside its cone, falling with the square of the distance.
struct Spot {
  Pose T_odom_lamp;  ///< light leaves along x
  double half_angle_rad = 0;
  Eigen::Vector3f irradiance_1m{1.0f, 1.0f, 1.0f};  ///< on the axis at 1 m, in units of full ambient light
};

/// Light at the scene. A matt surface of albedo A has radiance A * (ambient + sum over spots of irradiance_1m
/// * cos(incidence) / distance²): a white of albedo 0.85 under ambient light 1 has 0.85, and 1 is the
/// camera's full scale. Nothing casts a shadow.
struct Lighting {
  Eigen::Vector3f ambient{1.0f, 1.0f, 1.0f};
  std::vector<Spot> spots;
};

}  // namespace fathom
