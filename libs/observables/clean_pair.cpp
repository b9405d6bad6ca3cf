#include "observables/clean_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/error.h"
#include "core/text.h"
#include "fiducials/single_marker_pose.h"
#include "image_files/image_file.h"
#include "imaging/camera_geometry.h"
#include "imaging/eight_bits.h"
#include "imaging/true_panel.h"
#include "render/scene.h"
#include "simulation/simulate_recording.h"

namespace fathom {
namespace {

/// Checked; with a camera of 8 bits, which is what pairs have.
KnownWorld usable(KnownWorld world) {
  if (!world.vehicle.camera || world.panels.empty())
    throw std::invalid_argument("pairs need a camera and a panel");
  world.vehicle.camera->bits = 8;
  return world;
}

CameraWorld worldOf(const KnownWorld& world) {
  CameraWorld seen{world.panels, {}, world.environment};
  if (const auto& floor = world.sea_floor)
    seen.sea_floor_odom = seaFloorBelow(world.panels, floor->z_m, sandOf(floor->sand_seed));
  return seen;
}

/// Root mean square distance of a detection's corners from where the pose puts the marker's; infinite behind
/// the camera.
double offset_px(const Detection& detection, const std::array<Vector3d, 4>& corners_camera,
                 const CameraProjector<double>& projector) {
  double squares = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (corners_camera[k].z() <= 0) return std::numeric_limits<double>::infinity();
    squares += (projector.project(corners_camera[k]) - detection.corners_px[k]).squaredNorm();
  }
  return std::sqrt(squares / 4);
}

}  // namespace

CleanPairMaker::CleanPairMaker(KnownWorld world, double largest_offset_px)
    : recorded_bits_(world.vehicle.camera ? world.vehicle.camera->bits : 8),
      world_(usable(std::move(world))),
      largest_offset_px_(largest_offset_px),
      studio_(worldOf(world_), camera(), world_.vehicle.lamps, world_.effects) {}

cv::Mat CleanPairMaker::readRecorded(const std::filesystem::path& file, const CameraModel& taken_by) const {
  return fullScaleInEightBits(readImage(file, taken_by), recorded_bits_);
}

cv::Mat CleanPairMaker::panelMask(const PosedImage& posed, const View& view) const {
  cv::Mat mask = studio_.panelMask(posed.shot(), view);
  if (cv::countNonZero(mask) == 0)
    throw Error(posed.image.file.string(), "", "no panel is in view from where it was taken");
  return mask;
}

void CleanPairMaker::requireOwnPose(const PosedImage& posed) const {
  std::vector<double> offsets_px;
  const Pose T_camera_odom = posed.T_odom_camera().inverse();
  for (const PanelMap& panel : world_.panels) {
    const Pose T_camera_panel = T_camera_odom * truePanelPose(panel, world_.effects, posed.t_s);
    for (const Detection& detection : posed.detections)
      if (const Marker* marker = markerOf(detection, panel)) {
        auto corners = markerCorners_panel(*marker, world_.effects, posed.t_s);
        for (Vector3d& corner : corners) corner = T_camera_panel * corner;
        offsets_px.push_back(offset_px(detection, corners, posed.camera.projector));
      }
  }
  if (offsets_px.empty()) return;
  const auto middle = offsets_px.begin() + static_cast<std::ptrdiff_t>((offsets_px.size() - 1) / 2);
  std::nth_element(offsets_px.begin(), middle, offsets_px.end());
  if (*middle <= largest_offset_px_) return;
  const std::string where =
      std::isfinite(*middle) ? print("%.0f px from where it has them", *middle) : "behind the camera";
  throw Error(posed.image.file.string(), "", "the pose is not this image's: its markers lie " + where);
}

CleanPair CleanPairMaker::clean(const PosedImage& posed) const {
  CleanPair pair{inColour(readRecorded(posed.image.file, posed.image.camera)), {}, {}};
  requireOwnPose(posed);
  pair.clean = studio_.renderAlbedo(posed.shot());
  pair.panel_mask = panelMask(posed, pair.clean);
  return pair;
}

cv::Mat inColour(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace fathom
