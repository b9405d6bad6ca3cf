#pragma once

#include "core/geometry.h"

namespace fathom {

/// The rotation of a rotation vector in degrees, as calibration files have it.
template <class T>
Matrix3<T> rotationFromDegrees(const Vector3<T>& vector_deg) {
  return expSO3<T>(vector_deg * T(radians(1.0)));
}

}  // namespace fathom
