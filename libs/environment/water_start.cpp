#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/linear_algebra.h"
#include "environment/water_problem.h"

namespace fathom {
namespace {

/// What a patch's channel says of ambient light and veil at some attenuation: its light is linear in both.
struct LinearReading {
  double seen, by_ambient, by_veil, sigma;
};

/// Of all patches whose channels count, by channel. Of lamps only what they shed on the scene counts.
using LinearReadings = std::array<std::vector<LinearReading>, 3>;

Vector9d waterOf(double attenuation, double veil, double ambient) {
  Vector9d water;
  water << Vector3d::Constant(attenuation), Vector3d::Constant(veil), Vector3d::Constant(ambient);
  return water;
}

/// The same attenuation in each channel.
LinearReadings readingsAt(const std::vector<Patch>& patches, const WaterFitOptions& options,
                          double attenuation) {
  const PatchModel model(options.known);
  KnownLight daylight = options.known;
  daylight.effects.on.reset(kEffectIndex<Lamp>);
  const PatchModel by_day(daylight);
  LinearReadings readings;
  for (const Patch& patch : patches) {
    const Vector3d seen = model.lightSeen(patch) - model.light(patch, waterOf(attenuation, 0, 0));
    const Vector3d by_ambient = by_day.light(patch, waterOf(attenuation, 0, 1));
    const Vector3d by_veil = by_day.light(patch, waterOf(attenuation, 1, 0));
    for (int c = 0; c < 3; ++c)
      if (const double sigma = std::hypot(patch.sigma[c], kFirstWaterExcess); std::isfinite(sigma))
        readings[static_cast<std::size_t>(c)].push_back({seen[c], by_ambient[c], by_veil[c], sigma});
  }
  return readings;
}

/// E and b of one channel: weighted linear least squares, reweighted by Cauchy's loss.
struct LinearFit {
  double ambient = 0, veil = 0, cost = std::numeric_limits<double>::infinity();
};

LinearFit linearFit(const std::vector<LinearReading>& readings) {
  LinearFit fit;
  for (int round = 0; round < 6; ++round) {
    Eigen::Matrix2d information = 1e-9 * Eigen::Matrix2d::Identity();
    Vector2d score = Vector2d::Zero();
    double cost = 0;
    for (const LinearReading& reading : readings) {
      const Vector2d row = Vector2d(reading.by_ambient, reading.by_veil) / reading.sigma;
      const double seen = reading.seen / reading.sigma;
      const double off =
          round == 0 ? 0 : (seen - row.dot(Vector2d(fit.ambient, fit.veil))) / kWaterLossSigmas;
      cost += std::log1p(off * off);
      information += row * row.transpose() / (1 + off * off);
      score += row * seen / (1 + off * off);
    }
    if (round > 0) fit.cost = cost;
    const Vector2d solution = solveSymmetric(information, score);
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
  Vector3d least = Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (double a = 0.01; a < options.largest_attenuation_per_m; a *= 1.12) {
    const LinearReadings readings = readingsAt(some, options, a);
    for (int c = 0; c < 3; ++c) {
      const LinearFit fit = linearFit(readings[static_cast<std::size_t>(c)]);
      if (!(fit.cost < least[c]) || fit.ambient <= 0 || fit.veil < 0 || fit.veil > 1) continue;
      least[c] = fit.cost;
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
