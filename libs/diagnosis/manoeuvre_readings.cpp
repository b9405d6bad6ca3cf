#include "diagnosis/manoeuvre_readings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "imaging/camera_geometry.h"

namespace fathom {
namespace {

constexpr double kImageInterval_s = 1;
constexpr double kNearest_m = 0.2;  // nothing nearer is recognized

InsBin binAt(InsBin bin, double begin_s, double knot_s, const Pose& pose) {
  const double spread_s = 0.5 * (bin.node_s[1] - bin.node_s[0]), middle_s = begin_s + 0.5 * knot_s;
  bin.node_s = {middle_s - spread_s, middle_s + spread_s};
  bin.about = pose.rotation * bin.T_robot_ins.rotation;
  return bin;
}

void addNavigation(const BatchData& recording, double t_s, const Pose& pose, BatchData& data) {
  const auto addBin = [&](const std::vector<InsBin>& from, std::vector<InsBin>& to) {
    if (!from.empty()) to.push_back(binAt(from.front(), t_s, data.knot_s, pose));
  };
  addBin(recording.gyro, data.gyro);
  addBin(recording.force, data.force);
  addBin(recording.attitude, data.attitude);
  const auto addAt = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.push_back(from.front());
    to.back().t_s = t_s;
  };
  addAt(recording.dvl, data.dvl);
  addAt(recording.pressure, data.pressure);
  addAt(recording.usbl, data.usbl);
}

/// One image of a manoeuvre.
struct View {
  double t_s = 0;
  std::size_t image = 0;
  Pose T_odom_robot;
};

void addMarkers(const BatchData& recording, const View& view, BatchData& data) {
  if (recording.markers.empty()) return;
  BatchMarker seen = recording.markers.front();
  seen.eye = 0;
  seen.T_left_right = {};
  seen.image = view.image;
  seen.t_s = view.t_s;
  KinematicState<double> state;
  state.position_odom = view.T_odom_robot.position;
  state.R_odom_robot = view.T_odom_robot.rotation;
  for (seen.panel = 0; seen.panel < data.panels.size(); ++seen.panel) {
    const Pose& T_odom_panel = data.panels[seen.panel].T_odom_panel;
    const Pose T_camera_panel = (view.T_odom_robot * seen.T_robot_camera).inverse() * T_odom_panel;
    for (const Marker& marker : data.panels[seen.panel].markers) {
      const Pose T_camera_marker = T_camera_panel * marker.T_panel_marker;
      const bool faces = T_camera_marker.position.z() > kNearest_m &&
                         T_camera_marker.rotation.col(2).dot(T_camera_marker.position) < 0;
      if (!faces) continue;
      seen.marker = marker;
      seen.detection.corners_px =
          predictCorners<double>(state, nominalPlacement<double>(T_odom_panel, seen.t_s), marker, seen.camera,
                                 seen.T_robot_camera, {}, seen.t_s);
      if (std::all_of(seen.detection.corners_px.begin(), seen.detection.corners_px.end(),
                      [&](const Vector2d& c) { return seen.camera.contains(c); }))
        data.markers.push_back(seen);
    }
  }
}

/// Puts what stands for a place into a view; false where it is not seen there.
template <class Reading>
bool moveTo(const View& view, const CameraModel& camera, const Pose& T_odom_panel, Reading& reading) {
  const Pose T_camera_panel = (view.T_odom_robot * reading.T_robot_camera).inverse() * T_odom_panel;
  const Vector3d point = T_camera_panel * reading.point_panel;
  if (point.z() < kNearest_m) return false;
  reading.t_s = view.t_s;
  reading.image = view.image;
  reading.pixel = camera.project<double>(point);
  return camera.contains(reading.pixel);
}

/// What is above the horizon at the same place in the picture.
bool moveWaterTo(const View& view, const CameraModel& camera, const Pose& T_odom_panel, ImagePatch& patch) {
  const Pose T_odom_camera = view.T_odom_robot * patch.T_robot_camera;
  const Vector3d direction = camera.idealAt(patch.pixel).homogeneous();
  if ((T_odom_camera.rotation * direction).normalized().z() < kOpenWaterSteepness) return false;
  patch.t_s = view.t_s;
  patch.image = view.image;
  patch.point_panel = T_odom_panel.inverse() * (T_odom_camera * Vector3d(kOpenWater_m * direction));
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
    patch.image_radius = camera.idealAt(patch.pixel).norm();
    data.patches.push_back(patch);
  }
  for (MarkerBlur blur : places.blurs)
    if (moveTo(view, camera, data.panels[blur.panel].T_odom_panel, blur)) data.blurs.push_back(blur);
  if (recording.specks.empty() || data.patches.size() == before) return;
  ImageSpecks specks = recording.specks.front();
  specks.t_s = view.t_s;
  specks.image = view.image;
  data.specks.push_back(specks);
}

}  // namespace

BatchData readingsAlong(const BatchData& recording, const std::vector<double>& times_s,
                        const std::vector<Pose>& poses) {
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
  for (std::size_t k = 0; k < times_s.size(); k += stride, ++view.image) {
    view.t_s = times_s[k];
    view.T_odom_robot = poses[k];
    addMarkers(recording, view, data);
    addLight(recording, places, view, data);
  }
  return data;
}

}  // namespace fathom
