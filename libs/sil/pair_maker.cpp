#include "sil/pair_maker.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/error.h"
#include "core/text.h"
#include "fiducials/image_file.h"
#include "fiducials/single_marker_pose.h"
#include "render/scene.h"
#include "sensors/fingerprints.h"
#include "sensors/image_model.h"
#include "similarity/measures.h"
#include "simulation/simulate_recording.h"

namespace fathom {
namespace {

/// A panel's feet may stand in the sand, and a sea floor's points come out of floats.
constexpr double kAboveSeaFloor_m = 0.005;

/// Random streams of image k, far from those with which `simulate` made a recording: noise that a recording
/// was made with must not come out again.
std::uint64_t noiseStream(std::size_t image) { return std::uint64_t{1} << 62 | image; }

Surface sceneOf(const SilWorld& world) {
  if (world.sea_floor)
    return fathom::sceneOf(world.panels, world.sea_floor->z_m, sandOf(world.sea_floor->sand_seed));
  Surface scene;
  for (const PanelMap& panel : world.panels) scene.add(surfaceOf(panel), panel.T_odom_panel);
  return scene;
}

/// Root mean square distance of a detection's corners from where the pose puts the marker's; infinite behind
/// the camera.
double offset_px(const Detection& detection, const Marker& marker, const CameraModel& camera,
                 const Pose& T_camera_panel) {
  double squares = 0;
  const auto corners_panel = marker.corners_panel();
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3d corner_camera = T_camera_panel * corners_panel[k];
    if (corner_camera.z() <= 0) return std::numeric_limits<double>::infinity();
    squares += (camera.project(corner_camera) - detection.corners_px[k]).squaredNorm();
  }
  return std::sqrt(squares / 4);
}

}  // namespace

/// What a camera's lens does, for all threads.
struct PairMaker::Optics {
  ImageModel model;
  std::vector<Eigen::Vector3f> rays_camera;  ///< of unit length, pixel by pixel

  Optics(CameraSheet sheet, const SilWorld& world, const CameraModel& camera)
      : model((sheet.model = camera, sheet), world.environment.water, world.effects) {
    for (int v = 0; v < camera.height_px; ++v)
      for (int u = 0; u < camera.width_px; ++u)
        rays_camera.emplace_back(camera.rayAt(Vector2d(u, v)).cast<float>());
  }
};

/// What one thread needs for a camera.
struct PairMaker::Tools {
  Renderer renderer;
  std::unique_ptr<Detector> detector;
  View view;
};

struct PairMaker::Threads {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<const Optics>> optics;
  tbb::enumerable_thread_specific<std::map<std::string, std::unique_ptr<Tools>>> tools;
};

PairMaker::PairMaker(SilWorld world, const PairOptions& options, DetectionSettings detection)
    : world_(std::move(world)),
      options_(options),
      detection_(std::move(detection)),
      threads_(std::make_unique<Threads>()) {
  if (!world_.vehicle.camera || world_.panels.empty())
    throw std::invalid_argument("pairs need a camera and a panel");
  world_.vehicle.camera->bits = 8;
  scene_odom_ = sceneOf(world_);
}

PairMaker::~PairMaker() = default;

const PairMaker::Optics& PairMaker::opticsOf(const CameraModel& camera) const {
  const std::scoped_lock lock(threads_->mutex);
  auto& optics = threads_->optics[fingerprintOf(camera)];
  if (!optics) optics = std::make_unique<const Optics>(this->camera(), world_, camera);
  return *optics;
}

PairMaker::Tools& PairMaker::toolsFor(const CameraModel& camera) const {
  auto& tools = threads_->tools.local()[fingerprintOf(camera)];
  if (!tools) {
    tools = std::make_unique<Tools>(Tools{Renderer(camera), detectorFor(camera, detection_), {}});
    tools->renderer.setScene(scene_odom_);
  }
  return *tools;
}

Lighting PairMaker::lighting(const Pose& T_odom_robot) const {
  Lighting light{world_.environment.ambient.cast<float>(), {}};
  if (const auto& irradiance = world_.environment.lamps_irradiance_1m)
    for (const LampSheet& lamp : world_.vehicle.lamps)
      light.spots.push_back(
          {T_odom_robot * lamp.T_robot_lamp, lamp.half_angle_rad, irradiance->cast<float>()});
  return light;
}

/// What is hit and is not the sea floor.
cv::Mat PairMaker::panelMask(const View& view, const PosedImage& posed) const {
  const auto& rays = opticsOf(posed.image.camera).rays_camera;
  const Eigen::Vector3f up_camera = posed.T_odom_camera.rotation.row(2).transpose().cast<float>();
  const double lowest_m = world_.sea_floor
                              ? world_.sea_floor->z_m + kAboveSeaFloor_m - posed.T_odom_camera.position.z()
                              : -std::numeric_limits<double>::infinity();
  cv::Mat mask(view.range_m.size(), CV_8UC1);
  for (int v = 0; v < mask.rows; ++v) {
    const auto* range_m = view.range_m.ptr<float>(v);
    const auto* ray = &rays[static_cast<std::size_t>(v) * static_cast<std::size_t>(mask.cols)];
    for (int u = 0; u < mask.cols; ++u) {
      const bool hit = std::isfinite(range_m[u]);
      const bool panel = hit && range_m[u] * up_camera.dot(ray[u]) > static_cast<float>(lowest_m);
      mask.at<std::uint8_t>(v, u) = panel ? 255 : 0;
    }
  }
  return mask;
}

void PairMaker::requireOwnPose(const PosedImage& posed) const {
  std::vector<double> offsets_px;
  for (const Detection& detection : posed.detections)
    for (const PanelMap& panel : world_.panels)
      if (const Marker* marker = markerOf(detection, panel))
        offsets_px.push_back(offset_px(detection, *marker, posed.image.camera,
                                       posed.T_odom_camera.inverse() * panel.T_odom_panel));
  if (offsets_px.empty()) return;
  const auto middle = offsets_px.begin() + static_cast<std::ptrdiff_t>((offsets_px.size() - 1) / 2);
  std::nth_element(offsets_px.begin(), middle, offsets_px.end());
  if (*middle <= options_.largest_offset_px) return;
  const std::string where =
      std::isfinite(*middle) ? print("%.0f px from where it has them", *middle) : "behind the camera";
  throw Error(posed.image.file.string(), "", "the pose is not this image's: its markers lie " + where);
}

SilPair PairMaker::make(const PosedImage& posed) const {
  const cv::Mat recorded = readImage(posed.image.file, posed.image.camera);
  requireOwnPose(posed);
  Tools& tools = toolsFor(posed.image.camera);
  tools.renderer.render(posed.T_odom_camera, lighting(posed.T_odom_robot.pose), tools.view);
  const ImageModel& model = opticsOf(posed.image.camera).model;
  Random noise = Random::stream(options_.seed, noiseStream(posed.number));

  SilPair pair;
  pair.images.camera = &camera();
  pair.images.panel_mask = panelMask(tools.view, posed);
  const int seen = cv::countNonZero(pair.images.panel_mask);
  if (seen == 0) throw Error(posed.image.file.string(), "", "no panel is in view from where it was taken");
  cv::Mat simulated =
      model.expose(model.light(tools.view.radiance, tools.view.range_m), options_.noise ? &noise : nullptr);
  if (recorded.channels() == 1) cv::cvtColor(simulated, simulated, cv::COLOR_BGR2GRAY);
  pair.images.recorded = inColour(recorded);
  pair.images.simulated = inColour(simulated);
  pair.images.recorded_detections = posed.detections;
  pair.images.simulated_detections = tools.detector->detect(simulated);
  if (const auto why = whyNotComparable(pair.images); !why.empty())
    throw Error(posed.image.file.string(), "", why);

  const Pose T_panel_camera = world_.panels.at(posed.panel).T_odom_panel.inverse() * posed.T_odom_camera;
  pair.range_m = T_panel_camera.position.norm();
  pair.view_angle_rad = std::acos(std::clamp(T_panel_camera.position.z() / pair.range_m, -1.0, 1.0));
  pair.panel_share = static_cast<double>(seen) / static_cast<double>(recorded.total());
  return pair;
}

CleanPair PairMaker::clean(const PosedImage& posed) const {
  CleanPair pair{inColour(readImage(posed.image.file, posed.image.camera)), {}, {}};
  requireOwnPose(posed);
  toolsFor(posed.image.camera).renderer.render(posed.T_odom_camera, Lighting{}, pair.clean);
  pair.panel_mask = panelMask(pair.clean, posed);
  if (cv::countNonZero(pair.panel_mask) == 0)
    throw Error(posed.image.file.string(), "", "no panel is in view from where it was taken");
  return pair;
}

ImagePair PairMaker::compared(const ImagePair& images) const {
  if (world_.sea_floor) return images;
  ImagePair result = images;
  result.recorded = images.simulated.clone();
  images.recorded.copyTo(result.recorded, images.panel_mask);
  return result;
}

cv::Mat PairMaker::comparedRegion(const ImagePair& images) const {
  if (!world_.sea_floor) return images.panel_mask;
  return {images.panel_mask.size(), CV_8UC1, cv::Scalar(255)};
}

cv::Mat inColour(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace fathom
