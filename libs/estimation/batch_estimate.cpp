#include "estimation/batch_estimate.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/progress.h"
#include "effects/catalogue.h"
#include "estimation/linearization.h"
#include "estimation/selected_inverse.h"
#include "estimation/sparse.h"
#include "estimation/wide_prior.h"
#include "sensors/channel_model.h"

namespace fathom {
namespace {

using Kind = UnknownBlock::Kind;

constexpr double kSettled_s = 1e-5;  // latencies that change by less stay as they are

/// Lets all costs compute at once, each for itself, before Ceres adds them up one after the other: the sums
/// do not depend on the number of threads.
class Preparation : public ceres::EvaluationCallback {
 public:
  Preparation(const BatchProblem& problem, const std::vector<BatchCost*>& costs, const Eigen::VectorXd& x)
      : problem_(problem), costs_(costs), x_(x) {
    poses_stay_ = costs.size() < problem.costs().size();
    if (poses_stay_) at_ = problem.pointAt(x, true);
  }
  void PrepareForEvaluation(bool with_jacobians, bool new_point) override {
    if (!new_point && (!with_jacobians || has_jacobians_)) return;
    if (poses_stay_)
      at_.x = x_;
    else
      at_ = problem_.pointAt(x_, with_jacobians);
    parallelFor(costs_.size(), [&](std::size_t i) { costs_[i]->prepare(at_, with_jacobians); });
    has_jacobians_ = with_jacobians;
  }

 private:
  const BatchProblem& problem_;
  const std::vector<BatchCost*>& costs_;
  const Eigen::VectorXd& x_;
  BatchPoint at_;
  bool poses_stay_ = false, has_jacobians_ = false;
};

class Watch : public ceres::IterationCallback {
 public:
  explicit Watch(const BatchOptions& options) : options_(options) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    try {
      progress_.update(static_cast<double>(summary.iteration) / options_.max_iterations);
    } catch (const Interrupted&) {
      return ceres::SOLVER_ABORT;  // Ceres lets no exception through whole: solve() throws it again
    }
    const bool is_last =
        summary.iteration > 0 && summary.step_is_successful && summary.cost_change < options_.cost_tolerance;
    return is_last ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  Progress progress_{"estimating"};
  const BatchOptions& options_;
};

ceres::LossFunction* lossOf(const BatchCost& cost) {
  if (cost.is_wide_prior) return new WidePriorLoss(cost.num_residuals());
  return cost.robust_threshold > 0 ? new ceres::HuberLoss(cost.robust_threshold) : nullptr;
}

/// What cannot be less than nothing is not looked for there.
void setBounds(const BatchProblem& problem, Eigen::VectorXd& x, ceres::Problem& ceres_problem) {
  for (const UnknownBlock& block : problem.blocks()) {
    double* const own = x.data() + block.column;
    if (block.kind != Kind::effect || !ceres_problem.HasParameterBlock(own)) continue;
    int i = 0;
    for (const std::size_t scalar : continuousScalars(block.index)) {
      if (parameterOf(scalar).positive)
        ceres_problem.SetParameterLowerBound(own, i, -problem.reference().effects.values[scalar]);
      ++i;
    }
  }
}

ceres::Solver::Summary solve(const BatchProblem& problem, const std::vector<BatchCost*>& costs,
                             const BatchOptions& options, Eigen::VectorXd& x) {
  Preparation preparation(problem, costs, x);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.evaluation_callback = &preparation;
  ceres::Problem ceres_problem(ownership);
  for (BatchCost* cost : costs) {
    std::vector<double*> parameters;
    for (const std::size_t b : cost->blocks) parameters.push_back(x.data() + problem.blocks()[b].column);
    ceres_problem.AddResidualBlock(cost, lossOf(*cost), parameters);
  }
  setBounds(problem, x, ceres_problem);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-9;
  // Steps of Gauss-Newton until one fails: damped, a path of minutes takes three to five times as many to
  // bend where no reading is near, and seems to have settled before.
  solver.initial_trust_region_radius = 1e12;
  solver.max_num_consecutive_invalid_steps = 30;  // each halves the radius, the next quarters it, ...
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  Watch watch(options);
  solver.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  if (summary.termination_type == ceres::USER_FAILURE) throw Interrupted{};
  return summary;
}

/// Seconds by which the latencies of two calibrations differ at most, of whatever lasts: at the first and the
/// last reading.
double latencyChange(const EffectParameters<double>& a, const EffectParameters<double>& b,
                     const BatchData& data) {
  const auto lasting = [](EffectParameters<double> effects) {
    effects.on.set();  // neutral where they are not
    effects.active_s.fill({});
    return effects;
  };
  const auto before = lasting(a), after = lasting(b);
  double change_s = 0.0;
  const auto look = [&]<class Instrument>() {
    for (const double t_s : {data.first_s, data.last_s})
      change_s = std::max(change_s, std::abs(validityOffset<Instrument>(before, t_s) -
                                             validityOffset<Instrument>(after, t_s)));
  };
  forEachInstrument([&]<class Instrument>() {
    if constexpr (std::is_same_v<typename Instrument::Instrument, Instrument>)
      look.template operator()<Instrument>();
  });
  look.template operator()<Camera>();
  return change_s;
}

/// Has the path's knots where the INS's readings begin and end, see knotEffect().
void keepKnotsOnInsClock(const BatchData& data, BatchState& state) {
  if (!state.path.isSpline()) return;
  const double begin_s = gridBegin_s(data) - knotLatency_s(state.effects);
  if (std::abs(begin_s - state.path.begin_s) > kSettled_s) state.path = state.path.begunAt(begin_s);
}

/// Covariances at the estimate, of what shares rows.
class Uncertainty {
 public:
  Uncertainty(const BatchProblem& problem, const Linearization& weighted)
      : problem_(problem), covariance_(lowerNormal(weighted.J)) {}

  Eigen::MatrixXd of(const std::vector<const UnknownBlock*>& blocks) const {
    std::vector<Eigen::Index> indices;
    for (const UnknownBlock* block : blocks)
      for (int i = 0; i < block->size; ++i) indices.push_back(block->column + i);
    return covariance_.block(indices);
  }
  Eigen::MatrixXd of(Kind kind, std::size_t index) const { return of({problem_.find(kind, index)}); }

  Matrix6d ofPose(const MotionNode& node) const {
    std::vector<const UnknownBlock*> poses;
    for (int k = 0; k < node.count; ++k) poses.push_back(problem_.find(Kind::pose, node.pose(k)));
    const BatchState& reference = problem_.reference();
    Eigen::MatrixXd slope = motionJacobian(reference.path, node).topRows<6>();
    if (const UnknownBlock* latency = problem_.knotBlock(); latency != nullptr) {
      // Knots come so much earlier, and what follows them with them.
      poses.push_back(latency);
      const Motion motion = motionOf(reference.path, node);
      slope.conservativeResize(Eigen::NoChange, slope.cols() + 1);
      slope.rightCols<1>() << motion.velocity_odom, motion.rate_robot;
    }
    return slope * of(poses) * slope.transpose();
  }

  /// a^T Cov a of each row.
  Eigen::VectorXd leverages(const Eigen::SparseMatrix<double, Eigen::RowMajor>& J) const {
    Eigen::VectorXd result(J.rows());
    parallelFor(J.rows(), [&](Eigen::Index i) {
      double sum = 0;
      using Entry = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
      for (Entry a(J, i); a; ++a) {
        sum += a.value() * a.value() * covariance_(a.col(), a.col());
        for (Entry b(J, i); b.col() < a.col(); ++b)
          sum += 2 * a.value() * b.value() * covariance_(a.col(), b.col());
      }
      result[i] = sum;
    });
    return result;
  }

 private:
  static Eigen::SparseMatrix<double> lowerNormal(const Eigen::SparseMatrix<double>& J) {
    return transposedTimes(J, J).triangularView<Eigen::Lower>();
  }
  const BatchProblem& problem_;
  SelectedInverse covariance_;
};

void addPath(BatchEstimate& estimate, const BatchData& data, const BatchProblem& problem,
             const Uncertainty& uncertainty, double rate_hz) {
  const BatchState& state = problem.reference();
  const auto add = [&](double t_s, const MotionNode& node, std::ptrdiff_t image) {
    const Motion motion = motionOf(state.path, node);
    estimate.path.push_back({t_s,
                             {motion.T_odom_robot, uncertainty.ofPose(node)},
                             motion.T_odom_robot.rotation.transpose() * motion.velocity_odom,
                             image});
  };
  if (state.path.isSpline()) {
    const auto count = static_cast<int>(std::floor((data.last_s - data.first_s) * rate_hz + 1e-6));
    for (int i = 0; i <= count; ++i) {
      const double t_s = data.first_s + i / rate_hz;
      add(t_s, state.path.nodeAt(t_s), -1);
    }
    return;
  }
  std::map<std::size_t, double> stamps;
  for (const BatchMarker& seen : data.markers) stamps[seen.image] = seen.t_s;
  for (std::size_t i = 0; i < state.images.size(); ++i)
    add(stamps.at(state.images[i]), {static_cast<int>(i), 1, 0.0},
        static_cast<std::ptrdiff_t>(state.images[i]));
}

void addParameters(BatchEstimate& estimate, const BatchProblem& problem, const Uncertainty& uncertainty) {
  const BatchState& state = problem.reference();
  std::vector<const UnknownBlock*> effect_blocks;
  estimate.drift_sigma = state.drifts;
  for (const UnknownBlock& block : problem.blocks()) {
    if (block.kind == Kind::drift)
      estimate.drift_sigma[block.index].knots[block.knot] = uncertainty.of({&block}).diagonal().cwiseSqrt();
    if (block.kind == Kind::effect) effect_blocks.push_back(&block);
  }
  for (std::size_t i = 0; i < state.T_odom_panel.size(); ++i) {
    const bool estimated = problem.find(Kind::panel, i) != nullptr;
    estimate.T_odom_panel.push_back(
        {state.T_odom_panel[i], estimated ? Matrix6d(uncertainty.of(Kind::panel, i)) : Matrix6d::Zero()});
  }
  if (effect_blocks.empty()) return;
  estimate.effect_covariance = uncertainty.of(effect_blocks);
  for (const UnknownBlock* block : effect_blocks)
    for (const std::size_t scalar : continuousScalars(block->index)) {
      const auto i = std::ssize(estimate.effects);
      estimate.effects.push_back(
          {block->index, scalar, state.effects.values[scalar], std::sqrt(estimate.effect_covariance(i, i))});
    }
}

void addResiduals(BatchEstimate& estimate, const BatchProblem& problem, const Linearization& weighted,
                  const Eigen::VectorXd& leverages) {
  for (Eigen::Index i = 0; i < weighted.residual.size(); ++i) {
    const RowInfo& row = weighted.rows[static_cast<std::size_t>(i)];
    ChannelResidual& channel = estimate.residuals[row.channel];
    ++channel.rows;
    const bool is_outlier = row.robust_weight < 1.0 && row.channel != kChannel<Prior>;
    if (is_outlier) ++channel.down_weighted;
    channel.rms += weighted.residual[i] * weighted.residual[i];
    channel.expected_rms += 1.0 - leverages[i];
    if (row.component == 0 && is_outlier)
      estimate.down_weighted.push_back({problem.costs()[row.reading]->source, row.robust_weight});
  }
  for (auto& [name, channel] : estimate.residuals) {
    channel.rms = std::sqrt(channel.rms / static_cast<double>(channel.rows));
    channel.expected_rms = std::sqrt(std::max(0.0, channel.expected_rms) / static_cast<double>(channel.rows));
  }
}

/// Effects in which two estimates differ, as far as the second has been taken over already; all, where the
/// first was minimized with other options otherwise.
std::bitset<kEffectCount> changedEffects(const BatchEstimate& from, const BatchEstimate& to,
                                         const BatchOptions& options) {
  std::bitset<kEffectCount> changed;
  if (!from.options || from.options->problem.noise_scale != options.problem.noise_scale ||
      from.options->problem.light_scatter != options.problem.light_scatter ||
      from.options->problem.robust_probability != options.problem.robust_probability ||
      options.problem.path_prior)
    return changed.set();
  const EffectParameters<double>&before = from.state.effects, &after = to.state.effects;
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    changed[e] = before.on[e] != after.on[e] || !(before.active_s[e] == after.active_s[e]) ||
                 before.only[e] != after.only[e] ||
                 from.options->problem.estimate[e] != options.problem.estimate[e];
    for (std::size_t s = kEffectOffsets[e]; s < kEffectOffsets[e + 1]; ++s)
      changed[e] = changed[e] || before.values[s] != after.values[s];
  }
  return changed;
}

/// What the calibration says now, but the present values of those that were and are estimated.
void takeOver(const EffectParameters<double>& calibration, const std::bitset<kEffectCount>& keep,
              EffectParameters<double>& effects) {
  const EffectParameters<double> before = effects;
  effects = calibration;
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    if (!keep[e]) continue;
    for (const std::size_t s : continuousScalars(e)) effects.values[s] = before.values[s];
  }
}

}  // namespace

BatchEstimate estimateBatch(const BatchData& data, const StartPath& start, const BatchOptions& options) {
  BatchEstimate from;
  const bool needs_path = data.hasMotion() || data.tie_points.empty();
  if (needs_path && start.T_odom_robot.empty()) {
    from.failure = "no path to start from: " + start.source;
    return from;
  }
  from.state =
      startState(data, start.times_s, start.T_odom_robot, options.calibration, options.drift_interval_s);
  from.path_prior = start.prior(data);
  return reestimate(data, from, options);
}

BatchEstimate reestimate(const BatchData& data, const BatchEstimate& from, const BatchOptions& options) {
  BatchEstimate minimum = bestMinimumFrom(data, from, options);
  return minimum.succeeded ? described(data, std::move(minimum), options) : minimum;
}

BatchEstimate minimumFrom(const BatchData& data, const BatchEstimate& from, const BatchOptions& options) {
  BatchEstimate estimate;
  estimate.state = from.state;
  takeOver(options.calibration, options.problem.estimate & from.state.effects.on, estimate.state.effects);
  keepKnotsOnInsClock(data, estimate.state);
  estimate.path_prior = options.problem.path_prior ? options.problem.path_prior : from.path_prior;
  estimate.options = std::make_shared<const BatchOptions>(options);
  const std::bitset<kEffectCount> changed = changedEffects(from, estimate, options);
  std::unique_ptr<BatchProblem> problem = problemAt(data, estimate, options);
  for (bool settled = false; !settled && estimate.rounds < options.max_rounds; ++estimate.rounds) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(problem->unknowns());
    const std::vector<BatchCost*> costs = problem->touchedBy(changed);
    const bool poses_stay = costs.size() < problem->costs().size();
    const ceres::Solver::Summary summary = solve(*problem, costs, options, x);
    estimate.stopped = summary.message;
    estimate.iterations += static_cast<int>(summary.iterations.size()) - 1;
    if (estimate.rounds == 0) estimate.cost_start = summary.initial_cost;
    estimate.cost = summary.final_cost;
    if (!summary.IsSolutionUsable()) {
      estimate.failure = summary.message;
      return estimate;
    }
    const EffectParameters<double> before = estimate.state.effects;
    estimate.state = problem->at(x);
    // What light was compared at is where things were before.
    const bool has_moved = latencyChange(before, estimate.state.effects, data) > kSettled_s ||
                           (!data.patches.empty() && !poses_stay && estimate.rounds == 0);
    const bool has_gained = summary.initial_cost - summary.final_cost >= options.cost_tolerance;
    settled = !has_moved || (estimate.rounds > 0 && !has_gained);
    if (settled || estimate.rounds + 1 == options.max_rounds) continue;
    problem = problemAt(data, estimate, options);
  }
  estimate.succeeded = true;
  estimate.failure.clear();
  return estimate;
}

BatchEstimate bestMinimumFrom(const BatchData& data, const BatchEstimate& from, BatchOptions options) {
  BatchEstimate best = minimumFrom(data, from, options);
  if (data.hasMotion()) return best;
  for (const EffectInfo& effect : allEffects()) {
    const bool was_estimated = from.options && from.options->problem.estimate[effect.index];
    if (!options.problem.estimate[effect.index] || was_estimated) continue;
    std::size_t scalar = effect.first_scalar;
    for (const Parameter& p : effect.parameters) {
      if (p.other_start != 0 && options.calibration.values[scalar] == 0) {
        BatchEstimate elsewhere = from;
        options.calibration.values[scalar] = elsewhere.state.effects.values[scalar] = p.other_start;
        BatchEstimate other = minimumFrom(data, elsewhere, options);
        if (other.succeeded && (!best.succeeded || other.cost < best.cost)) best = std::move(other);
        options.calibration.values[scalar] = 0;
      }
      scalar += static_cast<std::size_t>(p.size);
    }
  }
  return best;
}

BatchEstimate described(const BatchData& data, BatchEstimate minimum, const BatchOptions& options) {
  const std::unique_ptr<BatchProblem> problem = problemAt(data, minimum, options);
  Linearization linear = linearize(data, *problem, false);
  applyRobustWeights(linear);
  const Uncertainty uncertainty(*problem, linear);
  addPath(minimum, data, *problem, uncertainty, options.output_rate_hz);
  addParameters(minimum, *problem, uncertainty);
  addResiduals(minimum, *problem, linear, uncertainty.leverages(linear.J));
  minimum.rows = linear.rows.size();
  minimum.unknowns = static_cast<std::size_t>(problem->unknowns());
  minimum.markers_behind_camera = problem->behindCamera();
  return minimum;
}

BatchEstimate adaptNoise(const BatchData& data, BatchEstimate estimate, BatchOptions& options) {
  constexpr int kPasses = 3;  // robust weights hide some of a noise that is assumed too small
  for (int pass = 0; pass < kPasses && estimate.succeeded; ++pass) {
    for (const auto& [channel, residual] : estimate.residuals)
      if (channel != kChannel<Prior> && residual.expected_rms > 0)
        options.problem.noise_scale[indexOf(channel)] *= std::max(1.0, residual.rms / residual.expected_rms);
    estimate = reestimate(data, estimate, options);
  }
  return estimate;
}

std::unique_ptr<BatchProblem> problemAt(const BatchData& data, const BatchEstimate& estimate,
                                        const BatchOptions& options) {
  ProblemOptions problem = options.problem;
  problem.path_prior = estimate.path_prior;
  return std::make_unique<BatchProblem>(data, problem, estimate.state);
}

}  // namespace fathom
