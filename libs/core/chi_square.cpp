#include "core/chi_square.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace fathom {
namespace {

constexpr double kLeastTail = 1e-280;

/// In double, not by way of long double: everything would be compiled for both.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

double chiSquareQuantile(double degrees_of_freedom, double probability) {
  return boost::math::quantile(boost::math::chi_squared_distribution<double, InDouble>(degrees_of_freedom),
                               probability);
}

double chiSquareLogTail(double degrees_of_freedom, double value) {
  if (!(value > 0)) return 0;
  const double a = 0.5 * degrees_of_freedom, x = 0.5 * value;
  const double tail = boost::math::gamma_q(a, x, InDouble());
  if (tail > kLeastTail) return std::log(tail);
  // Q(a, x) = x^(a-1) e^-x / Γ(a) · (1 + (a-1)/x + (a-1)(a-2)/x² + …)
  double term = 1, sum = 1;
  for (int k = 1; k <= 20 && std::abs(term) > 1e-12 * sum; ++k) sum += term *= (a - k) / x;
  return (a - 1) * std::log(x) - x - std::lgamma(a) + std::log(sum);
}

double chiSquareLogTail(double degrees_of_freedom, double value, double variance_freedom) {
  if (!std::isfinite(variance_freedom)) return chiSquareLogTail(degrees_of_freedom, value);
  if (!(value > 0)) return 0;
  const double a = 0.5 * variance_freedom, b = 0.5 * degrees_of_freedom;
  const double x = variance_freedom / (variance_freedom + value);
  const double tail = boost::math::ibeta(a, b, x, InDouble());
  if (tail > kLeastTail) return std::log(tail);
  // The leading term of I_x(a, b) (DLMF 8.17.7); x is tiny then.
  return a * std::log(x) - std::log(a) - std::lgamma(a) - std::lgamma(b) + std::lgamma(a + b);
}

std::pair<double, double> meanChiSquareBand(int degrees_of_freedom, std::size_t count) {
  const double n = static_cast<double>(count);
  return {chiSquareQuantile(n * degrees_of_freedom, 0.025) / n,
          chiSquareQuantile(n * degrees_of_freedom, 0.975) / n};
}

}  // namespace fathom
