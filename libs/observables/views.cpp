#include "observables/views.h"

#include <algorithm>
#include <stdexcept>

#include "effects/drawn.h"

namespace fathom {
namespace {

/// Random streams: views take their numbers as they are, their images' noise and draws these.
std::uint64_t noiseStream(std::uint64_t number) { return std::uint64_t{1} << 32U | number; }
std::uint64_t drawStream(std::uint64_t number) { return std::uint64_t{2} << 32U | number; }

constexpr double kQuietZone = 0.125;  ///< of a marker's side

void check(const ViewRanges& r) {
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!(r.nearest_m > 0 && r.farthest_m >= r.nearest_m && std::isfinite(r.farthest_m)))
    throw std::invalid_argument("ranges must be positive, the farthest not below the nearest");
  if (!within(r.smallest_tilt_rad, 0, r.largest_tilt_rad) || !within(r.largest_tilt_rad, 0, radians(89)))
    throw std::invalid_argument("tilts must be between 0 and 89 degrees, the largest not below the smallest");
  if (!within(r.largest_roll_rad, 0, radians(180)) || !within(r.largest_aim_m, 0, r.nearest_m))
    throw std::invalid_argument("roll must be between 0 and 180 degrees, the aim within the nearest range");
}

/// Views are of the panel wherever it is.
EffectParameters<double> withPanelInPlace(EffectParameters<double> effects) {
  effects.on.reset(kEffectIndex<PanelMoved>);
  return effects;
}

}  // namespace

PanelMap atOrigin(PanelMap map) {
  map.T_odom_panel = {};
  return map;
}

const CameraSheet& cameraOf(const Vehicle& vehicle) {
  if (!vehicle.camera) throw std::invalid_argument("the vehicle has no camera");
  return *vehicle.camera;
}

Pose CameraView::T_panel_camera() const {
  const Vector3d eye = range_m * Vector3d(std::sin(tilt_rad) * std::cos(azimuth_rad),
                                          std::sin(tilt_rad) * std::sin(azimuth_rad), std::cos(tilt_rad));
  const Vector3d forward = (Vector3d(aim_panel.x(), aim_panel.y(), 0) - eye).normalized();
  // The panel's y axis is never along the line of sight: that would be a tilt of 90 degrees.
  const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
  Pose upright;
  upright.rotation << right, forward.cross(right), forward;
  upright.position = eye;
  return upright * Pose{expSO3<double>({0, 0, roll_rad}), Vector3d::Zero()};
}

CameraView drawView(const ViewRanges& ranges, std::uint64_t seed, std::uint64_t number) {
  check(ranges);
  Random random = Random::stream(seed, number);
  CameraView view;
  view.number = number;
  view.range_m = random.uniform(ranges.nearest_m, ranges.farthest_m);
  view.tilt_rad = random.uniform(ranges.smallest_tilt_rad, ranges.largest_tilt_rad);
  view.azimuth_rad = random.uniform(0.0, radians(360));
  view.roll_rad = random.uniform(-ranges.largest_roll_rad, ranges.largest_roll_rad);
  view.aim_panel.x() = random.uniform(-ranges.largest_aim_m, ranges.largest_aim_m);
  view.aim_panel.y() = random.uniform(-ranges.largest_aim_m, ranges.largest_aim_m);
  return view;
}

CameraView viewOf(const Pose& T_panel_camera) {
  const Vector3d eye = T_panel_camera.position, forward = T_panel_camera.rotation.col(2);
  if (eye.z() <= 0 || forward.z() >= 0) throw std::invalid_argument("the camera does not look at the face");
  CameraView view;
  view.range_m = eye.norm();
  view.tilt_rad = std::acos(std::min(1.0, eye.z() / view.range_m));
  view.azimuth_rad = std::atan2(eye.y(), eye.x());
  view.aim_panel = (eye - eye.z() / forward.z() * forward).head<2>();
  const Matrix3d R_level_camera = view.T_panel_camera().rotation.transpose() * T_panel_camera.rotation;
  view.roll_rad = std::atan2(R_level_camera(1, 0), R_level_camera(0, 0));
  return view;
}

bool isWhole(const Marker& marker, const CameraModel& camera, const Pose& T_panel_camera) {
  return isWhole(marker, camera, CameraProjector<double>::nominal(camera), T_panel_camera);
}

bool isWhole(const Marker& marker, const CameraModel& camera, const CameraProjector<double>& projector,
             const Pose& T_panel_camera) {
  const Pose T_camera_panel = T_panel_camera.inverse();
  const Vector3d centre = marker.T_panel_marker.position;
  if (marker.T_panel_marker.rotation.col(2).dot(T_panel_camera.position - centre) <= 0) return false;
  const auto corners = marker.corners_panel();
  return std::all_of(corners.begin(), corners.end(), [&](const Vector3d& corner) {
    const Vector3d outer = T_camera_panel * (centre + (1.0 + 2.0 * kQuietZone) * (corner - centre));
    return outer.z() > 0 && camera.contains(projector.project(outer));
  });
}

std::size_t wholeMarkers(const PanelMap& map, const CameraModel& camera, const Pose& T_panel_camera) {
  return static_cast<std::size_t>(
      std::count_if(map.markers.begin(), map.markers.end(),
                    [&](const Marker& marker) { return isWhole(marker, camera, T_panel_camera); }));
}

ViewStudio::ViewStudio(const PanelMap& map, const Vehicle& vehicle, const Environment& environment,
                       const EffectParameters<double>& effects)
    : sheet_(cameraOf(vehicle)),
      effects_(withPanelInPlace(effects)),
      studio_({{atOrigin(map)}, {}, environment}, sheet_, vehicle.lamps, effects_) {}

CameraShot ViewStudio::shot(const CameraView& view) const {
  const TrueCamera camera = trueCamera(sheet_.model, sheet_.T_robot_camera, {}, effects_, view.t_s);
  return {view.T_panel_camera() * camera.T_robot_camera.inverse(), camera, view.t_s};
}

CameraShot ViewStudio::shot(const CameraView& view, std::uint64_t seed) const {
  CameraShot shot = this->shot(view);
  shot.particle_seed = Random::stream(seed, drawStream(view.number)).bits();
  shot.effects = drawnFor(effects_, shot.particle_seed, view.t_s);
  return shot;
}

cv::Mat ViewStudio::image(const CameraView& view, std::uint64_t seed) const {
  Random noise = Random::stream(seed, noiseStream(view.number));
  return studio_.image(shot(view, seed), &noise);
}

cv::Mat ViewStudio::imageWithoutNoise(const CameraView& view) const {
  return studio_.image(shot(view), nullptr);
}

}  // namespace fathom
