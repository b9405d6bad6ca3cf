#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "estimation/batch_data.h"
#include "estimation/motion_table.h"
#include "estimation/readings.h"

/// The batch estimate as a least-squares problem: unknowns, and the rows of residuals that they explain.
namespace fathom {

/// What is drawn of an effect's spread for one image.
struct Draw {
  std::size_t scalar = 0;  ///< in EffectParameters::values
  std::size_t image = 0;   ///< see ImagePatch
  friend auto operator<=>(const Draw&, const Draw&) = default;
};

/// What is estimated, as numbers.
struct BatchState {
  PosePath path;
  std::vector<std::size_t> images;  ///< of poses by themselves: number of each one's image
  /// Gyro (rad/s) and accelerometer bias (m/s²), INS axes, at path.begin_s + k bias_interval_s; linear
  /// between. Empty without an INS.
  std::vector<Vector6d> bias;
  double bias_interval_s = 10.0;
  double pressure_offset_pa = 0.0;
  std::vector<Pose> T_odom_panel;
  Pose T_left_right;                  ///< of a pair of cameras that sees tie points
  Vector9d water = Vector9d::Zero();  ///< waterParameters(), where there are patches
  Flaws flaws = Flaws::Zero();        ///< of images, see ImageFlaw
  EffectParameters<double> effects;   ///< all that are on, estimated or not
  std::map<Draw, double> draws;       ///< of effects that are drawn anew for each image; missing: 0

  double drawn(const Draw& draw) const {
    const auto found = draws.find(draw);
    return found == draws.end() ? 0.0 : found->second;
  }
};

struct PathPrior {
  Pose T_odom_robot;  ///< at the path's beginning
  double position_sigma_m = 100.0, heading_sigma_rad = 3.0;
};

/// Every channel's sigma as the data sheet has it.
constexpr std::array<double, kBatchChannels.size()> asStated() {
  std::array<double, kBatchChannels.size()> ones{};
  ones.fill(1);
  return ones;
}

struct ProblemOptions {
  /// Effects whose continuous parameters are estimated, starting from the state's.
  std::bitset<kEffectCount> estimate;
  /// Sigma of each channel in units of the data sheet's (or of a corner's own covariance), by BatchChannel.
  std::array<double, kBatchChannels.size()> noise_scale = asStated();
  /// By what share of their light patches scatter besides.
  double light_scatter = 0;
  /// Huber's loss for DVL, USBL and markers, beyond what a reading's chi-square exceeds with probability
  /// 1 - this; 1: none. Generous, so that what is out of place keeps most of its weight.
  double robust_probability = 0.99999;
  /// What keeps stretches without an INS from being singular: a vehicle hardly accelerates more than this
  /// (one sigma, white, each knot). With an INS its weight is 1e-5 of the INS's.
  double acceleration_sigma_m_s2 = 1.0, angular_acceleration_sigma_rad_s2 = 1.0;
  std::optional<PathPrior> path_prior;  ///< absent: as StartPath::prior() says
};

/// A block of unknowns: coordinates of the error of one part of a reference state.
struct UnknownBlock {
  enum class Kind { pose, bias, pressure_offset, panel, right_camera, water, flaws, effect, draw };
  Kind kind = Kind::pose;
  std::size_t index = 0;  ///< in the state's list, of an effect: in the registry, of a draw: in draws()
  int size = 6;
  int column = 0;  ///< of its first coordinate
};

/// What a cost's rows are about.
struct RowSource {
  BatchChannel channel = BatchChannel::prior;
  double t_s = 0.0;
  std::ptrdiff_t marker = -1;     ///< index in BatchData::markers; -1: none
  std::ptrdiff_t tie_point = -1;  ///< likewise
  std::ptrdiff_t patch = -1;
  std::ptrdiff_t blur = -1;
  std::ptrdiff_t specks = -1;
};

/// Coordinates of all unknowns, and the motions that the poses have there.
struct BatchPoint {
  Eigen::VectorXd x;
  Motions motions;
};

/// Huber's weight on the square of a residual of this norm; threshold 0: 1.
double huberWeight(double norm, double threshold);

/// A few rows of residuals, whitened: r = W (reading - prediction).
class BatchCost : public ceres::CostFunction {
 public:
  RowSource source;
  double robust_threshold = 0.0;  ///< on |r|; 0: none
  std::vector<std::size_t> blocks;

  /// Derivative: by the coordinates of its blocks, one behind the other; needs the motions' derivatives.
  virtual void compute(const BatchPoint& at, Eigen::VectorXd& residual,
                       Eigen::MatrixXd* derivative) const = 0;
  /// Derivative at the motions of x = 0 by all continuous scalars of all effects, a column each as in
  /// EffectParameters; every one taken as acting here: its marker id is this marker's, its time long past,
  /// its interval open.
  virtual void effectColumns(const Motions&, Eigen::Ref<Eigen::MatrixXd> columns) const { columns.setZero(); }

  /// Whether an effect, where it is there, could change the rows.
  virtual bool dependsOn(std::size_t) const { return false; }

  /// Residuals, a column each, in the reading's unit: reading - prediction.
  virtual Eigen::MatrixXd raw(const Eigen::MatrixXd& residuals) const { return residuals; }

  /// Computes what Evaluate() then hands out. May run beside others'.
  void prepare(const BatchPoint& at, bool with_derivative);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 protected:
  void finishSetup(const std::vector<UnknownBlock>& unknowns, int rows);

 private:
  std::vector<int> sizes_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd derivative_;
};

/// Unknowns are error coordinates of a reference state: zero there, added up by at().
class BatchProblem {
 public:
  /// Data is referred to and must outlive it.
  BatchProblem(const BatchData& data, const ProblemOptions& options, const BatchState& reference);
  BatchProblem(const BatchProblem&) = delete;
  BatchProblem& operator=(const BatchProblem&) = delete;

  const BatchState& reference() const { return reference_; }
  BatchState at(const Eigen::VectorXd& x) const;
  /// What costs are computed at; the motions' derivatives only where theirs are wanted.
  BatchPoint pointAt(const Eigen::VectorXd& x, bool with_derivatives) const;
  const std::vector<UnknownBlock>& blocks() const { return blocks_; }
  /// Null: not estimated.
  const UnknownBlock* find(UnknownBlock::Kind kind, std::size_t index) const;
  int unknowns() const { return unknowns_; }
  const std::vector<std::unique_ptr<BatchCost>>& costs() const { return costs_; }
  /// Those that must be minimized anew where they had been at their minimum before these effects changed:
  /// what shares unknowns with one that depends on them, directly or through others. All of them where poses
  /// are among these unknowns: light is looked at from where they are.
  std::vector<BatchCost*> touchedBy(const std::bitset<kEffectCount>& effects) const;
  /// Of effects that are on, or estimated: by effect, then by image.
  const std::vector<Draw>& draws() const { return draws_; }
  bool estimates(std::size_t effect) const { return options_.estimate[effect]; }
  /// The motion of the reference at a stamp, or on an image.
  Motion motionAt(double t_s, std::size_t image) const;
  std::size_t behindCamera() const { return behind_camera_; }

 private:
  void layOut();
  void addDraws(std::size_t effect);
  void addReadings();
  void addMarkers();
  void addTiePoints();
  void addPatches();
  void addBlurs();
  void addSpecks();
  bool hasPose(std::size_t image) const;
  PosePath pathAt(const Eigen::VectorXd& x) const;
  void addPriors();
  MotionNode nodeOf(double t_s, std::size_t image) const;
  void add(std::unique_ptr<ReadingModel> model, RowSource source, std::vector<double> node_s,
           Eigen::VectorXd reading, const Eigen::MatrixXd& whitening);
  void addPosePrior(const UnknownBlock& block, const Pose& nominal, const Pose& reference,
                    double position_sigma_m, double angle_sigma_rad);
  void addLinear(const UnknownBlock& block, const Eigen::VectorXd& value, const Eigen::MatrixXd& slope);
  std::bitset<kEffectCount> actingOn(const ReadingModel& model, const RowSource& source) const;
  double thresholdOf(BatchChannel channel, Eigen::Index rows);

  const BatchData& data_;
  ProblemOptions options_;
  BatchState reference_;
  std::vector<UnknownBlock> blocks_;  ///< in the order of elimination: by time, then what is constant
  std::map<std::pair<UnknownBlock::Kind, std::size_t>, std::size_t> block_of_;
  std::vector<Draw> draws_;
  std::vector<std::size_t> image_pose_;  ///< of poses by themselves: by image
  MotionTable motions_;
  int unknowns_ = 0;
  std::size_t behind_camera_ = 0;
  std::vector<std::unique_ptr<BatchCost>> costs_;
  std::map<Eigen::Index, double>
      robust_thresholds_;  ///< by rows: a quantile costs more than the rest of a cost
};

/// An effect's continuous scalars, by their place in EffectParameters::values: those that are estimated.
std::vector<std::size_t> continuousScalars(std::size_t effect);

/// The first state of a problem: a spline near a path, or a pose an image. Images without one are left out.
BatchState startState(const BatchData& data, const std::vector<double>& times_s,
                      const std::vector<Pose>& T_odom_robot, const EffectParameters<double>& effects,
                      double bias_interval_s);

}  // namespace fathom
