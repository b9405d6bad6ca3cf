#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <utility>

namespace fathom {

/// The value that a chi-square variable stays below with the given probability.
inline double chiSquareQuantile(double degrees_of_freedom, double probability) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

/// Central 95 % band of the mean of `count` independent chi-square variables.
inline std::pair<double, double> meanChiSquareBand(int degrees_of_freedom, std::size_t count) {
  const double n = static_cast<double>(count);
  return {chiSquareQuantile(n * degrees_of_freedom, 0.025) / n,
          chiSquareQuantile(n * degrees_of_freedom, 0.975) / n};
}

}  // namespace fathom
