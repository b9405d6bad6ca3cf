#pragma once

#include <span>

#include "core/geometry.h"

namespace fathom {

/// Where a DVL's beams look, in the order of their numbers (Janus configuration). Frame: the DVL's, x
/// forward, z up. The one place that knows it.
struct BeamGeometry {
  double angle_rad = 0;                    ///< from straight down
  std::span<const double> azimuths_rad{};  ///< about z, from x towards y; a view

  std::ptrdiff_t count() const { return std::ssize(azimuths_rad); }
  /// Beam k's axes as columns: the first along the beam, down and out.
  Matrix3d R_dvl_beam(std::ptrdiff_t k) const {
    return rotationFromYawPitchRoll(azimuths_rad[static_cast<std::size_t>(k)], radians(90) - angle_rad, 0);
  }
  Vector3d axis(std::ptrdiff_t k) const { return R_dvl_beam(k).col(0); }
  /// 3 x count(): makes a velocity of the speeds along the beams, by least squares, as a DVL does. Of three
  /// beams or more that look in different directions.
  Eigen::Matrix3Xd solution() const {
    Eigen::MatrixX3d along(count(), 3);
    for (std::ptrdiff_t k = 0; k < count(); ++k) along.row(k) = axis(k).transpose();
    return (along.transpose() * along).inverse() * along.transpose();
  }
};

}  // namespace fathom
