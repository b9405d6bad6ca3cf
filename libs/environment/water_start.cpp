#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "environment/water_problem.h"

namespace fathom {
namespace {

/// E and b of one channel for a given a: weighted linear least squares, reweighted by Cauchy's loss.
struct LinearFit {
  double ambient = 0, veil = 0, cost = std::numeric_limits<double>::infinity();
};

LinearFit linearFit(const std::vector<Patch>& patches, int channel, double attenuation) {
  LinearFit fit;
  for (int round = 0; round < 6; ++round) {
    Eigen::Matrix2d information = 1e-9 * Eigen::Matrix2d::Identity();
    Vector2d score = Vector2d::Zero();
    double cost = 0;
    for (const Patch& patch : patches) {
      const double sigma = std::hypot(patch.sigma[channel], kFirstWaterExcess);
      if (!std::isfinite(sigma)) continue;
      const double passed = std::exp(-attenuation * patch.z_m);
      const Vector2d row = Vector2d(patch.albedo[channel] * passed, 1 - passed) / sigma;
      const double seen = patch.radiance[channel] / sigma;
      const double off =
          round == 0 ? 0 : (seen - row.dot(Vector2d(fit.ambient, fit.veil))) / kWaterLossSigmas;
      cost += std::log1p(off * off);
      information += row * row.transpose() / (1 + off * off);
      score += row * seen / (1 + off * off);
    }
    if (round > 0) fit.cost = cost;
    const Vector2d solution = information.ldlt().solve(score);
    fit.ambient = solution[0];
    fit.veil = solution[1];
  }
  return fit;
}

Vector9d parametersAtStart(const std::vector<Patch>& patches, const WaterFitOptions& options) {
  // A thousand patches tell enough.
  std::vector<Patch> some;
  const std::size_t step = std::max<std::size_t>(1, patches.size() / 1000);
  for (std::size_t i = 0; i < patches.size(); i += step) some.push_back(patches[i]);
  Vector9d start = waterParameters(options.start);
  for (int c = 0; c < 3; ++c) {
    double least = std::numeric_limits<double>::infinity();
    for (double a = 0.01; a < options.largest_attenuation_per_m; a *= 1.12) {
      const LinearFit fit = linearFit(some, c, a);
      if (!(fit.cost < least) || fit.ambient <= 0 || fit.veil < 0 || fit.veil > 1) continue;
      least = fit.cost;
      start[c] = a;
      start[3 + c] = fit.veil;
      start[6 + c] = fit.ambient;
    }
  }
  return start;
}

}  // namespace

WaterState waterStart(const std::vector<Patch>& patches, std::size_t images, const WaterFitOptions& options) {
  return {parametersAtStart(patches, options), std::vector<double>(images, 0.0)};
}

}  // namespace fathom
