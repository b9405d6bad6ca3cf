#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>

#include "core/camera_model.h"
#include "core/kinematics.h"
#include "effects/registry.h"
#include "imaging/dome_port.h"
#include "imaging/flat_port.h"
#include "imaging/water_surface.h"
#include "panel/panel_map.h"
#include "sensors/inputs.h"

/// The forward model of where a camera sees things: robot's motion and panel -> a marker corner's pixel, the
/// nominal equation first, then the effects that are on. Simulator, filter, fits and diagnosis share it.
namespace fathom {

/// Maps points in the camera's frame to pixels, as the camera truly does: water, port, lens, row by row. P is
/// the scalar of its own parameters; points may be of another one that P converts to, e.g. Jets in a pose
/// beside plain parameters.
///
/// With a rolling shutter, points are those at the time of validity, which is the first row's, and the camera
/// moves on at `velocity` and `angular_velocity` while the other rows are read.
template <class P>
struct CameraProjector {
  Intrinsics<P> lens;
  FlatPort<P>
      port;  ///< no camera has this and a dome: beside one, what it sees is taken to be before the other
  DomePort<P> dome;
  SurfaceBelow<P> surface;  ///< before either, as far as light comes through it
  Shutter<P> shutter;
  double height_px = 1;                                     ///< rows that are read
  Vector3<P> velocity_camera = Vector3<P>::Zero();          ///< of the camera, over ground, m/s
  Vector3<P> angular_velocity_camera = Vector3<P>::Zero();  ///< rad/s

  /// Ideal image coordinates (x/z, y/z) that a pinhole without distortion would see at this pixel's place.
  template <class T>
  Vector2<T> ideal(const Vector3<T>& point_camera) const;

  /// The pixel of a point before the camera (z > 0).
  template <class T>
  Vector2<T> project(const Vector3<T>& point_camera) const {
    return pixelAt(ideal(point_camera));
  }

  /// The line on which lies what is seen at a pixel, camera frame: below the water's surface, where it meets
  /// one; all rows are read at once.
  SightLine<P> lineOfSight(const Vector2d& pixel) const;

  /// Pinhole and lens alone, in an image of the nominal camera's size.
  CameraModel lensModel(const CameraModel& nominal) const {
    const Intrinsics<double> l = valuesOf(lens);
    return {nominal.width_px,
            nominal.height_px,
            l.fx_px,
            l.fy_px,
            l.cx_px,
            l.cy_px,
            l.k1,
            l.k2,
            l.p1,
            l.p2,
            l.k3,
            {},
            l.k4,
            l.k5,
            l.k6,
            l.lens,
            nominal.bayer};
  }

  /// Without derivatives.
  CameraProjector<double> values() const {
    if constexpr (std::is_same_v<P, double>) {
      return *this;
    } else {
      const auto vector = [](const Vector3<P>& v) {
        return Vector3d(valueOf(v.x()), valueOf(v.y()), valueOf(v.z()));
      };
      CameraProjector<double> plain;
      plain.lens = valuesOf(lens);
      plain.port = {port.present,
                    valueOf(port.distance_m),
                    valueOf(port.glass_m),
                    valueOf(port.tilt_x_rad),
                    valueOf(port.tilt_y_rad),
                    valueOf(port.index_error),
                    valueOf(port.slab_m),
                    valueOf(port.calibration_per_m),
                    valueOf(port.window_m)};
      plain.dome = detail::plain(dome);
      plain.surface = surface.values();
      plain.shutter = {shutter.rolling, valueOf(shutter.readout_s)};
      plain.height_px = height_px;
      plain.velocity_camera = vector(velocity_camera);
      plain.angular_velocity_camera = vector(angular_velocity_camera);
      return plain;
    }
  }

  /// A camera without effects.
  static CameraProjector nominal(const CameraModel& camera) {
    CameraProjector projector;
    projector.lens = {P(camera.fx_px), P(camera.fy_px), P(camera.cx_px), P(camera.cy_px), P(camera.k1),
                      P(camera.k2),    P(camera.p1),    P(camera.p2),    P(camera.k3),    P(camera.k4),
                      P(camera.k5),    P(camera.k6),    camera.lens};
    projector.height_px = camera.height_px;
    projector.port.window_m = P(camera.window.distance_m);
    projector.port.tilt_x_rad = P(camera.window.tilt_x_rad);
    projector.port.tilt_y_rad = P(camera.window.tilt_y_rad);
    return projector;
  }

 private:
  static Intrinsics<double> valuesOf(const Intrinsics<P>& l) {
    return {valueOf(l.fx_px),
            valueOf(l.fy_px),
            valueOf(l.cx_px),
            valueOf(l.cy_px),
            valueOf(l.k1),
            valueOf(l.k2),
            valueOf(l.p1),
            valueOf(l.p2),
            valueOf(l.k3),
            valueOf(l.k4),
            valueOf(l.k5),
            valueOf(l.k6),
            l.lens};
  }
  /// Below this surface.
  template <class T>
  Vector2<T> straight(const Vector3<T>& point_camera, const SurfaceBelow<T>& below) const {
    Vector3<T> d = point_camera;
    if (below.present) d = apparentPoint(below, d);
    if (dome.present) d = d.z() * apparentDirection(dome, d);
    if (port.present) d = apparentDirection(port, d);
    return {d.x() / d.z(), d.y() / d.z()};
  }

  template <class T>
  Vector2<T> pixelAt(const Vector2<T>& ideal) const {
    const Vector2<T> d = distorted(lens, ideal);
    return {T(lens.fx_px) * d.x() + T(lens.cx_px), T(lens.fy_px) * d.y() + T(lens.cy_px)};
  }

  template <class T>
  SurfaceBelow<T> surfaceAs() const {
    return surface.present ? surface.template cast<T>() : SurfaceBelow<T>{};
  }

  /// straight(), where point and surface are in the camera's frame when row `row` was read.
  template <class T>
  Vector2<T> atRow(const Vector3<T>& point_camera, const T& row) const {
    const T seconds = T(shutter.readout_s) * row / height_px;
    const Vector3<T> turned = angular_velocity_camera.template cast<T>() * seconds;
    const Vector3<T> way = velocity_camera.template cast<T>() * seconds;
    const Matrix3<T> R_camera_then = expSO3<T>(turned);
    const SurfaceBelow<T> below = surfaceAs<T>();
    return straight(Vector3<T>(R_camera_then.transpose() * (point_camera - way)),
                    below.present ? below.seenAfter(R_camera_then, way) : below);
  }
  template <class T>
  T rowSeen(const Vector3<T>& point_camera, const T& row) const {
    return pixelAt(atRow(point_camera, row)).y();
  }

  /// The same, at the row in which the point then is: row = rowSeen(row). Solved in double, then one Newton
  /// step in T. What is far out of the image gets a row not far from it.
  template <class T>
  Vector2<T> atItsRow(const Vector3<T>& point_camera) const {
    const auto sought =
        values().rowOf({valueOf(point_camera.x()), valueOf(point_camera.y()), valueOf(point_camera.z())});
    if (!sought.slope) return atRow(point_camera, T(sought.row));
    return atRow(point_camera,
                 T(sought.row + (rowSeen(point_camera, T(sought.row)) - sought.row) / (1.0 - *sought.slope)));
  }
  struct RowSought {
    double row = 0;
    std::optional<double> slope;  ///< of rowSeen() there; nothing where Newton's method came to no end
  };
  /// Only of a camera without derivatives.
  RowSought rowOf(const Vector3d& point_camera) const;

  template <class Other>
  friend struct CameraProjector;
};

template <class P>
template <class T>
Vector2<T> CameraProjector<P>::ideal(const Vector3<T>& point_camera) const {
  return shutter.rolling ? atItsRow(point_camera) : straight(point_camera, surfaceAs<T>());
}

template <class P>
SightLine<P> CameraProjector<P>::lineOfSight(const Vector2d& pixel) const {
  // Solved in double, then one Newton step in P.
  using Slope = ceres::Jet<double, 2>;
  const Vector2d root = values().lensModel({}).idealAt(pixel);
  const Vector2<Slope> slope = values().pixelAt(Vector2<Slope>(Slope(root.x(), 0), Slope(root.y(), 1)));
  Eigen::Matrix2d J;
  J << slope.x().v.transpose(), slope.y().v.transpose();
  const Vector2<P> miss = pixelAt(Vector2<P>(root.cast<P>())) - pixel.cast<P>();
  const Vector2<P> ideal = root.cast<P>() - J.inverse().cast<P>() * miss;
  const Vector3<P> sight(ideal.x(), ideal.y(), P(1));
  SightLine<P> line{Vector3<P>::Zero(), sight.normalized()};
  if (port.present)
    line = lightBehind(port, sight);
  else if (dome.present)
    line = lightBehind(dome, sight);
  return surface.present ? lightBelow(surface, line) : line;
}

template <>
CameraProjector<double>::RowSought CameraProjector<double>::rowOf(const Vector3d& point_camera) const;

/// The camera of an image stamped t_s. It stands still: give it its motion by movingWith() where the shutter
/// rolls.
template <class T>
CameraProjector<T> cameraProjector(const CameraModel& nominal, const EffectParameters<T>& effects,
                                   double t_s) {
  auto projector = CameraProjector<T>::nominal(nominal);
  applyEffects(effects, t_s, projector.lens);
  applyEffects(effects, t_s, projector.port);
  applyEffects(effects, t_s, projector.dome);
  applyEffects(effects, t_s, projector.shutter);
  return projector;
}

/// Where the camera sits: T_robot_camera with what effects make of it. Of a pair's right camera, nominal is
/// the left one's and T_left_right is taken as exact.
template <class T>
Mounting<T, Camera> cameraMounting(const Pose& nominal, const EffectParameters<T>& effects, double t_s,
                                   const Pose& T_left_right = {}) {
  auto mount = mountingOf<Camera>(nominal, effects, t_s);
  mount.position_robot += mount.R_robot_sensor * T_left_right.position.template cast<T>();
  mount.R_robot_sensor = mount.R_robot_sensor * T_left_right.rotation.template cast<T>();
  return mount;
}

/// The same projector on a robot that moves.
template <class T>
CameraProjector<T> movingWith(const KinematicState<T>& state, const Mounting<T, Camera>& mount,
                              CameraProjector<T> projector) {
  const Matrix3<T> R_camera_robot = mount.R_robot_sensor.transpose();
  projector.angular_velocity_camera = R_camera_robot * state.angular_velocity_robot;
  projector.velocity_camera =
      R_camera_robot * (state.velocity_robot + state.angular_velocity_robot.cross(mount.position_robot));
  return projector;
}

/// The water's surface as effects have it, below a camera there (CameraModel::above_water).
/// `first_panel_odom`: see PanelPlacement.
template <class T>
SurfaceBelow<T> surfaceBelow(const KinematicState<T>& state, const Mounting<T, Camera>& mount,
                             const EffectParameters<T>& effects, double t_s,
                             const Vector3d& first_panel_odom) {
  WaterSurface<T> surface;
  applyEffects(effects, t_s, surface);
  if (!surface.present) return {};
  return seenFrom<T>(surface, Matrix3<T>(state.R_odom_robot * mount.R_robot_sensor),
                     Vector3<T>(state.position_odom + state.R_odom_robot * mount.position_robot -
                                first_panel_odom.cast<T>()));
}

/// The panel as the map has it, for an image stamped t_s; for a fit to move. `first_panel_odom`: see
/// PanelPlacement; nothing: it is the first one.
template <class T>
PanelPlacement<T> nominalPlacement(const Pose& T_odom_panel, double t_s,
                                   const std::optional<Vector3d>& first_panel_odom = {}) {
  return {t_s, T_odom_panel.position.cast<T>(), T_odom_panel.rotation.cast<T>(),
          first_panel_odom.value_or(T_odom_panel.position)};
}

/// A marker as it truly is on its panel.
template <class T>
MarkerPlacement<T> markerPlacement(const Marker& nominal, const EffectParameters<T>& effects, double t_s) {
  const Pose& pose = nominal.T_panel_marker;
  MarkerPlacement<T> marker{nominal.id, T(nominal.size_m), pose.position.cast<T>(), pose.rotation.cast<T>()};
  applyEffects(effects, t_s, marker);
  return marker;
}

/// Corners of a marker as it truly is, in the order of Marker::corners_panel(), panel frame.
template <class T>
std::array<Vector3<T>, 4> markerCorners_panel(const Marker& nominal, const EffectParameters<T>& effects,
                                              double t_s) {
  const MarkerPlacement<T> marker = markerPlacement(nominal, effects, t_s);
  FaceShape<T> shape;
  applyEffects(effects, t_s, shape);
  const T half_m = 0.5 * marker.size_m;
  std::array<Vector3<T>, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const double right = kMarkerCorners[k][0], up = kMarkerCorners[k][1];
    corners[k] = shape.moved(
        marker.position_panel + marker.R_panel_marker * Vector3<T>(half_m * right, half_m * up, T(0)),
        nominal.panel_half_m);
  }
  return corners;
}

/// The camera's forward model: pixels of a marker's four corners in an image stamped t_s, in the order of
/// Detection::corners_px. `state` is the robot's motion at t_s + validityOffset<Camera>(), `panel`
/// the panel's nominal pose, see nominalPlacement(). A corner behind the camera gives pixels without meaning.
template <class T>
std::array<Vector2<T>, 4> predictCorners(const KinematicState<T>& state, PanelPlacement<T> panel,
                                         const Marker& marker, const CameraModel& camera,
                                         const Pose& T_robot_camera, const EffectParameters<T>& effects,
                                         double t_s, const Pose& T_left_right = {}) {
  const auto mount = cameraMounting(T_robot_camera, effects, t_s, T_left_right);
  auto projector = movingWith(state, mount, cameraProjector(camera, effects, t_s));
  if (camera.above_water) projector.surface = surfaceBelow(state, mount, effects, t_s, panel.first_odom);
  applyEffects(effects, t_s, panel);
  const Matrix3<T> R_camera_odom = (state.R_odom_robot * mount.R_robot_sensor).transpose();
  const Vector3<T> camera_odom = state.position_odom + state.R_odom_robot * mount.position_robot;
  std::array<Vector2<T>, 4> pixels;
  const auto corners = markerCorners_panel(marker, effects, t_s);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3<T> corner_odom = panel.position_odom + panel.R_odom_panel * corners[k];
    pixels[k] = projector.project(Vector3<T>(R_camera_odom * (corner_odom - camera_odom)));
  }
  return pixels;
}

// Without derivatives: compiled once, in camera_geometry.cpp.
extern template Vector2<double> CameraProjector<double>::ideal(const Vector3<double>&) const;
extern template SightLine<double> CameraProjector<double>::lineOfSight(const Vector2d&) const;
extern template std::array<Vector2<double>, 4> predictCorners(const KinematicState<double>&,
                                                              PanelPlacement<double>, const Marker&,
                                                              const CameraModel&, const Pose&,
                                                              const EffectParameters<double>&, double,
                                                              const Pose&);

}  // namespace fathom
