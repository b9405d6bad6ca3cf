#pragma once

#include <cstddef>
#include <utility>

namespace fathom {

/// The value that a chi-square variable stays below with the given probability (0 to 1).
double chiSquareQuantile(double degrees_of_freedom, double probability);

/// Natural logarithm of the probability that a chi-square variable exceeds `value`. Beyond where the
/// probability itself is no longer a double: the leading terms of its asymptotic expansion (DLMF 8.11.2).
double chiSquareLogTail(double degrees_of_freedom, double value);

/// The same where `value` is in units of a variance that was itself estimated, with so many degrees of
/// freedom (Fisher's F); infinite: known.
double chiSquareLogTail(double degrees_of_freedom, double value, double variance_freedom);

/// Central 95 % band of the mean of `count` independent chi-square variables.
std::pair<double, double> meanChiSquareBand(int degrees_of_freedom, std::size_t count);

}  // namespace fathom
