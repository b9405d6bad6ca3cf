#include "tuning/tune.h"

#include <Eigen/Eigenvalues>
#include <cmath>
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
    const Eigen::MatrixXd parts = partsAt(points);
    std::vector<double> values(points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
      values[k] = parts.col(static_cast<Eigen::Index>(k)).sum() + prior(points[k]);
    return values;
  }

  /// Of each recording, one below the other, part by part in time; a column for each point. The prior is left
  /// out.
  Eigen::MatrixXd partsAt(const std::vector<Eigen::VectorXd>& points) const {
    const std::size_t each = recordings_.size();
    std::vector<std::vector<double>> parts(points.size() * each);
    parallelFor(parts.size(), [&](std::size_t i) {
      parts[i] = score(recordings_[i % each], optionsAt(points[i / each]), blocks_).fit_parts;
    });
    runs_ += static_cast<int>(points.size());
    std::vector<std::size_t> first_row(each + 1, 0);
    for (std::size_t i = 0; i < each; ++i)
      for (std::size_t k = 0; k < points.size(); ++k)
        first_row[i + 1] = std::max(first_row[i + 1], first_row[i] + parts[k * each + i].size());
    Eigen::MatrixXd columns =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(first_row.back()), std::ssize(points));
    for (std::size_t i = 0; i < parts.size(); ++i)
      columns.col(static_cast<Eigen::Index>(i / each))
          .segment(static_cast<Eigen::Index>(first_row[i % each]), std::ssize(parts[i])) =
          -Eigen::Map<const Eigen::VectorXd>(parts[i].data(), std::ssize(parts[i]));
    return columns;
  }

  static double prior(const Eigen::VectorXd& logs) { return 0.5 * (logs / kPrior).squaredNorm(); }
  int runs() const { return runs_; }

 private:
  const std::vector<TunedRecording>& recordings_;
  const LocalizationOptions options_;
  const std::vector<NoiseParameter> parameters_;
  const Blocks blocks_;
  mutable int runs_ = 0;
};

/// The objective about a point. Each part's gradient is what that part adds to the score, so that the sum of
/// their squares is the information where the filter explains the recording (Berndt, Hall, Hall & Hausman
/// 1974): no second differences are needed for a step.
struct Slope {
  double value = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;

  Slope(const Objective& objective, const Eigen::VectorXd& at) {
    const Eigen::Index n = at.size();
    std::vector<Eigen::VectorXd> points{at};
    for (Eigen::Index i = 0; i < n; ++i)
      for (const double step : {-kStep, kStep}) points.emplace_back(at + step * Eigen::VectorXd::Unit(n, i));
    const Eigen::MatrixXd parts = objective.partsAt(points);
    Eigen::MatrixXd gradients(parts.rows(), n);
    for (Eigen::Index i = 0; i < n; ++i)
      gradients.col(i) = (parts.col(2 * i + 2) - parts.col(2 * i + 1)) / (2.0 * kStep);
    value = parts.col(0).sum() + Objective::prior(at);
    gradient = gradients.colwise().sum().transpose() + at / (kPrior * kPrior);
    information = gradients.transpose() * gradients;
    information.diagonal().array() += 1.0 / (kPrior * kPrior);
  }
};

/// Second derivatives at the maximum, over steps of about one sigma of each: those of two sizes by the bend
/// along both at once, less those along each.
Eigen::MatrixXd curvature(const Objective& objective, const Eigen::VectorXd& at,
                          const Eigen::MatrixXd& information) {
  const int n = objective.size();
  const Eigen::VectorXd steps =
      information.diagonal().cwiseSqrt().cwiseInverse().cwiseMax(kStep).cwiseMin(0.5);
  const auto along = [&](int i) -> Eigen::VectorXd { return steps[i] * Eigen::VectorXd::Unit(n, i); };
  std::vector<Eigen::VectorXd> points{at};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j)
      for (const double sign : {-1.0, 1.0})
        points.emplace_back(at + sign * (i == j ? along(i) : Eigen::VectorXd(along(i) + along(j))));
  const std::vector<double> values = objective.at(points);
  Eigen::MatrixXd twice(n, n);  // along each direction, and along the sum of two
  std::size_t k = 1;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j, k += 2) twice(i, j) = values[k] + values[k + 1] - 2.0 * values[0];
  Eigen::MatrixXd H(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j)
      H(i, j) = H(j, i) =
          (i == j ? twice(i, i) : 0.5 * (twice(i, j) - twice(i, i) - twice(j, j))) / (steps[i] * steps[j]);
  return H;
}

/// Their inverse. Second differences of what is rough, or bent, may come out far too small, and even below
/// zero: in no direction is less believed to be known than a tenth of the information.
Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& curvature, const Eigen::MatrixXd& information) {
  constexpr double kLeast = 0.1;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(curvature, information);
  const Eigen::VectorXd variances = eigen.eigenvalues().cwiseMax(kLeast).cwiseInverse();
  return eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose();
}

/// 95 % interval of a factor, by the sigma of its logarithm. A white noise adds to others, as squares do:
/// what is small among them may as well be none, and its logarithm has no lower end.
std::pair<double, double> interval(double sigma, bool is_white) {
  constexpr double k95 = 1.96;
  const double high = std::exp(k95 * sigma);
  return {is_white ? std::sqrt(std::max(0.0, 1.0 - 2.0 * k95 * sigma)) : 1.0 / high, high};
}

/// By all recordings.
bool isConstant(const NoiseParameter& parameter, const std::vector<Scores>& scores) {
  constexpr double kUneven = 2.0;  // of fifty seconds, five standard deviations
  return !parameter.seen_by || std::none_of(scores.begin(), scores.end(), [&](const Scores& of_one) {
    const auto seen = of_one.fit.channels.find(*parameter.seen_by);
    return seen != of_one.fit.channels.end() && seen->second.unevenness() > kUneven;
  });
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
        if (const Eigen::VectorXd point = others + of_sensor * sensor + of_drive * drive; point != logs)
          points.push_back(point);
    const std::vector<double> values = objective.at(points);
    logs = points[static_cast<std::size_t>(std::min_element(values.begin(), values.end()) - values.begin())];
  }
  return logs;
}

/// Broyden, Fletcher, Goldfarb, Shanno: the curvature as it must be for the gradient to have changed so.
Eigen::MatrixXd updated(const Eigen::MatrixXd& curvature, const Eigen::VectorXd& step,
                        const Eigen::VectorXd& change) {
  const Eigen::VectorXd bent = curvature * step;
  if (!(change.dot(step) > 0.0)) return curvature;
  return curvature + change * change.transpose() / change.dot(step) -
         bent * bent.transpose() / step.dot(bent);
}

/// From there to the maximum. A step is by the information of the point, or by the curvature that the steps
/// before have met, whichever gets higher: far off the first knows more, and at the end the second, where the
/// motion is not driven as the filter has it. Ends where a step gains nothing that matters: a hundredth of
/// log likelihood is a seventh of a sigma.
Eigen::VectorXd climb(const Objective& objective, Eigen::VectorXd logs, int most_steps,
                      const std::function<void(double)>& progress) {
  constexpr double kMatters = 0.01, kLongest = 1.5;
  Slope slope(objective, logs);
  Eigen::MatrixXd met = slope.information;
  for (int k = 0; k < most_steps; ++k) {
    progress(0.2 + 0.6 * k / most_steps);
    std::vector<Eigen::VectorXd> steps;
    for (const Eigen::MatrixXd* curvature : {&slope.information, &met}) {
      const Eigen::VectorXd step = -curvature->ldlt().solve(slope.gradient);
      const double fit = std::min(1.0, kLongest / step.cwiseAbs().maxCoeff());
      for (const double length : {1.0, 0.5, 0.1}) steps.emplace_back(length * fit * step);
    }
    std::vector<Eigen::VectorXd> points;
    for (const Eigen::VectorXd& step : steps) points.emplace_back(logs + step);
    const std::vector<double> values = objective.at(points);
    const auto best = std::min_element(values.begin(), values.end()) - values.begin();
    const double gain = slope.value - values[static_cast<std::size_t>(best)];
    if (gain > 0.0) logs = points[static_cast<std::size_t>(best)];
    if (!(gain > kMatters)) break;
    const Slope next(objective, logs);
    met = updated(best < std::ssize(steps) / 2 ? slope.information : met,
                  steps[static_cast<std::size_t>(best)], next.gradient - slope.gradient);
    slope = next;
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

}  // namespace

std::optional<double> Tuning::judgedGain() const {
  double gain = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < scores_after.size(); ++i) {
    gain += scores_after[i].judged.log_likelihood - scores_before[i].judged.log_likelihood;
    for (const auto& [channel, seen] : scores_after[i].judged.channels) count += seen.count;
  }
  if (count == 0) return {};
  return gain / static_cast<double>(count);
}

Tuning tune(const std::vector<TunedRecording>& recordings, const LocalizationOptions& options,
            const TuneOptions& how, const std::function<void(double fraction)>& progress) {
  Tuning tuning;
  const Vehicle& vehicle = recordings.front().setup.vehicle;
  tuning.before = options;
  tuning.scores_before = scoresOf(recordings, options, how.blocks);
  const Scores all = sumOf(tuning.scores_before);
  if (all.fit.channels.empty())
    throw Error("recordings", "", "none is long enough: nothing is left of the stretches to fit by");
  tuning.before = writtenOut(options, vehicle, all);
  const Objective objective(recordings, tuning.before, noiseParameters(tuning.before, vehicle, all),
                            how.blocks);

  progress(0.0);
  const Eigen::VectorXd logs = climb(objective, begin(objective), how.most_iterations, progress);
  tuning.after = objective.optionsAt(logs);
  tuning.scores_after = scoresOf(recordings, tuning.after, how.blocks);
  const Eigen::MatrixXd information = Slope(objective, logs).information;
  const Eigen::MatrixXd covariance = covarianceOf(curvature(objective, logs, information), information);
  tuning.runs = objective.runs();
  progress(1.0);
  for (int i = 0; i < objective.size(); ++i) {
    const NoiseParameter& parameter = objective.parameters()[static_cast<std::size_t>(i)];
    const double sigma = std::min(std::sqrt(covariance(i, i)), kPrior);
    const double after = parameter.value * std::exp(logs[i]);
    const auto [low, high] = interval(sigma, parameter.seen_by.has_value());
    tuning.parameters.push_back({parameter.name, parameter.unit, parameter.value, after, low * after,
                                 high * after, sigma < 0.5 * kPrior,
                                 isConstant(parameter, tuning.scores_after)});
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
