#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/uncertain_pose.h"
#include "estimation/batch_problem.h"
#include "estimation/filter_start.h"

/// Trajectory, calibration and effects together by maximum a posteriori: the smoother of a whole recording.
namespace fathom {

struct BatchOptions {
  EffectParameters<double> calibration;  ///< effects that are on; of those estimated, where to start
  ProblemOptions problem;
  double drift_interval_s = 10.0;
  int max_iterations = 50;       ///< of a round
  double cost_tolerance = 0.0;   ///< a step, or a round, that lowers the cost by less is the last
  int max_rounds = 5;            ///< a latency that is estimated moves the motion's times between them
  double output_rate_hz = 10.0;  ///< of the path between images
};

struct PathPose {
  double t_s = 0.0;
  UncertainPose T_odom_robot;
  Vector3d velocity_robot = Vector3d::Zero();
  std::ptrdiff_t image = -1;  ///< of poses by themselves: whose it is
};

/// One scalar of an effect that was estimated.
struct EffectEstimate {
  std::size_t effect = 0;  ///< in the registry
  std::size_t scalar = 0;  ///< in EffectParameters::values
  double value = 0.0, sigma = 0.0;
  std::ptrdiff_t image = -1;  ///< of what was drawn for an image
};

/// How large the whitened residuals of a channel are.
struct ChannelResidual {
  std::size_t rows = 0, down_weighted = 0;  ///< down_weighted: rows of readings with a robust weight below 1
  double rms = 0.0;
  /// What it is to be where the noise is as assumed: sqrt(1 - mean leverage), below 1 where the estimate
  /// follows the readings. rms / expected_rms estimates the noise in units of the one assumed.
  double expected_rms = 0.0;
};

struct DownWeighted {
  RowSource source;
  double weight = 1.0;
};

struct BatchEstimate {
  bool succeeded = false;
  std::string failure = "not run";  ///< where it has not
  std::string stopped;              ///< why the last round stopped
  int iterations = 0, rounds = 0;
  /// Half the sum of squares, robust; of what was minimized, see minimumFrom().
  double cost_start = 0.0, cost = 0.0;
  std::size_t rows = 0, unknowns = 0;
  std::size_t markers_behind_camera = 0;

  BatchState state;
  std::shared_ptr<const BatchOptions> options;  ///< that it was minimized with
  std::optional<PathPrior> path_prior;          ///< as it was taken
  std::vector<PathPose> path;
  std::vector<EffectEstimate> effects;
  Eigen::MatrixXd effect_covariance;        ///< of `effects`, in their order
  std::vector<DriftTrack> drift_sigma;      ///< of state.drifts
  std::vector<UncertainPose> T_odom_panel;  ///< covariance zero where it is known
  std::map<Channel, ChannelResidual> residuals;
  std::vector<DownWeighted> down_weighted;
};

/// Levenberg-Marquardt (Ceres) from the start. The same result whatever the number of threads. Throws
/// Interrupted.
BatchEstimate estimateBatch(const BatchData& data, const StartPath& start, const BatchOptions& options);

/// The same from where another estimate of the same data ended, with other options: more effects, or noise.
/// Effects that both estimate go on from their values; of all others the calibration's hold.
BatchEstimate reestimate(const BatchData& data, const BatchEstimate& from, const BatchOptions& options);

/// reestimate() in two steps, for whoever tries many: where the minimum is, `state` and `cost` alone; then
/// all that follows from it, path, covariances and residuals. What options that differ in their effects alone
/// do not touch (BatchProblem::touchedBy()) stays as it was.
BatchEstimate minimumFrom(const BatchData& data, const BatchEstimate& from, const BatchOptions& options);
/// The best of those from there and, of a camera by itself, from the other starts of effects that were not
/// estimated yet (Parameter::other_start).
BatchEstimate bestMinimumFrom(const BatchData& data, const BatchEstimate& from, BatchOptions options);

BatchEstimate described(const BatchData& data, BatchEstimate minimum, const BatchOptions& options);

/// The same with each channel's noise as large as its residuals show, where that is more than stated: sets
/// options.problem.noise_scale. What is left out of the model counts as noise here, so take it from a
/// recording, or a stretch, that is known to be good.
BatchEstimate adaptNoise(const BatchData& data, BatchEstimate estimate, BatchOptions& options);

/// The problem whose zero is the estimate: for linearize().
std::unique_ptr<BatchProblem> problemAt(const BatchData& data, const BatchEstimate& estimate,
                                        const BatchOptions& options);

}  // namespace fathom
