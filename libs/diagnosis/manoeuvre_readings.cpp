#include "diagnosis/manoeuvre_readings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "diagnosis/constants.h"
#include "imaging/camera_geometry.h"
#include "imaging/true_camera.h"

namespace fathom {
namespace {

/// What stands for a channel's measurements, at another time.
BatchReading movedTo(BatchReading reading, double begin_s, double knot_s, const Pose& pose) {
  const double spread_s = 0.5 * (reading.node_s[1] - reading.node_s[0]);
  const double middle_s = textOf(reading.channel).is_averaged ? begin_s + 0.5 * knot_s : begin_s;
  reading.node_s = {middle_s - spread_s, middle_s + spread_s};
  reading.seen.about = pose.rotation * reading.seen.T_robot_sensor.rotation;
  return reading;
}

void addNavigation(const BatchData& recording, double t_s, const Pose& pose, BatchData& data) {
  for (std::size_t i = 0; i < recording.readings.size(); ++i)
    if (!recording.readings[i].empty())
      data.readings[i].push_back(movedTo(recording.readings[i].front(), t_s, data.knot_s, pose));
}

/// One image of a manoeuvre, by a robot that holds still in it.
struct View {
  EffectParameters<double> effects;
  double t_s = 0;
  std::size_t image = 0;
  KinematicState<double> robot;
  std::optional<Vector3d> first_panel_odom;

  Pose T_odom_robot() const { return {robot.R_odom_robot, robot.position_odom}; }
};

/// The camera that takes it, port and all.
class Eye {
 public:
  Eye(const View& view, const CameraModel& nominal, const Pose& T_robot_camera)
      : camera_(trueCamera(nominal, T_robot_camera, view.robot, view.effects, view.t_s, {},
                           view.first_panel_odom)),
        T_odom_camera_(view.T_odom_robot() * camera_.T_robot_camera) {}

  const Pose& T_odom_camera() const { return T_odom_camera_; }
  /// Absent: behind it, or too near.
  std::optional<Vector2d> pixelOf(const Vector3d& point_odom) const {
    const Vector3d point = T_odom_camera_.inverse() * point_odom;
    if (point.z() < kNearest_m) return std::nullopt;
    return camera_.projector.project(point);
  }
  /// In odom, so long that it goes one along the optical axis.
  Vector3d sightAt(const Vector2d& pixel) const {
    const Vector3d direction = camera_.projector.lineOfSight(pixel).direction;
    return T_odom_camera_.rotation * (direction / direction.z());
  }

 private:
  TrueCamera camera_;
  Pose T_odom_camera_;
};

void addMarkers(const BatchData& recording, const View& view, BatchData& data) {
  if (recording.markers.empty()) return;
  BatchMarker seen = recording.markers.front();
  seen.eye = 0;
  seen.T_left_right = {};
  seen.image = view.image;
  seen.t_s = view.t_s;
  const Eye eye(view, seen.camera, seen.T_robot_camera);
  for (seen.panel = 0; seen.panel < data.panels.size(); ++seen.panel) {
    const Pose& T_odom_panel = data.panels[seen.panel].T_odom_panel;
    const Pose T_camera_panel = eye.T_odom_camera().inverse() * T_odom_panel;
    for (const Marker& marker : data.panels[seen.panel].markers) {
      const Pose T_camera_marker = T_camera_panel * marker.T_panel_marker;
      const bool faces = T_camera_marker.position.z() > kNearest_m &&
                         T_camera_marker.rotation.col(2).dot(T_camera_marker.position) < 0;
      if (!faces) continue;
      seen.marker = marker;
      seen.detection.corners_px = predictCorners<double>(
          view.robot, nominalPlacement<double>(T_odom_panel, seen.t_s, view.first_panel_odom), marker,
          seen.camera, seen.T_robot_camera, view.effects, seen.t_s);
      if (std::all_of(seen.detection.corners_px.begin(), seen.detection.corners_px.end(),
                      [&](const Vector2d& c) { return seen.camera.contains(c); }))
        data.markers.push_back(seen);
    }
  }
}

/// Puts what stands for a place into a view; false where it is not seen there.
template <class Reading>
bool moveTo(const View& view, const CameraModel& camera, const Pose& T_odom_panel, Reading& reading) {
  const auto pixel = Eye(view, camera, reading.T_robot_camera).pixelOf(T_odom_panel * reading.point_panel);
  if (!pixel || !camera.contains(*pixel)) return false;
  reading.t_s = view.t_s;
  reading.image = view.image;
  reading.pixel = *pixel;
  return true;
}

/// What is above the horizon at the same place in the picture.
bool moveWaterTo(const View& view, const CameraModel& camera, const Pose& T_odom_panel, ImagePatch& patch) {
  const Eye eye(view, camera, patch.T_robot_camera);
  const Vector3d sight_odom = eye.sightAt(patch.pixel);
  if (sight_odom.normalized().z() < kOpenWaterSteepness) return false;
  patch.t_s = view.t_s;
  patch.image = view.image;
  patch.point_panel = T_odom_panel.inverse() * (eye.T_odom_camera().position + kOpenWater_m * sight_odom);
  patch.around_panel.fill(patch.point_panel);
  return true;
}

/// One reading a place, of the left camera: the first that the recording has.
template <class Reading, class Key>
std::vector<Reading> onePerPlace(const std::vector<Reading>& readings, const Key& keyOf) {
  std::map<decltype(keyOf(readings.front())), const Reading*> first;
  for (const Reading& reading : readings)
    if (reading.eye == 0) first.emplace(keyOf(reading), &reading);
  std::vector<Reading> one;
  for (const auto& [key, reading] : first) one.push_back(*reading);
  return one;
}

/// What the recording's images tell of light, once.
struct LightPlaces {
  std::vector<ImagePatch> patches;
  std::vector<MarkerBlur> blurs;

  explicit LightPlaces(const BatchData& recording)
      : patches(onePerPlace(recording.patches,
                            [](const ImagePatch& p) { return std::tuple(p.panel, p.place, p.surface); })),
        blurs(
            onePerPlace(recording.blurs, [](const MarkerBlur& b) { return std::tuple(b.panel, b.place); })) {}
};

void addLight(const BatchData& recording, const LightPlaces& places, const View& view, BatchData& data) {
  if (recording.markers.empty()) return;
  const CameraModel& camera = recording.markers.front().camera;
  const std::size_t before = data.patches.size();
  for (ImagePatch patch : places.patches) {
    const Pose& T_odom_panel = data.panels[patch.panel].T_odom_panel;
    const bool seen = patch.surface == ImagePatch::Surface::water
                          ? moveWaterTo(view, camera, T_odom_panel, patch)
                          : moveTo(view, camera, T_odom_panel, patch);
    if (!seen) continue;
    patch.image_tangent = camera.idealAt(patch.pixel);
    patch.image_radius = patch.image_tangent.norm();
    data.patches.push_back(patch);
  }
  for (MarkerBlur blur : places.blurs)
    if (moveTo(view, camera, data.panels[blur.panel].T_odom_panel, blur)) data.blurs.push_back(blur);
  if (data.patches.size() == before) return;
  const auto addOneOf = [&](const auto& of_images, auto& all) {
    if (of_images.empty()) return;
    all.push_back(of_images.front());
    all.back().t_s = view.t_s;
    all.back().image = view.image;
  };
  addOneOf(recording.specks, data.specks);
  addOneOf(recording.textures, data.textures);
}

}  // namespace

BatchData readingsAlong(const BatchData& recording, const std::vector<double>& times_s,
                        const std::vector<Pose>& poses, const EffectParameters<double>& effects) {
  BatchData data;
  data.vehicle = recording.vehicle;
  data.panels = recording.panels;
  data.water = recording.water;
  data.knot_s = recording.knot_s;
  data.first_s = times_s.front();
  data.last_s = times_s.back();
  for (std::size_t k = 0; k + 1 < times_s.size(); ++k) addNavigation(recording, times_s[k], poses[k], data);
  const LightPlaces places(recording);
  const auto stride = static_cast<std::size_t>(std::lround(kImageInterval_s / data.knot_s));
  View view;
  view.effects = effects;
  if (!data.panels.empty()) view.first_panel_odom = data.panels.front().T_odom_panel.position;
  for (std::size_t k = 0; k < times_s.size(); k += stride, ++view.image) {
    view.t_s = times_s[k];
    view.robot.position_odom = poses[k].position;
    view.robot.R_odom_robot = poses[k].rotation;
    addMarkers(recording, view, data);
    addLight(recording, places, view, data);
  }
  return data;
}

}  // namespace fathom
