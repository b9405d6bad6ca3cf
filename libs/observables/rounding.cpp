#include "observables/rounding.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom {
namespace {

constexpr double kUniform = 0.2887;    // sigma of a number of which only the rounded one is known
constexpr double kSmooth = 0.7;        // from this scatter on rounding shifts means by less than 1e-4
constexpr double kLeastScatter = 0.1;  // less is like none
constexpr double kShapeDoubt = 0.1;    // of the shift: numbers scatter not quite normally
constexpr double kClearSigmas = 2;
constexpr int kHalvings = 16;

double normalBelow(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

struct Moments {
  double mean = 0, variance = 0;
};

/// Of x + s z, z normal, once rounded.
Moments rounded(double x, double s) {
  const int first = static_cast<int>(std::floor(x - 5 * s)), last = static_cast<int>(std::ceil(x + 5 * s));
  double below = 0, sum = 0, square = 0;
  for (int number = first; number <= last; ++number) {
    const double up_to = number == last ? 1 : normalBelow((number + 0.5 - x) / s);
    sum += (up_to - below) * (number - x);
    square += (up_to - below) * (number - x) * (number - x);
    below = up_to;
  }
  return {x + sum, square - sum * sum};
}

/// Where a function that grows is zero.
template <class Function>
double rootOf(const Function& f, double low, double high) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

double meanWith(double scatter, double mean) {
  return rootOf([&](double x) { return rounded(x, scatter).mean - mean; }, mean - 0.5, mean + 0.5);
}

double scatterOf(double mean, double variance) {
  return rootOf([&](double s) { return rounded(meanWith(s, mean), s).variance - variance; }, kLeastScatter,
                kSmooth);
}

/// Largest by which rounding shifts a mean: of one a quarter off a whole number.
double largestShift(double scatter) { return std::abs(rounded(0.25, scatter).mean - 0.25); }

/// Of a mean of which rounding leaves least: of a whole number. A sigma that depended on the mean would
/// prefer means that are off to one side.
double sigmaOf(double scatter, double count) {
  constexpr double kStep = 0.02;
  const double slope = rounded(kStep, scatter).mean / kStep;
  const double by_mean = std::sqrt(rounded(0, scatter).variance / count) / std::max(slope, 1e-9);
  const double other = scatter * (1 + 1 / std::sqrt(2 * count));
  const double by_scatter = largestShift(scatter) - largestShift(other);
  return std::min(std::hypot(by_mean, by_scatter, kShapeDoubt * largestShift(scatter)), kUniform);
}

}  // namespace

BeforeRounding beforeRounding(double mean, double variance, double count, double usual_scatter) {
  const double usual = std::max(usual_scatter, kLeastScatter);
  if (variance > kSmooth * kSmooth || usual >= kSmooth)
    return {mean, std::sqrt(std::max(variance, usual * usual) / count)};
  const double expected = rounded(meanWith(usual, mean), usual).variance;
  const double unsure = kClearSigmas * std::sqrt(2 / count) * std::max(variance, expected);
  const bool is_usual = std::abs(expected - variance) < unsure;
  const double scatter = is_usual ? usual : scatterOf(mean, variance);
  return {meanWith(scatter, mean), sigmaOf(scatter, count)};
}

}  // namespace fathom
