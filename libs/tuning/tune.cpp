#include "tuning/tune.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>
#include <mutex>
#include <numbers>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/parallel.h"
#include "core/text.h"
#include "tuning/noise_parameters.h"

namespace fathom {
namespace {

/// Of the logarithm of each size: one decade.
constexpr double kPrior = std::numbers::ln10;
/// Of differences: what is smaller drowns in readings that pass the gate or do not.
constexpr double kStep = 0.03;

/// Minus the log posterior of the sizes' logarithms.
class Objective {
 public:
  Objective(const std::vector<TunedRecording>& recordings, const LocalizationOptions& options,
            std::vector<NoiseParameter> parameters, const Blocks& blocks)
      : recordings_(recordings), options_(options), parameters_(std::move(parameters)), blocks_(blocks) {}

  int size() const { return static_cast<int>(parameters_.size()); }
  const std::vector<NoiseParameter>& parameters() const { return parameters_; }

  LocalizationOptions optionsAt(const Eigen::VectorXd& logs) const {
    LocalizationOptions options = options_;
    for (int i = 0; i < size(); ++i)
      parameters_[static_cast<std::size_t>(i)].multiply(options, std::exp(logs[i]));
    return options;
  }

  /// At several points, on all cores.
  std::vector<double> at(const std::vector<Eigen::VectorXd>& points) const {
    const std::size_t each = recordings_.size();
    std::vector<double> parts(points.size() * each);
    parallelFor(parts.size(), [&](std::size_t i) {
      const Scores scores = score(recordings_[i % each], optionsAt(points[i / each]), blocks_);
      parts[i] = -scores.fit.log_likelihood;
    });
    std::vector<double> values(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      values[k] = 0.5 * (points[k] / kPrior).squaredNorm();
      for (std::size_t i = 0; i < each; ++i) values[k] += parts[k * each + i];
    }
    return values;
  }

 private:
  const std::vector<TunedRecording>& recordings_;
  const LocalizationOptions options_;
  const std::vector<NoiseParameter> parameters_;
  const Blocks blocks_;
};

/// The objective with its gradient by central differences.
class Differenced : public ceres::FirstOrderFunction {
 public:
  explicit Differenced(const Objective& objective) : objective_(objective) {}

  int NumParameters() const override { return objective_.size(); }
  bool Evaluate(const double* logs, double* cost, double* gradient) const override {
    const Eigen::VectorXd here = Eigen::Map<const Eigen::VectorXd>(logs, objective_.size());
    std::vector<Eigen::VectorXd> points{here};
    if (gradient != nullptr)
      for (int i = 0; i < objective_.size(); ++i)
        for (const double step : {-kStep, kStep})
          points.emplace_back(here + step * Eigen::VectorXd::Unit(here.size(), i));
    const std::vector<double> values = objective_.at(points);
    *cost = values[0];
    if (gradient != nullptr)
      for (int i = 0; i < objective_.size(); ++i) {
        const auto k = static_cast<std::size_t>(2 * i);
        gradient[i] = (values[k + 2] - values[k + 1]) / (2.0 * kStep);
      }
    return std::isfinite(*cost);
  }

 private:
  const Objective& objective_;
};

/// Curvature at the maximum, over steps of about one sigma of each.
Eigen::MatrixXd curvature(const Objective& objective, const Eigen::VectorXd& at) {
  const int n = objective.size();
  const auto unit = [n](int i, double step) -> Eigen::VectorXd { return step * Eigen::VectorXd::Unit(n, i); };
  std::vector<Eigen::VectorXd> points{at};
  for (int i = 0; i < n; ++i)
    for (const double step : {-2.0 * kStep, 2.0 * kStep}) points.emplace_back(at + unit(i, step));
  const std::vector<double> along = objective.at(points);
  Eigen::VectorXd steps(n);
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(2 * i);
    const double curve = (along[k + 1] + along[k + 2] - 2.0 * along[0]) / (4.0 * kStep * kStep);
    steps[i] = std::clamp(1.0 / std::sqrt(std::max(curve, 1e-12)), kStep, 0.5);
  }
  points = {at};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j)
      for (const auto& [a, b] : {std::pair(1, 1), {1, -1}, {-1, 1}, {-1, -1}})
        points.emplace_back(at + unit(i, a * steps[i]) + unit(j, b * steps[j]));
  const std::vector<double> values = objective.at(points);
  Eigen::MatrixXd H(n, n);
  std::size_t k = 1;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j, k += 4)
      H(i, j) = H(j, i) =
          (values[k] - values[k + 1] - values[k + 2] + values[k + 3]) / (4.0 * steps[i] * steps[j]);
  return H;
}

/// Where the climb begins: the likeliest of decades. A drive and the sensor that sees it are tried together:
/// of a scatter that one of them explains none is left to the other, and from there no slope leads away.
Eigen::VectorXd begin(const Objective& objective) {
  constexpr std::array kTried{-4.5, -3.0, -1.5, 0.0, 1.5};
  const Eigen::Index n = objective.size();
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> together;
  const auto directionOf = [&](const std::string& prefix) {
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i)
      if (objective.parameters()[static_cast<std::size_t>(i)].name.starts_with(prefix)) direction[i] = 1.0;
    return direction;
  };
  const std::string sigma = "sigma of ";
  together.emplace_back(directionOf("angular acceleration"), directionOf(sigma + nameOf(kChannel<Gyro>)));
  together.emplace_back(directionOf("jerk"), directionOf(sigma + nameOf(kChannel<Accelerometer>)));
  for (int i = 0; i < n; ++i) together.emplace_back(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Unit(n, i));
  Eigen::VectorXd logs = Eigen::VectorXd::Zero(n);
  constexpr int kPasses = 2;  // the first ones are tried while others are far off
  for (std::size_t k = 0; k < kPasses * together.size(); ++k) {
    const auto& [drive, sensor] = together[k % together.size()];
    const Eigen::VectorXd others = logs.cwiseProduct(Eigen::VectorXd::Ones(n) - drive - sensor);
    std::vector<Eigen::VectorXd> points{logs};
    for (const double of_sensor : kTried)
      for (const double of_drive :
           drive.isZero() ? std::vector{0.0} : std::vector(kTried.begin(), kTried.end()))
        points.emplace_back(others + of_sensor * sensor + of_drive * drive);
    const std::vector<double> values = objective.at(points);
    logs = points[static_cast<std::size_t>(std::min_element(values.begin(), values.end()) - values.begin())];
  }
  return logs;
}

std::vector<Scores> scoresOf(const std::vector<TunedRecording>& recordings,
                             const LocalizationOptions& options, const Blocks& blocks) {
  std::vector<Scores> scores(recordings.size());
  parallelFor(recordings.size(), [&](std::size_t i) { scores[i] = score(recordings[i], options, blocks); });
  return scores;
}

Scores sumOf(const std::vector<Scores>& scores) {
  Scores sum;
  for (const Scores& of_one : scores) {
    for (const auto& [regime, time_s] : of_one.regimes_s) sum.regimes_s[regime] += time_s;
    for (const auto& [channel, seen] : of_one.fit.channels) {
      sum.fit.channels[channel].degrees_of_freedom = seen.degrees_of_freedom;
      sum.fit.channels[channel].count += seen.count;
    }
  }
  return sum;
}

/// Reports, stops after Ctrl-C, and counts.
class Watch : public ceres::IterationCallback {
 public:
  Watch(int most, const std::function<void(double)>& progress) : most_(most), progress_(progress) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    progress_(0.8 * static_cast<double>(summary.iteration) / most_);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  int most_;
  const std::function<void(double)>& progress_;
};

}  // namespace

double Tuning::judgedGain() const {
  double gain = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < scores_after.size(); ++i) {
    gain += scores_after[i].judged.log_likelihood - scores_before[i].judged.log_likelihood;
    for (const auto& [channel, seen] : scores_after[i].judged.channels) count += seen.count;
  }
  return count == 0 ? 0.0 : gain / static_cast<double>(count);
}

Tuning tune(const std::vector<TunedRecording>& recordings, const LocalizationOptions& options,
            const TuneOptions& how, const std::function<void(double fraction)>& progress) {
  Tuning tuning;
  const Vehicle& vehicle = recordings.front().setup.vehicle;
  tuning.before = options;
  tuning.scores_before = scoresOf(recordings, options, how.blocks);
  const Scores all = sumOf(tuning.scores_before);
  tuning.before = writtenOut(options, vehicle, all);
  const Objective objective(recordings, tuning.before, noiseParameters(tuning.before, vehicle, all),
                            how.blocks);

  Eigen::VectorXd logs = begin(objective);
  ceres::GradientProblem problem(new Differenced(objective));
  ceres::GradientProblemSolver::Options solver;
  solver.line_search_direction_type = ceres::BFGS;
  solver.max_num_iterations = how.most_iterations;
  solver.function_tolerance = 1e-7;
  solver.use_approximate_eigenvalue_bfgs_scaling = true;
  solver.logging_type = ceres::SILENT;
  Watch watch(how.most_iterations, progress);
  solver.callbacks.push_back(&watch);
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(solver, problem, logs.data(), &summary);

  tuning.after = objective.optionsAt(logs);
  tuning.scores_after = scoresOf(recordings, tuning.after, how.blocks);
  const Eigen::MatrixXd covariance =
      curvature(objective, logs).ldlt().solve(Eigen::MatrixXd::Identity(logs.size(), logs.size()));
  progress(1.0);
  for (int i = 0; i < objective.size(); ++i) {
    const NoiseParameter& parameter = objective.parameters()[static_cast<std::size_t>(i)];
    const double sigma = std::sqrt(std::max(covariance(i, i), 0.0));
    const double after = parameter.value * std::exp(logs[i]);
    constexpr double k95 = 1.96;
    const double times = std::exp(k95 * sigma);
    tuning.parameters.push_back({parameter.name, parameter.unit, parameter.value, after, after / times,
                                 after * times, sigma > 0.0 && sigma < 0.5 * kPrior});
  }
  return tuning;
}

std::string robotLocalizationYaml(const Tuning& tuning, const Vehicle& vehicle) {
  const LocalizationOptions& o = tuning.after;
  const auto sigma = [&](Channel channel) {
    const auto times = o.sigma_times.find(channel);
    return times == o.sigma_times.end() ? 1.0 : times->second;
  };
  Eigen::Matrix<double, 15, 1> q;
  q << o.noise.position, o.noise.orientation, o.noise.velocity, o.noise.angular_velocity,
      o.noise.acceleration;
  std::string text =
      "# Noise by `fathom tune` for robot_localization's ekf_localization_node. Its process noise is a "
      "variance\n"
      "# gained in a second, of x y z roll pitch yaw and their first two rates. Sensors' noise comes with "
      "the\n"
      "# messages there: the standard deviations that were found are named below.\n"
      "ekf_filter_node:\n  ros__parameters:\n    process_noise_covariance: [";
  for (int row = 0; row < 15; ++row)
    for (int column = 0; column < 15; ++column)
      text.append(row + column == 0 ? ""
                  : column == 0     ? ",\n      "
                                    : ", ")
          .append(row == column ? shortest(q[row]) : "0.0");
  text += "]\n";
  if (vehicle.ins)
    text += print("# imu: angular velocity %.3g rad/s, acceleration %.3g m/s^2\n",
                  vehicle.ins->gyro_sigma_rad_s * sigma(kChannel<Gyro>),
                  vehicle.ins->accelerometer_sigma_m_s2 * sigma(kChannel<Accelerometer>));
  if (vehicle.dvl)
    text += print("# dvl: velocity %.3g m/s level, %.3g m/s upright\n",
                  vehicle.dvl->velocity_sigma_xy_m_s * sigma(kChannel<Dvl>),
                  vehicle.dvl->velocity_sigma_z_m_s * sigma(kChannel<Dvl>));
  return text;
}

}  // namespace fathom
