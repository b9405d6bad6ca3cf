#pragma once

#include <optional>
#include <string>

#include "evaluation/statistics.h"
#include "fiducials/detector.h"
#include "fiducials/panel_pose.h"
#include "observables/views.h"

/// Task T_P: how far the panel's pose is from truth, by the paper's averaging (Mueller et al. 2018) and by
/// the joint solution, on the same images and the same detected corners. Poses are T_camera_panel.
namespace fathom {

/// d(S, M) of the paper: Euclidean distance of the panel's positions and geodesic angle (Huynh 2009) of its
/// rotations; NaN where there is no pose.
struct PanelPoseError {
  double position_m = std::numeric_limits<double>::quiet_NaN();
  double angle_rad = std::numeric_limits<double>::quiet_NaN();
  bool flipped = false;  ///< see isFlipped()

  bool exists() const { return std::isfinite(position_m); }
};
PanelPoseError panelPoseError(const Pose& estimate, const Pose& truth);

/// Whether an estimate is a flipped one: more than 30 degrees off, or nearer to the mirror image of the truth
/// than to the truth where those two are more than 10 degrees apart. (Nearer ones are not told from noise.)
bool isFlipped(const Pose& estimate, const Pose& truth);

/// What came of one view.
struct PanelViewResult {
  CameraView view;
  std::size_t markers_whole = 0;  ///< in the image, see wholeMarkers()
  std::size_t markers_found = 0;  ///< of the map
  PanelPoseError averaged;        ///< the paper's, meanOfMarkers()
  PanelPoseError joint;           ///< ours, solvePanelPose()
  std::string why_not;            ///< where the joint solution has no pose
  int inliers = 0;
  bool ambiguous = false;  ///< ours said so
  double rms_px = std::numeric_limits<double>::quiet_NaN();
  double sigma_scale = std::numeric_limits<double>::quiet_NaN();
  /// Of the joint solution, true minus estimated, and what it believed; as UncertainPose has them.
  Vector6d error = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector6d sigma = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  double nees = std::numeric_limits<double>::quiet_NaN();  ///< error' covariance^-1 error, 6 is expected
};

/// Fills what concerns the poses.
void judge(const std::vector<Detection>& detections, const PanelMap& map, const CameraModel& camera,
           const Pose& truth_T_camera_panel, PanelViewResult& result);
/// error' covariance^-1 error, with the error as UncertainPose has it.
double neesOf(const UncertainPose& estimate, const Pose& truth);

struct PanelEvaluationOptions {
  std::size_t views = 1000;
  std::uint64_t seed = 1;
  ViewRanges ranges;
  Backend backend = Backend::apriltag;
  bool fallback = true;  ///< search what the backend misses with the other one, where it can read the family
  Preprocess preprocess = Preprocess::none;
  std::optional<int> jpeg_quality;  ///< of the images; absent: exact
  /// In the images, see ViewStudio; the estimators know nothing of them.
  EffectParameters<double> effects;
  double t_s = 0;  ///< when views that are drawn are taken, see CameraView
};

/// Draws views, makes their images, detects and judges, all cores at once; results in the order of the
/// views, the same on however many cores. `name` stands in the progress line.
///
/// Throws Interrupted; std::invalid_argument where the vehicle has no camera, the map no markers, the backend
/// cannot read one of its families, or ranges make no sense.
std::vector<PanelViewResult> evaluatePanel(const PanelMap& map, const Vehicle& vehicle,
                                           const Environment& environment,
                                           const PanelEvaluationOptions& options,
                                           const std::string& name = "views");
/// The same on given views; the options' number of views and ranges do not matter.
std::vector<PanelViewResult> evaluatePanel(const PanelMap& map, const Vehicle& vehicle,
                                           const Environment& environment,
                                           const PanelEvaluationOptions& options,
                                           const std::vector<CameraView>& views, const std::string& name);

struct MethodSummary {
  ErrorSummary position_m, angle_rad;  ///< over the views in which both methods have a pose
  std::size_t no_pose = 0, flipped = 0;
};

/// Of a set of views.
struct PanelSummary {
  std::size_t views = 0;
  MethodSummary averaged, joint;
  double position_ratio = std::numeric_limits<double>::quiet_NaN();  ///< averaged's mean by joint's
  double angle_ratio = std::numeric_limits<double>::quiet_NaN();
  std::size_t ambiguous = 0;       ///< said so by the joint solution
  std::size_t flipped_unsaid = 0;  ///< flipped poses of the joint solution that it did not call ambiguous
  ErrorSummary nees;               ///< of poses not called ambiguous
};
PanelSummary summaryOf(const std::vector<const PanelViewResult*>& results);
PanelSummary summaryOf(const std::vector<PanelViewResult>& results);

struct BinSummary {
  Bin bin;
  PanelSummary summary;
};
std::vector<BinSummary> byRange(const std::vector<PanelViewResult>& results, const ViewRanges& ranges);  // m
std::vector<BinSummary> byTilt(const std::vector<PanelViewResult>& results, const ViewRanges& ranges);  // rad

}  // namespace fathom
