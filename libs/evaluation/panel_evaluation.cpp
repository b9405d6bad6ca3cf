#include "evaluation/panel_evaluation.h"

#include <tbb/enumerable_thread_specific.h>

#include <functional>
#include <stdexcept>

#include "core/for_each.h"
#include "core/linear_algebra.h"
#include "fiducials/single_marker_pose.h"
#include "image_files/jpeg.h"

namespace fathom {
namespace {

constexpr double kFlipped_rad = radians(30), kDistinctMirror_rad = radians(10);
constexpr double kRangeBin_m = 0.5, kTiltBin_rad = radians(15);

Vector6d errorOf(const Pose& estimate, const Pose& truth) {
  Vector6d error;
  error << truth.position - estimate.position, logSO3<double>(estimate.rotation.transpose() * truth.rotation);
  return error;
}

std::unique_ptr<Detector> detectorFor(const PanelMap& map, const CameraModel& camera,
                                      const PanelEvaluationOptions& options) {
  std::vector<std::string> families, readable;
  for (const Marker& marker : map.markers) {
    families.push_back(marker.family);
    if (canRead(fallbackOf(options.backend), marker.family, marker.look)) readable.push_back(marker.family);
  }
  DetectorOptions detector;
  detector.camera = camera;
  detector.preprocess = options.preprocess;
  detector.look = map.look();
  auto first = makeDetector(options.backend, families, detector);
  if (!options.fallback || readable.empty()) return first;
  return std::make_unique<FallbackDetector>(
      std::move(first), makeDetector(fallbackOf(options.backend), readable, detector), map.markers.size());
}

/// Means by which the methods compare: over the views in which both have a pose.
void compare(const std::vector<const PanelViewResult*>& results, PanelSummary& summary) {
  using Method = PanelPoseError PanelViewResult::*;
  const auto summarize = [&](Method method, double PanelPoseError::*measure) {
    std::vector<double> errors;
    for (const PanelViewResult* result : results)
      if (result->averaged.exists() && result->joint.exists()) errors.push_back(result->*method.*measure);
    return summaryOf(std::move(errors));
  };
  const auto fill = [&](Method method, MethodSummary& target) {
    target.position_m = summarize(method, &PanelPoseError::position_m);
    target.angle_rad = summarize(method, &PanelPoseError::angle_rad);
    for (const PanelViewResult* result : results) {
      target.no_pose += (result->*method).exists() ? 0 : 1;
      target.flipped += (result->*method).flipped ? 1 : 0;
    }
  };
  fill(&PanelViewResult::averaged, summary.averaged);
  fill(&PanelViewResult::joint, summary.joint);
  summary.position_ratio = summary.averaged.position_m.mean / summary.joint.position_m.mean;
  summary.angle_ratio = summary.averaged.angle_rad.mean / summary.joint.angle_rad.mean;
}

std::vector<BinSummary> inBins(const std::vector<PanelViewResult>& results, const std::vector<Bin>& bins,
                               double CameraView::*quantity) {
  std::vector<BinSummary> summaries;
  for (const Bin& bin : bins) {
    std::vector<const PanelViewResult*> inside;
    for (const PanelViewResult& result : results)
      if (bin.contains(result.view.*quantity)) inside.push_back(&result);
    summaries.push_back({bin, summaryOf(inside)});
  }
  return summaries;
}

}  // namespace

bool isFlipped(const Pose& estimate, const Pose& truth) {
  const double off = angleBetween(estimate.rotation, truth.rotation);
  const Pose mirrored = mirrorImage(truth, Vector3d::Zero());
  return off > kFlipped_rad || (angleBetween(mirrored.rotation, truth.rotation) > kDistinctMirror_rad &&
                                angleBetween(estimate.rotation, mirrored.rotation) < off);
}

PanelPoseError panelPoseError(const Pose& estimate, const Pose& truth) {
  return {(estimate.position - truth.position).norm(), angleBetween(estimate.rotation, truth.rotation),
          isFlipped(estimate, truth)};
}

double neesOf(const UncertainPose& estimate, const Pose& truth) {
  const Vector6d error = errorOf(estimate.pose, truth);
  return normalizedSquare(estimate.covariance, error);
}

void judge(const std::vector<Detection>& detections, const PanelMap& map, const CameraModel& camera,
           const Pose& truth_T_camera_panel, PanelViewResult& result) {
  result.markers_found = static_cast<std::size_t>(std::count_if(
      detections.begin(), detections.end(), [&](const auto& d) { return markerOf(d, map) != nullptr; }));
  if (const auto averaged = meanOfMarkers(detections, map, camera))
    result.averaged = panelPoseError(*averaged, truth_T_camera_panel);
  const PanelPoseEstimate joint = solvePanelPose(detections, map, camera);
  result.why_not = joint.why_not;
  if (!joint.solved) return;
  const UncertainPose& estimate = joint.T_camera_panel;
  result.joint = panelPoseError(estimate.pose, truth_T_camera_panel);
  result.inliers = joint.inlier_count;
  result.ambiguous = joint.isAmbiguous();
  result.rms_px = joint.rms_px;
  result.sigma_scale = joint.sigma_scale;
  result.error = errorOf(estimate.pose, truth_T_camera_panel);
  result.sigma = estimate.covariance.diagonal().cwiseSqrt();
  result.nees = neesOf(estimate, truth_T_camera_panel);
}

std::vector<PanelViewResult> evaluatePanel(const PanelMap& map, const Vehicle& vehicle,
                                           const Environment& environment,
                                           const PanelEvaluationOptions& options, const std::string& name) {
  std::vector<CameraView> views(options.views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i] = drawView(options.ranges, options.seed, i);
    views[i].t_s = options.t_s;
  }
  return evaluatePanel(map, vehicle, environment, options, views, name);
}

std::vector<PanelViewResult> evaluatePanel(const PanelMap& map, const Vehicle& vehicle,
                                           const Environment& environment,
                                           const PanelEvaluationOptions& options,
                                           const std::vector<CameraView>& views, const std::string& name) {
  const ViewStudio studio(map, vehicle, environment, options.effects);
  const CameraModel& camera = vehicle.camera->model;
  tbb::enumerable_thread_specific<std::unique_ptr<Detector>> detectors(
      [&] { return detectorFor(map, camera, options); });
  std::vector<PanelViewResult> results(views.size());
  const auto evaluate = [&](std::size_t number) {
    PanelViewResult& result = results[number];
    result.view = views[number];
    const Pose T_panel_camera = result.view.T_panel_camera();
    result.markers_whole = wholeMarkers(map, camera, T_panel_camera);
    const auto detections =
        detectors.local()->detect(throughJpeg(studio.image(result.view, options.seed), options.jpeg_quality));
    judge(detections, map, camera, T_panel_camera.inverse(), result);
  };

  forEachIndex(views.size(), name, evaluate);
  return results;
}

PanelSummary summaryOf(const std::vector<const PanelViewResult*>& results) {
  PanelSummary summary;
  summary.views = results.size();
  compare(results, summary);
  std::vector<double> nees;
  for (const PanelViewResult* result : results) {
    summary.ambiguous += result->ambiguous ? 1 : 0;
    summary.flipped_unsaid += result->joint.flipped && !result->ambiguous ? 1 : 0;
    if (result->joint.exists() && !result->ambiguous) nees.push_back(result->nees);
  }
  summary.nees = summaryOf(std::move(nees));
  return summary;
}

PanelSummary summaryOf(const std::vector<PanelViewResult>& results) {
  std::vector<const PanelViewResult*> all;
  for (const PanelViewResult& result : results) all.push_back(&result);
  return summaryOf(all);
}

std::vector<BinSummary> byRange(const std::vector<PanelViewResult>& results, const ViewRanges& ranges) {
  return inBins(results, binsOf(ranges.nearest_m, ranges.farthest_m, kRangeBin_m), &CameraView::range_m);
}

std::vector<BinSummary> byTilt(const std::vector<PanelViewResult>& results, const ViewRanges& ranges) {
  return inBins(results, binsOf(ranges.smallest_tilt_rad, ranges.largest_tilt_rad, kTiltBin_rad),
                &CameraView::tilt_rad);
}

}  // namespace fathom
