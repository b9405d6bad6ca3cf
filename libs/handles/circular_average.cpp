#include "handles/circular_average.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace fathom {
namespace {

constexpr double kLeastOfOne_rad = 1e-4;

}  // namespace

void CircularAverage::add(double angle_rad, double sigma_rad) {
  readings_.push_back({angle_rad, std::pow(std::max(kLeastOfOne_rad, sigma_rad), -2)});
  if (readings_.size() > window_) readings_.pop_front();
}

double CircularAverage::mean_rad() const {
  const double times = 2 * std::numbers::pi / symmetry_rad_;
  std::complex<double> sum = 0;
  for (const Reading& r : readings_) sum += std::polar(r.weight, times * r.angle_rad);
  const double mean = std::arg(sum) / times;
  return mean < 0 ? mean + symmetry_rad_ : mean;
}

double CircularAverage::sigma_rad() const {
  const double mean = mean_rad();
  double weights = 0, squares = 0;
  for (const Reading& r : readings_) {
    weights += r.weight;
    squares += r.weight * std::pow(std::remainder(r.angle_rad - mean, symmetry_rad_), 2);
  }
  const double stated = 1 / weights;
  if (readings_.size() < 2) return std::sqrt(stated);
  const double shown = squares / weights / static_cast<double>(readings_.size() - 1);
  return std::sqrt(std::max(stated, shown));
}

double CircularAverage::agreement() const {
  const double times = 2 * std::numbers::pi / symmetry_rad_;
  std::complex<double> sum = 0;
  double weights = 0;
  for (const Reading& r : readings_) {
    sum += std::polar(r.weight, times * r.angle_rad);
    weights += r.weight;
  }
  return std::abs(sum) / weights;
}

}  // namespace fathom
