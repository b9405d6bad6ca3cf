#pragma once

#include <type_traits>

namespace fathom {

/// The plain number in a scalar: itself, or a ceres::Jet's value.
template <class T>
double valueOf(const T& scalar) {
  if constexpr (std::is_arithmetic_v<T>)
    return scalar;
  else
    return valueOf(scalar.a);
}

}  // namespace fathom
