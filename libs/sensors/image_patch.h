#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "sensors/camera_geometry.h"
#include "sensors/image_model.h"

/// Synchronized pixels: what the camera read where the rendering knows place and albedo. See Algorithm 1 of
/// the paper.
namespace fathom {

/// A few pixels of one surface of a panel, in one image. Colours are linear red, green, blue.
struct ImagePatch {
  enum class Surface { black, white, body };  ///< of a marker, or the panel's body

  double t_s = 0;  ///< the image's stamp, since the recording's first entry
  std::size_t image = 0, eye = 0, panel = 0;
  int place = 0;  ///< number of its place among all panels' places: the same in all images
  Surface surface = Surface::body;
  Vector3d point_panel = Vector3d::Zero();  ///< its centre
  Vector3d albedo = Vector3d::Zero();       ///< of what is there, with its shading, under full ambient light
  Vector2d pixel = Vector2d::Zero();        ///< its centre
  double image_radius = 0;                  ///< see PixelResponse
  double response_gamma = 1;                ///< by which its radiance was made of the image's numbers
  Vector3d radiance = Vector3d::Zero();     ///< mean, as the camera read it
  /// Of that mean. Infinite for a colour that does not count: saturated, or black up to its noise.
  Vector3d sigma = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Pose T_robot_camera;  ///< nominal mounting of this very eye

  /// Those that count: 0 red, 1 green, 2 blue.
  std::vector<int> colours() const {
    std::vector<int> counting;
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(sigma[c])) counting.push_back(c);
    return counting;
  }
};

/// What a patch should read. `state` is the robot's motion at t_s + validityOffset<Sensor::camera>(), `panel`
/// its panel's nominal pose, `water` as waterParameters(). Which pixels it is stays as it was: those of its
/// own panel's point.
template <class T>
Vector3<T> predictPatch(const KinematicState<T>& state, PanelPlacement<T> panel, const ImagePatch& patch,
                        const Vector9<T>& water, const EffectParameters<T>& effects, double t_s) {
  using std::pow;
  const auto mount = cameraMounting(patch.T_robot_camera, effects, t_s);
  applyEffects(effects, t_s, panel);
  const Vector3<T> point_odom = panel.position_odom + panel.R_odom_panel * patch.point_panel.cast<T>();
  const Vector3<T> camera_odom = state.position_odom + state.R_odom_robot * mount.position_robot;
  const Vector3<T> point_camera =
      (state.R_odom_robot * mount.R_robot_sensor).transpose() * (point_odom - camera_odom);

  const Vector3<T> scene = patch.albedo.cast<T>().cwiseProduct(water.template tail<3>());
  const WaterColumn<T> column{water.template head<3>(), water.template segment<3>(3)};
  const Vector3<T> light =
      predictLight<T>(scene, point_camera.z(), point_camera.norm(), column, effects, t_s);
  PixelResponse<T> response{T(patch.image_radius), T(1), T(patch.response_gamma), T(0)};
  applyEffects(effects, t_s, response);
  Vector3<T> reading;
  for (int c = 0; c < 3; ++c) reading[c] = predictReading(light[c], response);
  if (patch.response_gamma != 1)
    for (int c = 0; c < 3; ++c) reading[c] = pow(reading[c], 1 / patch.response_gamma);
  return reading;
}

}  // namespace fathom
