#include "environment/water_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/chi_square.h"
#include "environment/range_advice.h"
#include "environment/water_problem.h"

namespace fathom {
namespace {

constexpr double kMedianOfSquare = 0.4549;  // of a standard normal number
constexpr int kRobustRounds = 3, kInlierRounds = 2;
constexpr std::size_t kFewestPatches = 30;

/// The excess that makes the median of the squared residuals what it should be.
Vector3d excessOf(const PatchModel& model, const std::vector<Patch>& patches, const std::vector<bool>& counts,
                  const WaterState& state) {
  Vector3d excess;
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<double, double>> squares;  // residual, sigma
    for (std::size_t i = 0; i < patches.size(); ++i)
      if (counts[i] && std::isfinite(patches[i].sigma[c]))
        squares.emplace_back(std::pow(residualOf(model, patches[i], state)[c], 2),
                             std::pow(patches[i].sigma[c], 2));
    const auto tooSmall = [&](double variance) {
      const auto above = std::count_if(squares.begin(), squares.end(), [&](const auto& s) {
        return s.first > kMedianOfSquare * (s.second + variance);
      });
      return 2 * static_cast<std::size_t>(above) > squares.size();
    };
    double low = 0, high = 1;
    for (int halving = 0; halving < 40; ++halving)
      (tooSmall(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    excess[c] = std::sqrt(high);
  }
  return excess;
}

std::vector<bool> inliersOf(const PatchModel& model, const std::vector<Patch>& patches,
                            const WaterState& state, double probability) {
  const double largest = chiSquareQuantile(3, probability);
  std::vector<bool> inlier(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i)
    inlier[i] = residualOf(model, patches[i], state)
                    .cwiseQuotient(totalSigma(patches[i], state.excess))
                    .squaredNorm() <= largest;
  return inlier;
}

/// Robust rounds over all patches, then rounds over the inliers; whether all converged.
bool refine(const PatchModel& model, const std::vector<Patch>& patches, const WaterFitOptions& options,
            bool with_gain, WaterState& state, std::vector<bool>& inlier) {
  inlier.assign(patches.size(), true);
  for (int round = 0; round < kRobustRounds; ++round) {
    if (!WaterProblem(model, patches, inlier, options, true, with_gain, state).solve()) return false;
    state.excess = excessOf(model, patches, inlier, state);
  }
  for (int round = 0; round < kInlierRounds; ++round) {
    inlier = inliersOf(model, patches, state, options.inlier_probability);
    if (!WaterProblem(model, patches, inlier, options, false, with_gain, state).solve()) return false;
    state.excess = excessOf(model, patches, inlier, state);
  }
  return true;
}

double standardDeviation(const std::vector<double>& numbers) {
  const double squares = std::inner_product(numbers.begin(), numbers.end(), numbers.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(numbers.size()));
}

void describeResiduals(const PatchModel& model, const std::vector<Patch>& patches, const WaterState& state,
                       WaterFit& fit) {
  Vector3d squares = Vector3d::Zero(), counts = Vector3d::Zero();
  fit.nearest_z_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (!fit.inlier[i]) continue;
    const Patch& patch = patches[i];
    fit.nearest_z_m = std::min(fit.nearest_z_m, patch.z_m);
    fit.farthest_z_m = std::max(fit.farthest_z_m, patch.z_m);
    const Vector3d sigma = totalSigma(patch, state.excess), residual = residualOf(model, patch, state);
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(sigma[c])) squares[c] += std::pow(residual[c] / sigma[c], 2), counts[c] += 1;
  }
  fit.chi_square_per_dof = squares.cwiseQuotient((counts.array() - 3).max(1).matrix());
}

void describeCovariance(const PatchModel& model, const std::vector<Patch>& patches,
                        const WaterFitOptions& options, WaterState& state, WaterFit& fit) {
  Eigen::MatrixXd covariance;
  WaterProblem(model, patches, fit.inlier, options, false, fit.gain_fitted, state)
      .covariance(covariance, fit.sigma_growth);
  fit.covariance =
      fit.sigma_growth.asDiagonal() * covariance.topLeftCorner<9, 9>() * fit.sigma_growth.asDiagonal();
  if (!fit.gain_fitted) return;
  fit.log_gain = state.log_gain;
  for (Eigen::Index k = 9; k < covariance.rows(); ++k)
    fit.log_gain_sigma.push_back(std::sqrt(covariance(k, k)));
}

}  // namespace

Vector3d predictedRadiance(const Patch& patch, const Environment& environment, const KnownLight& known,
                           double log_gain) {
  return PatchModel(known).radiance<double>(patch, waterParameters(environment).data(), log_gain);
}

Vector3d residualSigmas(const Patch& patch, const WaterFit& fit) {
  const double log_gain = fit.gain_fitted ? fit.log_gain[patch.image] : 0;
  return (patch.radiance - predictedRadiance(patch, fit.environment, fit.known, log_gain))
      .cwiseQuotient(totalSigma(patch, fit.excess_sigma));
}

WaterFit fitWater(const std::vector<Patch>& patches, std::size_t images, const WaterFitOptions& options) {
  WaterFit fit;
  fit.images = images;
  fit.patches = patches.size();
  fit.known = options.known;
  if (patches.size() < kFewestPatches) {
    fit.why_not = "only " + std::to_string(patches.size()) + " patches";
    return fit;
  }
  const PatchModel model(options.known);
  WaterState state = waterStart(patches, images, options);
  fit.gain_fitted = options.gain != WaterFitOptions::Gain::fixed;
  fit.solved = refine(model, patches, options, fit.gain_fitted, state, fit.inlier);
  if (options.gain == WaterFitOptions::Gain::detected &&
      standardDeviation(state.log_gain) < options.detected_log_gain) {
    fit.gain_fitted = false;
    std::fill(state.log_gain.begin(), state.log_gain.end(), 0.0);
    fit.solved = refine(model, patches, options, false, state, fit.inlier);
  }
  fit.why_not = fit.solved ? "" : "the solver did not converge";
  if (!fit.solved) return fit;
  fit.outliers = static_cast<std::size_t>(std::count(fit.inlier.begin(), fit.inlier.end(), false));
  fit.environment = environmentOf(state.water);
  fit.excess_sigma = state.excess;
  describeResiduals(model, patches, state, fit);
  describeCovariance(model, patches, options, state, fit);
  fit.warnings = rangeWarnings(patches, fit);
  return fit;
}

std::optional<Environment> startWater(const SynchronizedImages& synchronized) {
  constexpr std::size_t kEnough = 2000;
  const std::size_t step = std::max<std::size_t>(1, synchronized.patches.size() / kEnough);
  std::vector<Patch> some;
  for (std::size_t i = 0; i < synchronized.patches.size(); i += step) some.push_back(synchronized.patches[i]);
  WaterFitOptions options;
  options.start.water = {Vector3d::Constant(0.1), Vector3d::Constant(0.1)};
  options.gain = WaterFitOptions::Gain::fixed;
  const WaterFit fit = fitWater(some, synchronized.images.size(), options);
  return fit.solved ? std::optional(fit.environment) : std::nullopt;
}

}  // namespace fathom
