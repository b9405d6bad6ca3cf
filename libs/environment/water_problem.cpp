#include "environment/water_problem.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/linear_algebra.h"
#include "effects/drawn.h"

namespace fathom {
namespace {

constexpr double kMeanGainSigma = 1e-6;  // fixes the mean log gain to zero
// Digital numbers of eight bits within which patches may share an error: rounding's changes sign after half a
// number, JPEG's steps are one to two wide.
constexpr std::array<double, 2> kSharedNumbers{0.5, 2.0};
constexpr std::size_t kFewestGroups = 10;  // from which on errors that a group shares are told from others

/// (seen - predicted) / sigma of a patch's three channels.
struct PatchResidual {
  const PatchModel* model;
  const Patch* patch;
  Vector3d weight;

  template <class T>
  bool operator()(const T* water, const T* log_gain, T* residual) const {
    const Vector3<T> predicted = model->radiance<T>(*patch, water, *log_gain);
    for (int c = 0; c < 3; ++c) residual[c] = (patch->radiance[c] - predicted[c]) * weight[c];
    return true;
  }
};

/// Of a value to a number it is near, in sigmas.
struct GainPrior {
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

Eigen::VectorXd rowOf(const ceres::CRSMatrix& jacobian, int row) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(jacobian.num_cols);
  const auto r = static_cast<std::size_t>(row);
  for (auto k = static_cast<std::size_t>(jacobian.rows[r]);
       k < static_cast<std::size_t>(jacobian.rows[r + 1]); ++k)
    gradient[jacobian.cols[k]] += jacobian.values[k];
  return gradient;
}

EffectParameters<PatchModel::Jet> asJets(const EffectParameters<double>& effects) {
  EffectParameters<PatchModel::Jet> jets;
  for (std::size_t i = 0; i < effects.values.size(); ++i) jets.values[i] = PatchModel::Jet(effects.values[i]);
  jets.on = effects.on;
  jets.active_s = effects.active_s;
  jets.only = effects.only;
  return jets;
}

}  // namespace

PatchModel::PatchModel(const KnownLight& known)
    : effects_(withoutDraws(known.effects)),
      jet_effects_(asJets(effects_)),
      lamps_(known.lamps),
      changes_response_(anyActsAt<PixelResponse<double>>(effects_) ||
                        anyActsAt<ResponseCurve<double>>(effects_) ||
                        anyActsAt<StrayLight<double>>(effects_)) {}

Vector3d PatchModel::lightSeen(const Patch& patch) const {
  if (!changes_response_) return patch.radiance;
  PixelResponse<double> response{patch.image_radius, patch.image_tangent};
  ResponseCurve<double> curve{patch.response_gamma};
  applyEffects(effects_, patch.t_s, response);
  applyEffects(effects_, patch.t_s, curve);
  StrayLight<double> stray;
  applyEffects(effects_, patch.t_s, stray);
  Vector3d light;
  for (int c = 0; c < 3; ++c) {
    const double reading = predictReading<double>(patch.radiance[c], {}, {patch.response_gamma}, c);
    light[c] =
        (radianceBehind(reading, response, curve, c) - stray.share * patch.image_mean[c]) / (1 - stray.share);
  }
  return light;
}

Vector3d totalSigma(const Patch& patch, const Vector3d& excess) {
  return (patch.sigma.array().square() + excess.array().square()).sqrt();
}

Vector3d residualOf(const PatchModel& model, const Patch& patch, const WaterState& state) {
  return patch.radiance - model.radiance<double>(patch, state.water.data(), state.log_gain[patch.image]);
}

WaterProblem::WaterProblem(const PatchModel& model, const std::vector<Patch>& patches,
                           const std::vector<bool>& counts, const WaterFitOptions& options, bool robust,
                           bool with_gain, WaterState& state)
    : model_(model), state_(state), with_gain_(with_gain) {
  for (double& gain : state.log_gain) problem_.AddParameterBlock(&gain, 1);
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (counts[i]) {
      add(patches[i], robust);
      chosen_.push_back(&patches[i]);
    }
  addPriors(options);
  addBounds(options);
}

void WaterProblem::add(const Patch& patch, bool robust) {
  const Vector3d weight = totalSigma(patch, state_.excess).cwiseInverse();
  problem_.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PatchResidual, 3, 9, 1>(new PatchResidual{&model_, &patch, weight}),
      robust ? new ceres::CauchyLoss(kWaterLossSigmas) : nullptr, state_.water.data(),
      &state_.log_gain[patch.image]);
}

void WaterProblem::addPriors(const WaterFitOptions& options) {
  problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<WaterPrior, 9, 9>(
                                new WaterPrior{waterParameters(options.start), wideWaterSigma()}),
                            nullptr, state_.water.data());
  std::vector<double*> gains;
  for (double& gain : state_.log_gain) {
    gains.push_back(&gain);
    if (with_gain_)
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<GainPrior, 1, 1>(new GainPrior{0, options.log_gain_sigma}), nullptr,
          &gain);
    else
      problem_.SetParameterBlockConstant(&gain);
  }
  if (with_gain_) problem_.AddResidualBlock(new MeanGainIsZero(gains.size()), nullptr, gains);
}

void WaterProblem::addBounds(const WaterFitOptions& options) {
  for (int i = 0; i < 6; ++i) problem_.SetParameterLowerBound(state_.water.data(), i, 0);
  for (int i = 6; i < 9; ++i) problem_.SetParameterLowerBound(state_.water.data(), i, 1e-6);
  for (int i = 0; i < 3; ++i)
    problem_.SetParameterUpperBound(state_.water.data(), i, options.largest_attenuation_per_m);
  for (int i = 3; i < 6; ++i) problem_.SetParameterUpperBound(state_.water.data(), i, 1);
}

bool WaterProblem::solve() {
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

ceres::CRSMatrix WaterProblem::evaluate() {
  ceres::Problem::EvaluateOptions what;
  what.parameter_blocks.push_back(state_.water.data());
  if (with_gain_)
    for (double& gain : state_.log_gain) what.parameter_blocks.push_back(&gain);
  ceres::CRSMatrix jacobian;
  problem_.Evaluate(what, nullptr, &residuals_, nullptr, &jacobian);
  return jacobian;
}

template <class GroupOf>
Vector9d WaterProblem::growthByGroups(const ceres::CRSMatrix& jacobian, const Eigen::MatrixXd& least_squares,
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

void WaterProblem::covariance(Eigen::MatrixXd& least_squares, Vector9d& growth) {
  const ceres::CRSMatrix jacobian = evaluate();
  const auto size = static_cast<Eigen::Index>(jacobian.num_cols);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const Eigen::VectorXd gradient = rowOf(jacobian, row);
    information.selfadjointView<Eigen::Lower>().rankUpdate(gradient);
  }
  information = information.selfadjointView<Eigen::Lower>();
  least_squares = solveSymmetric(information, Eigen::MatrixXd::Identity(size, size));
  growth = growthByGroups(jacobian, least_squares,
                          [&](const Patch& patch, int) { return static_cast<long>(patch.image); });
  for (const double numbers : kSharedNumbers)
    growth = growth.cwiseMax(growthByGroups(jacobian, least_squares, [&](const Patch& patch, int c) {
      // What it should read: what it did read would make groups of those that err alike.
      const double expected =
          model_.radiance<double>(patch, state_.water.data(), state_.log_gain[patch.image])[c];
      return std::lround(255 / numbers * expected + 0.5);
    }));
}

}  // namespace fathom
