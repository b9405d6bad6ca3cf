#include "diagnosis/manoeuvre.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "diagnosis/screening.h"
#include "effects/drawn.h"
#include "sensors/camera_geometry.h"

namespace fathom {
namespace {

constexpr double kDuration_s = 60;
constexpr double kImageInterval_s = 1;

double wave(double t_s, double period_s) { return std::sin(2 * std::numbers::pi * t_s / period_s); }
/// Begins and ends at rest.
double eased(double t_s) { return std::min({1.0, t_s / 5, (kDuration_s - t_s) / 5}); }

Pose shifted(double x_m, double y_m, double z_m) { return {Matrix3d::Identity(), {x_m, y_m, z_m}}; }
Pose turned(double yaw_rad, double pitch_rad, double roll_rad) {
  return {rotationFromYawPitchRoll(yaw_rad, pitch_rad, roll_rad), Vector3d::Zero()};
}

/// The pose from which most markers were seen, else the path's beginning.
Pose stationOf(const BatchData& data, const PosePath& path) {
  std::map<double, int> seen;
  for (const BatchMarker& marker : data.markers) ++seen[marker.t_s];
  const auto most = std::max_element(seen.begin(), seen.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const double t_s = most == seen.end() ? data.first_s : most->first;
  // A level robot of that heading: nobody holds station tilted.
  const Pose pose = motionOf(path, path.nodeAt(t_s)).T_odom_robot;
  const Vector3d forward = pose.rotation.col(0);
  return {rotationFromYawPitchRoll(std::atan2(forward.y(), forward.x()), 0, 0), pose.position};
}

/// The readings of a minute of a manoeuvre by the sensors that the recording has. Their values do not matter
/// but for where the markers are in the picture.
BatchData readingsOf(const BatchData& recording, const std::vector<double>& times_s,
                     const std::vector<Pose>& poses) {
  BatchData data;
  data.vehicle = recording.vehicle;
  data.panels = recording.panels;
  data.knot_s = recording.knot_s;
  data.first_s = times_s.front();
  data.last_s = times_s.back();
  const auto ins = [&](const std::vector<InsBin>& of, std::size_t k) {
    InsBin bin = of.front();
    const double spread_s = 0.5 * (of.front().node_s[1] - of.front().node_s[0]);
    const double middle_s = times_s[k] + 0.5 * data.knot_s;
    bin.node_s = {middle_s - spread_s, middle_s + spread_s};
    bin.about = poses[k].rotation * bin.T_robot_ins.rotation;
    return bin;
  };
  for (std::size_t k = 0; k + 1 < times_s.size(); ++k) {
    if (!recording.gyro.empty()) data.gyro.push_back(ins(recording.gyro, k));
    if (!recording.force.empty()) data.force.push_back(ins(recording.force, k));
    if (!recording.attitude.empty()) data.attitude.push_back(ins(recording.attitude, k));
    if (!recording.dvl.empty()) {
      data.dvl.push_back(recording.dvl.front());
      data.dvl.back().t_s = times_s[k];
    }
    if (!recording.pressure.empty()) {
      data.pressure.push_back(recording.pressure.front());
      data.pressure.back().t_s = times_s[k];
    }
  }
  if (recording.markers.empty()) return data;
  BatchMarker seen = recording.markers.front();
  seen.eye = 0;
  seen.T_left_right = {};
  const auto stride = static_cast<std::size_t>(std::lround(kImageInterval_s / data.knot_s));
  for (std::size_t k = 0; k < times_s.size(); k += stride, ++seen.image)
    for (seen.panel = 0; seen.panel < data.panels.size(); ++seen.panel)
      for (const Marker& marker : data.panels[seen.panel].markers) {
        seen.t_s = times_s[k];
        seen.marker = marker;
        KinematicState<double> state;
        state.position_odom = poses[k].position;
        state.R_odom_robot = poses[k].rotation;
        const Pose& T_odom_panel = data.panels[seen.panel].T_odom_panel;
        const Pose T_camera_marker =
            (poses[k] * seen.T_robot_camera).inverse() * T_odom_panel * marker.T_panel_marker;
        const bool faces = T_camera_marker.position.z() > 0.2 &&
                           T_camera_marker.rotation.col(2).dot(T_camera_marker.position) < 0;
        if (!faces) continue;
        const auto corners = predictCorners<double>(state, nominalPlacement<double>(T_odom_panel, seen.t_s),
                                                    marker, seen.camera, seen.T_robot_camera, {}, seen.t_s);
        if (!std::all_of(corners.begin(), corners.end(),
                         [&](const Vector2d& c) { return seen.camera.contains(c); }))
          continue;
        std::copy(corners.begin(), corners.end(), seen.detection.corners_px.begin());
        data.markers.push_back(seen);
      }
  return data;
}

/// What of the first effect's share of the readings the second cannot imitate.
double separation(const Reduced& reduced, Eigen::Index size, const Eigen::VectorXd& value) {
  const Eigen::Index other = reduced.gram.rows() - size;
  const Eigen::MatrixXd A = reduced.gram.topLeftCorner(size, size),
                        B = reduced.gram.topRightCorner(size, other);
  const Information information(reduced.gram.bottomRightCorner(other, other), reduced.norms.tail(other));
  return std::sqrt(std::max(0.0, value.dot((A - B * information.inverse * B.transpose()) * value)));
}

double separation(const WhitenedModel& model, const SizedEffect& first, const SizedEffect& second) {
  const auto oneWay = [&](const SizedEffect& a, const SizedEffect& b) {
    return separation(model.reduce(std::vector<Candidate>{a.candidate, b.candidate}), a.value.size(),
                      a.value);
  };
  return std::min(oneWay(first, second), oneWay(second, first));
}

/// On for good: a manoeuvre is made where and when the effect acts.
SizedEffect lasting(SizedEffect effect) {
  effect.candidate.active_s = {};
  effect.candidate.peak = {};
  if (effect.candidate.time_s) effect.candidate.time_s = 0;
  return effect;
}

WhitenedModel modelOf(const BatchData& data, const std::vector<double>& times_s,
                      const std::vector<Pose>& poses, const BatchState& recorded, const NoiseModel& noise) {
  ProblemOptions options;
  options.noise_scale = noise.noiseScale();
  options.robust_probability = 1;
  options.path_prior = PathPrior{poses.front(), 0.001, 0.001};
  BatchState state = startState(data, times_s, poses, {}, 10.0);
  if (recorded.T_odom_panel.size() == state.T_odom_panel.size()) state.T_odom_panel = recorded.T_odom_panel;
  return WhitenedModel(linearize(data, BatchProblem(data, options, state)), noise, data);
}

}  // namespace

const std::vector<Manoeuvre>& manoeuvres() {
  static const std::vector<Manoeuvre> all{
      {"hold station", [](double) { return Pose{}; }},
      {"turn on the spot, 30 degrees to either side",
       [](double t) { return turned(radians(30) * eased(t) * wave(t, 20), 0, 0); }},
      {"turn on the spot, once around",
       [](double t) { return turned(radians(360) * t / kDuration_s, 0, 0); }},
      {"run a metre ahead and back, four times",
       [](double t) { return shifted(eased(t) * wave(t, 15), 0, 0); }},
      {"sidle a metre to either side, four times",
       [](double t) { return shifted(0, eased(t) * wave(t, 15), 0); }},
      {"dive up and down by a metre, four times",
       [](double t) { return shifted(0, 0, eased(t) * wave(t, 15)); }},
      {"pitch and roll by eight degrees",
       [](double t) {
         return turned(0, radians(8) * eased(t) * wave(t, 10), radians(8) * eased(t) * wave(t, 7));
       }},
      {"start and stop sharply, ahead and to the sides",
       [](double t) { return shifted(0.25 * eased(t) * wave(t, 3), 0.25 * eased(t) * wave(t, 4), 0); }},
      {"swim a circle of three metres with the heading kept",
       [](double t) {
         const double angle = 2 * std::numbers::pi * t / 30;
         return shifted(1.5 * eased(t) * (std::cos(angle) - 1), 1.5 * eased(t) * std::sin(angle), 0);
       }},
      {"look at the panel from half and from twice the range, and from both sides", [](double t) {
         const double side_m = 0.8 * eased(t) * wave(t, 20);
         return shifted(0.8 * eased(t) * wave(t, 30), side_m, 0) * turned(-std::atan2(side_m, 3.0), 0, 0);
       }}};
  return all;
}

SizedEffect sized(const Refit& fit, const Candidate& effect) {
  std::vector<double> values;
  for (const EffectEstimate& estimate : fit.estimates)
    if (estimate.effect == effect.effect) values.push_back(sizeOf(estimate.scalar, estimate.value));
  return {effect, Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values))};
}

Advice adviseManoeuvre(const BatchData& data, const WhitenedModel& without, const BatchState& recorded,
                       const SizedEffect& first, const SizedEffect& second, const NoiseModel& noise) {
  Advice advice;
  advice.separation_now = separation(without, first, second);
  if (isDrawn(first.candidate.effect) || isDrawn(second.candidate.effect)) return advice;  // needs images
  if (!data.hasMotion()) return advice;  // nothing that could be driven
  const Pose station = stationOf(data, recorded.path);
  for (const Manoeuvre& manoeuvre : manoeuvres()) {
    std::vector<double> times_s;
    std::vector<Pose> poses;
    for (double t_s = 0; t_s <= kDuration_s + 1e-9; t_s += data.knot_s) {
      times_s.push_back(t_s);
      poses.push_back(station * manoeuvre.T_station_robot(t_s));
    }
    const BatchData readings = readingsOf(data, times_s, poses);
    const double reached =
        separation(modelOf(readings, times_s, poses, recorded, noise), lasting(first), lasting(second));
    if (reached <= advice.separation) continue;
    advice.separation = reached;
    advice.manoeuvre = manoeuvre.text;
  }
  return advice;
}

}  // namespace fathom
