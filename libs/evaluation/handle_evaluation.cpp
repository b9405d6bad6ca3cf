#include "evaluation/handle_evaluation.h"

#include <tbb/enumerable_thread_specific.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "core/for_each.h"
#include "evaluation/fiducial_grid.h"
#include "fiducials/panel_pose.h"

namespace fathom {
namespace {

constexpr double kElsewhere_m = 0.001;  // by which range differs where something else is seen

std::uint64_t handleStateStream(std::uint64_t number) { return std::uint64_t{3} << 32U | number; }
std::uint64_t handleNoiseStream(std::uint64_t number) { return std::uint64_t{4} << 32U | number; }

/// Intersection over union of two masks.
double overlapOf(const cv::Mat& a, const cv::Mat& b) {
  const int both = cv::countNonZero(a & b), any = cv::countNonZero(a | b);
  return any > 0 ? static_cast<double>(both) / any : 0;
}

/// A mask of the image as the front view has it.
cv::Mat turnedToFront(const cv::Mat& mask, PosedPanelImage image, const Handle& handle) {
  cv::Mat level;
  mask.convertTo(level, CV_32F, 1.0 / 255);
  cv::merge(std::vector<cv::Mat>(3, level), image.light);
  cv::Mat front;
  cv::extractChannel(frontViewOf(image, handle).light, front, 0);
  return front > 0.5;
}

std::vector<std::string> familiesOn(const PanelMap& map) {
  std::vector<std::string> families;
  for (const Marker& marker : map.markers) families.push_back(marker.family);
  return families;
}

}  // namespace

HandleViews::HandleViews(PanelMap map, const Vehicle& vehicle, const Environment& environment,
                         const HandleEvaluationOptions& options)
    : map_(atOrigin(std::move(map))),
      sheet_(cameraOf(vehicle)),
      environment_(environment),
      options_(options),
      renderer_(sheet_.model),
      model_(sheet_, environment.water) {
  if (map_.handles.empty()) throw std::invalid_argument("the panel has no handles");
}

HandleViewImage HandleViews::make(std::uint64_t number) {
  HandleViewImage made{
      .map = map_, .image_bgr = {}, .mask = {}, .view = {}, .handle = number % map_.handles.size()};
  made.view = drawView(options_.ranges, options_.seed, number);
  Random state = Random::stream(options_.seed, handleStateStream(number));
  for (Handle& handle : made.map.handles)
    handle.angle_rad = state.uniform(handle.smallest_angle_rad, handle.largest_angle_rad);

  const Vector3d& foot = made.map.handles[made.handle].position_panel;
  Pose T_panel_camera = made.view.T_panel_camera();
  T_panel_camera.position += foot;
  made.view = viewOf(T_panel_camera);
  made.view.number = number;

  const Lighting daylight{environment_.ambient.cast<float>(), {}};
  renderer_.setScene(surfaceOf(made.map));
  const View view = renderer_.render(T_panel_camera, daylight);
  PanelMap without = made.map;
  without.handles.erase(without.handles.begin() + static_cast<std::ptrdiff_t>(made.handle));
  renderer_.setScene(surfaceOf(without));
  const View bare = renderer_.render(T_panel_camera, daylight);
  made.mask = cv::abs(view.range_m - bare.range_m) > kElsewhere_m;
  made.mask |= (view.range_m < cv::Scalar(1e6)) & (bare.range_m > cv::Scalar(1e6));
  Random noise = Random::stream(options_.seed, handleNoiseStream(number));
  made.image_bgr = model_.expose(model_.light(view.radiance, view.range_m), &noise);
  return made;
}

std::vector<HandleViewResult> evaluateHandles(const PanelMap& map, const Vehicle& vehicle,
                                              const Environment& environment,
                                              const HandleEvaluationOptions& options,
                                              const std::string& name) {
  struct Worker {
    HandleViews views;
    HandleReader reader;
    std::unique_ptr<Detector> detector;
  };
  const CameraSheet& sheet = cameraOf(vehicle);
  tbb::enumerable_thread_specific<std::unique_ptr<Worker>> workers([&] {
    return std::make_unique<Worker>(Worker{
        HandleViews(map, vehicle, environment, options), HandleReader({atOrigin(map), sheet, environment}),
        makeDetector({Backend::apriltag}, familiesOn(map), map.look(), sheet.model)});
  });
  std::vector<HandleViewResult> results(options.views);
  forEachIndex(results.size(), name, [&](std::size_t number) {
    Worker& worker = *workers.local();
    HandleViewResult& result = results[number];
    const HandleViewImage made = worker.views.make(number);
    const Handle& handle = made.map.handles[made.handle];
    result.view = made.view;
    result.handle = made.handle;
    result.true_angle_rad = handle.angle_rad;
    const PanelPoseEstimate pose = solvePanelPose(worker.detector->detect(made.image_bgr), map, sheet.model);
    result.posed = pose.solved && !pose.isAmbiguous();
    if (!result.posed) {
      result.why_not = pose.solved ? "the panel's pose is ambiguous" : pose.why_not;
      return;
    }
    const PosedPanelImage image{radianceOf(made.image_bgr, sheet), sheet.model,
                                CameraProjector<double>::nominal(sheet.model), pose.T_camera_panel.pose};
    const HandleReading reading = worker.reader.read(image, made.handle);
    result.confident = reading.confident;
    result.why_not = reading.why_not;
    result.disagreement_rad = reading.disagreement_rad;
    if (reading.match.evidence != 0) {
      result.signed_error_rad = angleDifference(reading.angle_rad, handle.angle_rad, symmetryOf(handle.kind));
      result.error_rad = std::abs(result.signed_error_rad);
      result.sigma_rad = reading.sigma_rad;
      result.support = reading.match.support;
      result.evidence = reading.match.evidence;
      result.misfit = reading.match.misfit;
    }
    if (reading.edge.found) {
      result.chain_error_rad =
          std::abs(angleDifference(reading.edge.angle_rad, handle.angle_rad, reading.edge.symmetry_rad));
      result.chain_prominence = reading.edge.prominence;
    }
    if (reading.contour.found)
      result.overlap = overlapOf(reading.contour.mask, turnedToFront(made.mask, image, handle));
  });
  return results;
}

}  // namespace fathom
