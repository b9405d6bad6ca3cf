#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "estimation/batch_problem.h"

/// The batch estimate's residuals and their derivatives: what a diagnosis asks which effect is missing.
namespace fathom {

/// One residual. What is not of its kind is NaN, or -1.
struct RowInfo {
  Channel channel = kChannel<Prior>;
  int component = 0;  ///< axis x y z; colour red green blue; of a marker x0 y0 x1 y1 …; of edges the variance
                      ///< xx xy yy; of specks their class; of texture its ratio; of a prior, its row
  Instance instance{};          ///< of the instrument
  double t_s = 0;               ///< stamp
  std::size_t reading = 0;      ///< rows of one reading have this in common
  int track = -1;               ///< index in Linearization::tracks; -1: a prior
  double raw = 0;               ///< reading - prediction in the reading's unit
  double per_unit = 0;          ///< residual by raw: one over the sigma
  double robust_weight = 1;     ///< of its reading, on the squared residual: Huber's, a wide prior's
  double robust_threshold = 0;  ///< on the norm of its reading's residual; 0: none

  // The motion of the robot then.
  double speed_m_s = 0, turn_rate_rad_s = 0, depth_m = 0;
  Vector3d velocity_robot = Vector3d::Zero();
  Vector3d force_robot = Vector3d::Zero();  ///< specific force, m/s²

  std::ptrdiff_t tie_point = -1;  ///< index in BatchData::tie_points
  int tie_point_id = -1;

  std::ptrdiff_t patch = -1;  ///< index in BatchData::patches
  int place = -1;             ///< of a patch, or of the marker whose edges it is about
  double level = kNone;       ///< what it should read, share of full scale
  double reflected = kNone;   ///< what of that is daylight from its own surface
  ImagePatch::Surface surface = ImagePatch::Surface::body;
  double seen_share = 1;  ///< of its place's area (ImagePatch)

  // Of markers and patches; of tie points as the left eye sees them.
  std::ptrdiff_t marker = -1;  ///< index in BatchData::markers
  int marker_id = -1;          ///< of a corner
  int printed_on = -1;         ///< of a patch of a marker's print: that marker's id
  /// The marker that a corner or a patch is of; -1: of none.
  int markerSeen() const { return marker_id >= 0 ? marker_id : printed_on; }
  std::ptrdiff_t panel = -1, image = -1, eye = -1;
  Vector2d pixel = Vector2d::Constant(kNone);        ///< the corner, or the point
  Vector2d image_place = Vector2d::Constant(kNone);  ///< of a patch, see ViewCover
  double focal_px = 1;                               ///< of the camera
  double image_radius = kNone;  ///< its distance from the principal point over the focal length
  Vector2d point_panel = Vector2d::Constant(kNone);  ///< of a corner, patch or edges: where on the panel, m
  // Of what a patch is the mean of: standard deviations about these, each axis.
  Vector2d pixel_spread = Vector2d::Zero(), panel_spread = Vector2d::Zero();
  double range_m = kNone;        ///< of the marker's centre
  double incidence_rad = kNone;  ///< between the marker's normal and the line of sight

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

/// A continuous scalar of a registered effect.
struct EffectColumn {
  std::size_t effect = 0;  ///< in the registry
  std::size_t scalar = 0;  ///< in EffectParameters::values
  std::string name;        ///< "dvl-lever-arm.offset_m[0]"
  double prior_sigma = 0;  ///< of a normal prior with the wide one's slope at the estimate (wide_prior.h)
  bool estimated = false;  ///< its block is among the nuisances too
  bool on = false;         ///< at the estimate, so that a peak is where it is
};

/// At an estimate: residual(x, c) = residual + J x + C c to first order. Whitened: a unit of the noise each.
struct Linearization {
  std::vector<RowInfo> rows;
  Eigen::VectorXd residual;
  /// By all unknowns of the problem: poses, biases, offset, panels, estimated effects. Priors are rows.
  /// Columns are in an order that J^T J is factorized in without much fill.
  Eigen::SparseMatrix<double> J;
  /// By the same unknowns, of readings that take poses as they are and tell nothing of them: light.
  Eigen::SparseMatrix<double> taken;
  std::vector<UnknownBlock> blocks;
  std::vector<Draw> draws;  ///< what blocks of that kind are about
  /// By every continuous scalar of every registered effect, where it acts at its estimate, else at neutral.
  /// Every row takes an effect's marker_id for its own marker's, its sensor for the one that the row is of,
  /// time_s for long past and active_s for always: a candidate (effect, marker, sensor, onset) is its columns
  /// with all other rows set to zero. Where an effect with a peak is not on, every row is taken for at the
  /// peak.
  Eigen::MatrixXd C;
  std::vector<EffectColumn> columns;
  /// By the effect that knots follow (knotEffect()) where it is there for good, the path moving with it:
  /// instead of C's column, of which the path stays where it is.
  Eigen::VectorXd by_knots;
  /// Rows of one sensor's axis, or of one coordinate of one marker's corner, or one colour of
  /// one place (and eye), in time order.
  std::vector<std::vector<std::size_t>> tracks;
};

/// With effect columns, or without (C has none).
Linearization linearize(const BatchData& data, const BatchProblem& problem, bool effect_columns = true);

/// Multiplies each row of residual and derivatives.
void multiplyRows(Linearization& linear, const Eigen::VectorXd& factor);

/// Multiplies each row by the root of its robust weight: what the estimate has minimized, to first order.
void applyRobustWeights(Linearization& linear);

/// Of some channels, other robust weights instead of those that have been applied: the ones where `left` is
/// what is left of the weighted residual. Returns whether any differs by more than a percent; as it was where
/// none does.
bool applyOtherRobustWeights(Linearization& linear, const std::vector<Channel>& channels,
                             const Eigen::VectorXd& left);

/// Which column of C is an effect's scalar, counted from the effect's first. Throws std::out_of_range.
Eigen::Index columnOf(const Linearization& linear, std::size_t effect, std::size_t scalar);

/// From the first reading to the last.
Interval readingsSpan(const Linearization& linear);

}  // namespace fathom
