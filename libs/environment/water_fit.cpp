#include "environment/water_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "core/chi_square.h"
#include "environment/range_advice.h"
#include "sensors/image_model.h"

namespace fathom {
namespace {

constexpr double kLossSigmas = 3;           // Cauchy's scale, of the norm of a patch's three residuals
constexpr double kFirstExcess = 0.002;      // half a digital number of eight bits
constexpr double kMedianOfSquare = 0.4549;  // of a standard normal number
constexpr double kMeanGainSigma = 1e-6;     // fixes the mean log gain to zero
constexpr int kRobustRounds = 3, kInlierRounds = 2;
// Digital numbers of eight bits within which patches may share an error: rounding's changes sign after half a
// number, JPEG's steps are one to two wide.
constexpr std::array<double, 2> kSharedNumbers{0.5, 2.0};
constexpr std::size_t kFewestGroups = 10;  // from which on errors that a group shares are told from others
constexpr std::size_t kFewestPatches = 30;

/// A state of the fit: parameters, and what patches vary by besides their own sigma.
struct State {
  Vector9d water;
  std::vector<double> log_gain;
  Vector3d excess = Vector3d::Constant(kFirstExcess);
};

Vector3d totalSigma(const Patch& patch, const Vector3d& excess) {
  return (patch.sigma.array().square() + excess.array().square()).sqrt();
}

template <class T>
Vector3<T> predict(const Patch& patch, const T* water, const T& log_gain) {
  static const EffectParameters<T> nominal{};
  using std::exp;
  WaterColumn<T> column;
  Vector3<T> scene;
  for (int c = 0; c < 3; ++c) {
    column.attenuation_per_m[c] = water[c];
    column.veil[c] = water[3 + c];
    scene[c] = patch.albedo[c] * water[6 + c];
  }
  return predictLight<T>(scene, T(patch.z_m), T(patch.range_m), column, nominal) * exp(log_gain);
}

/// (seen - predicted) / sigma of a patch's three channels.
struct PatchResidual {
  const Patch* patch;
  Vector3d weight;

  template <class T>
  bool operator()(const T* water, const T* log_gain, T* residual) const {
    const Vector3<T> predicted = predict<T>(*patch, water, *log_gain);
    for (int c = 0; c < 3; ++c) residual[c] = (patch->radiance[c] - predicted[c]) * weight[c];
    return true;
  }
};

/// Of a value to a number it is near, in sigmas.
struct Prior {
  double mean, sigma;
  template <class T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = (value[0] - mean) / sigma;
    return true;
  }
};

struct WaterPrior {
  Vector9d mean, sigma;
  template <class T>
  bool operator()(const T* water, T* residual) const {
    for (int i = 0; i < 9; ++i) residual[i] = (water[i] - mean[i]) / sigma[i];
    return true;
  }
};

/// The mean log gain is nothing that images tell: ambient light and veil would take it up.
class MeanGainIsZero : public ceres::CostFunction {
 public:
  explicit MeanGainIsZero(std::size_t images) : weight_(1 / (kMeanGainSigma * static_cast<double>(images))) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(images, 1);
  }
  bool Evaluate(double const* const* log_gain, double* residual, double** jacobians) const override {
    residual[0] = 0;
    for (std::size_t k = 0; k < parameter_block_sizes().size(); ++k) {
      residual[0] += weight_ * log_gain[k][0];
      if (jacobians != nullptr && jacobians[k] != nullptr) jacobians[k][0] = weight_;
    }
    return true;
  }

 private:
  double weight_;
};

/// Over the patches of a group: their number, residuals, and moves of a channel's three parameters by each.
struct GroupSums {
  double count = 0, residual = 0, residual_squares = 0;
  Vector3d moves = Vector3d::Zero(), move_squares = Vector3d::Zero();

  void add(double one_residual, const Vector3d& one_moves) {
    count += 1;
    residual += one_residual;
    residual_squares += one_residual * one_residual;
    moves += one_moves;
    move_squares += one_moves.cwiseAbs2();
  }
};

/// The least-squares problem over some patches at a state, which solving moves.
class Problem {
 public:
  Problem(const std::vector<Patch>& patches, const std::vector<bool>& counts, const WaterFitOptions& options,
          bool robust, bool with_gain, State& state)
      : state_(state), with_gain_(with_gain) {
    for (double& gain : state.log_gain) problem_.AddParameterBlock(&gain, 1);
    for (std::size_t i = 0; i < patches.size(); ++i)
      if (counts[i]) {
        add(patches[i], robust);
        chosen_.push_back(&patches[i]);
      }
    addPriors(options);
    for (int i = 0; i < 6; ++i) problem_.SetParameterLowerBound(state.water.data(), i, 0);
    for (int i = 6; i < 9; ++i) problem_.SetParameterLowerBound(state.water.data(), i, 1e-6);
    for (int i = 0; i < 3; ++i)
      problem_.SetParameterUpperBound(state.water.data(), i, options.largest_attenuation_per_m);
    for (int i = 3; i < 6; ++i) problem_.SetParameterUpperBound(state.water.data(), i, 1);
  }

  bool solve() {
    ceres::Solver::Options how;
    how.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    how.max_num_iterations = 60;
    how.function_tolerance = 1e-10;
    how.num_threads = 1;  // sums in one order
    how.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(how, &problem_, &summary);
    return summary.IsSolutionUsable();
  }

  /// Of the parameters, first the nine of the water; see fitWater() about the growth.
  void covariance(Eigen::MatrixXd& least_squares, Vector9d& growth) {
    const ceres::CRSMatrix jacobian = evaluate();
    const auto size = static_cast<Eigen::Index>(jacobian.num_cols);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
    for (int row = 0; row < jacobian.num_rows; ++row) {
      const Eigen::VectorXd gradient = rowOf(jacobian, row);
      information.selfadjointView<Eigen::Lower>().rankUpdate(gradient);
    }
    information = information.selfadjointView<Eigen::Lower>();
    least_squares = information.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
    growth = growthByGroups(jacobian, least_squares,
                            [&](const Patch& patch, int) { return static_cast<long>(patch.image); });
    for (const double numbers : kSharedNumbers)
      growth = growth.cwiseMax(growthByGroups(jacobian, least_squares, [&](const Patch& patch, int c) {
        // What it should read: what it did read would make groups of those that err alike.
        const double expected = predict<double>(patch, state_.water.data(), state_.log_gain[patch.image])[c];
        return std::lround(255 / numbers * expected + 0.5);
      }));
  }

 private:
  void add(const Patch& patch, bool robust) {
    const Vector3d weight = totalSigma(patch, state_.excess).cwiseInverse();
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PatchResidual, 3, 9, 1>(new PatchResidual{&patch, weight}),
        robust ? new ceres::CauchyLoss(kLossSigmas) : nullptr, state_.water.data(),
        &state_.log_gain[patch.image]);
  }

  void addPriors(const WaterFitOptions& options) {
    WaterPrior prior{waterParameters(options.start), {}};
    prior.sigma << Vector3d::Constant(options.attenuation_sigma_per_m),
        Vector3d::Constant(options.veil_sigma), Vector3d::Constant(options.ambient_sigma);
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<WaterPrior, 9, 9>(new WaterPrior(prior)),
                              nullptr, state_.water.data());
    std::vector<double*> gains;
    for (double& gain : state_.log_gain) {
      gains.push_back(&gain);
      if (with_gain_)
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Prior, 1, 1>(new Prior{0, options.log_gain_sigma}), nullptr,
            &gain);
      else
        problem_.SetParameterBlockConstant(&gain);
    }
    if (with_gain_) problem_.AddResidualBlock(new MeanGainIsZero(gains.size()), nullptr, gains);
  }

  ceres::CRSMatrix evaluate() {
    ceres::Problem::EvaluateOptions what;
    what.parameter_blocks.push_back(state_.water.data());
    if (with_gain_)
      for (double& gain : state_.log_gain) what.parameter_blocks.push_back(&gain);
    ceres::CRSMatrix jacobian;
    problem_.Evaluate(what, nullptr, &residuals_, nullptr, &jacobian);
    return jacobian;
  }

  static Eigen::VectorXd rowOf(const ceres::CRSMatrix& jacobian, int row) {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(jacobian.num_cols);
    const auto r = static_cast<std::size_t>(row);
    for (auto k = static_cast<std::size_t>(jacobian.rows[r]);
         k < static_cast<std::size_t>(jacobian.rows[r + 1]); ++k)
      gradient[jacobian.cols[k]] += jacobian.values[k];
    return gradient;
  }

  /// By how much sigmas grow where residuals of a channel's patches in one group are correlated, all pairs
  /// alike: the correlation is the mean over all pairs of all groups.
  template <class GroupOf>
  Vector9d growthByGroups(const ceres::CRSMatrix& jacobian, const Eigen::MatrixXd& least_squares,
                          const GroupOf& groupOf) const {
    Vector9d growth = Vector9d::Ones();
    for (int c = 0; c < 3; ++c) {
      const std::array<Eigen::Index, 3> own{c, 3 + c, 6 + c};  // parameters
      std::map<long, GroupSums> groups;
      GroupSums all;
      for (std::size_t i = 0; i < chosen_.size(); ++i) {
        if (!std::isfinite(chosen_[i]->sigma[c])) continue;
        const int row = static_cast<int>(3 * i) + c;
        const Eigen::VectorXd gradient = rowOf(jacobian, row);
        Vector3d moves;
        for (int k = 0; k < 3; ++k)
          moves[k] = least_squares.row(own[static_cast<std::size_t>(k)]).dot(gradient);
        const double residual = residuals_[static_cast<std::size_t>(row)];
        groups[groupOf(*chosen_[i], c)].add(residual, moves);
        all.add(residual, moves);
      }
      if (groups.size() < kFewestGroups) continue;
      double pairs = 0, products = 0;
      Vector3d extra = Vector3d::Zero();
      for (const auto& [number, group] : groups) {
        pairs += group.count * group.count - group.count;
        products += group.residual * group.residual - group.residual_squares;
        extra += group.moves.cwiseAbs2() - group.move_squares;
      }
      const double correlation =
          std::max(0.0, products / std::max(1.0, pairs) / (all.residual_squares / all.count));
      for (int k = 0; k < 3; ++k)
        growth[own[static_cast<std::size_t>(k)]] =
            std::sqrt(std::max(1.0, 1 + correlation * extra[k] / all.move_squares[k]));
    }
    return growth;
  }

  State& state_;
  bool with_gain_;
  ceres::Problem problem_;
  std::vector<const Patch*> chosen_;  // that count
  std::vector<double> residuals_;
};

// ---- the start

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
      const double sigma = std::hypot(patch.sigma[channel], kFirstExcess);
      if (!std::isfinite(sigma)) continue;
      const double passed = std::exp(-attenuation * patch.z_m);
      const Vector2d row = Vector2d(patch.albedo[channel] * passed, 1 - passed) / sigma;
      const double seen = patch.radiance[channel] / sigma;
      const double off = round == 0 ? 0 : (seen - row.dot(Vector2d(fit.ambient, fit.veil))) / kLossSigmas;
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

Vector9d startOf(const std::vector<Patch>& patches, const WaterFitOptions& options) {
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

// ---- residuals

Vector3d residualsOf(const Patch& patch, const State& state) {
  const Vector3d predicted = predict<double>(patch, state.water.data(), state.log_gain[patch.image]);
  return patch.radiance - predicted;
}

/// The excess that makes the median of the squared residuals what it should be.
Vector3d excessOf(const std::vector<Patch>& patches, const std::vector<bool>& counts, const State& state) {
  Vector3d excess;
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<double, double>> squares;  // residual, sigma
    for (std::size_t i = 0; i < patches.size(); ++i)
      if (counts[i] && std::isfinite(patches[i].sigma[c]))
        squares.emplace_back(std::pow(residualsOf(patches[i], state)[c], 2),
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

std::vector<bool> inliersOf(const std::vector<Patch>& patches, const State& state, double probability) {
  const double largest = chiSquareQuantile(3, probability);
  std::vector<bool> inlier(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i)
    inlier[i] =
        residualsOf(patches[i], state).cwiseQuotient(totalSigma(patches[i], state.excess)).squaredNorm() <=
        largest;
  return inlier;
}

// ---- the fit

/// Robust rounds over all patches, then rounds over the inliers; whether all converged.
bool refine(const std::vector<Patch>& patches, const WaterFitOptions& options, bool with_gain, State& state,
            std::vector<bool>& inlier) {
  inlier.assign(patches.size(), true);
  for (int round = 0; round < kRobustRounds; ++round) {
    if (!Problem(patches, inlier, options, true, with_gain, state).solve()) return false;
    state.excess = excessOf(patches, inlier, state);
  }
  for (int round = 0; round < kInlierRounds; ++round) {
    inlier = inliersOf(patches, state, options.inlier_probability);
    if (!Problem(patches, inlier, options, false, with_gain, state).solve()) return false;
    state.excess = excessOf(patches, inlier, state);
  }
  return true;
}

double spread(const std::vector<double>& numbers) {
  const double squares = std::inner_product(numbers.begin(), numbers.end(), numbers.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(numbers.size()));
}

void describeResiduals(const std::vector<Patch>& patches, const State& state, WaterFit& fit) {
  Vector3d squares = Vector3d::Zero(), counts = Vector3d::Zero();
  fit.nearest_z_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (!fit.inlier[i]) continue;
    const Patch& patch = patches[i];
    fit.nearest_z_m = std::min(fit.nearest_z_m, patch.z_m);
    fit.farthest_z_m = std::max(fit.farthest_z_m, patch.z_m);
    const Vector3d sigma = totalSigma(patch, state.excess), residual = residualsOf(patch, state);
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(sigma[c])) squares[c] += std::pow(residual[c] / sigma[c], 2), counts[c] += 1;
  }
  fit.chi_square_per_dof = squares.cwiseQuotient((counts.array() - 3).max(1).matrix());
}

void describeCovariance(const std::vector<Patch>& patches, const WaterFitOptions& options, State& state,
                        WaterFit& fit) {
  Eigen::MatrixXd covariance;
  Problem(patches, fit.inlier, options, false, fit.gain_fitted, state)
      .covariance(covariance, fit.sigma_growth);
  fit.covariance =
      fit.sigma_growth.asDiagonal() * covariance.topLeftCorner<9, 9>() * fit.sigma_growth.asDiagonal();
  if (!fit.gain_fitted) return;
  fit.log_gain = state.log_gain;
  for (Eigen::Index k = 9; k < covariance.rows(); ++k)
    fit.log_gain_sigma.push_back(std::sqrt(covariance(k, k)));
}

}  // namespace

Vector9d waterParameters(const Environment& environment) {
  Vector9d parameters;
  parameters << environment.water.attenuation_per_m, environment.water.veil, environment.ambient;
  return parameters;
}

Environment environmentOf(const Vector9d& parameters) {
  return {{parameters.head<3>(), parameters.segment<3>(3)}, parameters.tail<3>(), {}};
}

Vector3d predictedRadiance(const Patch& patch, const Environment& environment, double log_gain) {
  return predict<double>(patch, waterParameters(environment).data(), log_gain);
}

Vector3d residualSigmas(const Patch& patch, const WaterFit& fit) {
  const double log_gain = fit.gain_fitted ? fit.log_gain[patch.image] : 0;
  return (patch.radiance - predictedRadiance(patch, fit.environment, log_gain))
      .cwiseQuotient(totalSigma(patch, fit.excess_sigma));
}

WaterFit fitWater(const std::vector<Patch>& patches, std::size_t images, const WaterFitOptions& options) {
  WaterFit fit;
  fit.images = images;
  fit.patches = patches.size();
  if (patches.size() < kFewestPatches) {
    fit.why_not = "only " + std::to_string(patches.size()) + " patches";
    return fit;
  }
  State state{startOf(patches, options), std::vector<double>(images, 0.0)};
  fit.gain_fitted = options.gain != WaterFitOptions::Gain::fixed;
  fit.solved = refine(patches, options, fit.gain_fitted, state, fit.inlier);
  if (options.gain == WaterFitOptions::Gain::detected && spread(state.log_gain) < options.detected_log_gain) {
    fit.gain_fitted = false;
    std::fill(state.log_gain.begin(), state.log_gain.end(), 0.0);
    fit.solved = refine(patches, options, false, state, fit.inlier);
  }
  fit.why_not = fit.solved ? "" : "the solver did not converge";
  if (!fit.solved) return fit;
  fit.outliers = static_cast<std::size_t>(std::count(fit.inlier.begin(), fit.inlier.end(), false));
  fit.environment = environmentOf(state.water);
  fit.excess_sigma = state.excess;
  describeResiduals(patches, state, fit);
  describeCovariance(patches, options, state, fit);
  fit.warnings = rangeWarnings(patches, fit);
  return fit;
}

}  // namespace fathom
