#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "imaging/camera_geometry.h"
#include "imaging/image_model.h"
#include "imaging/lamps.h"

/// Synchronized pixels: what the camera read where the rendering knows place and albedo. See Algorithm 1 of
/// the paper.
namespace fathom {

/// What the light from a few pixels of one surface depends on besides where they are. Colours are linear red,
/// green, blue.
struct PatchSurface {
  double t_s = 0;                      ///< the image's stamp, since the recording's first entry
  Vector3d albedo = Vector3d::Zero();  ///< of what is there, with its shading, under full ambient light
  /// The same blurred, as forward scattering mixes it.
  Surroundings<double> albedo_around = Surroundings<double>::Zero();
  double image_radius = 0;                                                   ///< see PixelResponse
  Vector2d image_tangent = Vector2d::Zero();                                 ///< likewise
  Vector2d image_place = Vector2d::Zero(), image_spread = Vector2d::Zero();  ///< see ViewCover
  Eigen::Vector2d at_panel_m = Eigen::Vector2d::Zero();                      ///< see SceneLight
  int marker_id = -1;                      ///< whose print it is; -1: of none
  double response_gamma = 1;               ///< by which its radiance was made of the image's numbers
  Vector3d image_mean = Vector3d::Zero();  ///< radiance of all the image, as the camera read it
};

/// Along the optical axis: so far away that nothing of what is there would arrive.
inline constexpr double kOpenWater_m = 1e4;
/// What shows nothing but water rises so steeply, sine of the angle: by 5 degrees no sea floor does for long.
inline const double kOpenWaterSteepness = std::sin(radians(5));

/// A few pixels of one surface of a panel, in one image, or of open water: a black surface at kOpenWater_m.
struct ImagePatch : PatchSurface {
  enum class Surface { black, white, body, water };  ///< of a marker, the panel's body, open water

  std::size_t image = 0, eye = 0, panel = 0;
  int place = 0;  ///< number of its place among all panels' places: the same in all images
  Surface surface = Surface::body;
  double seen_share = 1;  ///< area of its place that it is of: of the most that any image shows
  Vector3d point_panel = Vector3d::Zero();  ///< its centre
  /// What varies over it has, to second order, the mean that it has over these.
  std::array<Vector3d, 4> around_panel{};
  Vector2d pixel = Vector2d::Zero();         ///< its centre
  Vector2d pixel_spread = Vector2d::Zero();  ///< of its pixels about that: standard deviations
  Vector3d radiance = Vector3d::Zero();      ///< mean, as the camera read it
  /// Of that mean. Infinite for a colour that does not count: saturated, or black up to its noise.
  Vector3d sigma = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Pose T_robot_camera;                     ///< nominal mounting of this very eye
  Vector3d scene_odom = Vector3d::Zero();  ///< where SightInScene has its origin

  /// Those that count: 0 red, 1 green, 2 blue.
  std::vector<int> colours() const {
    std::vector<int> counting;
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(sigma[c])) counting.push_back(c);
    return counting;
  }
};

/// The light where a patch is, with what effects make of it.
template <class T>
SceneLight<T> sceneLightOn(const PatchSurface& patch, const EffectParameters<T>& effects, double t_s) {
  SceneLight<T> light{patch.at_panel_m};
  applyEffects(effects, t_s, light);
  return light;
}

/// What lamps of irradiance 1 add to a patch's light: at its surface, and on the lines of sight to it.
template <class T>
struct PatchUnderLamps {
  Vector3<T> irradiance = Vector3<T>::Zero(), in_water = Vector3<T>::Zero();
};

/// Where the lamps have a patch: its places as ImagePatch::around_panel, and the way that it faces.
template <class T>
struct PatchOnRobot {
  std::array<Vector3<T>, 4> around_robot;
  Vector3<T> normal_robot;
};

template <class T>
PatchUnderLamps<T> underLamps(const PatchOnRobot<T>& patch, const std::vector<LampSheet>& lamps,
                              const Mounting<T, Camera>& mount, const Vector9<T>& water,
                              const SceneLight<T>& shining) {
  const WaterColumn<T> column{water.template head<3>(), water.template segment<3>(3)};
  PatchUnderLamps<T> light;
  const double share = 1.0 / static_cast<double>(patch.around_robot.size());
  for (const Vector3<T>& point_robot : patch.around_robot) {
    light.irradiance +=
        share * lampsOnSurface<T>(lamps, point_robot, patch.normal_robot, column.attenuation_per_m);
    const Vector3<T> way = point_robot - mount.position_robot;
    const T range_m = way.norm(), z_m = mount.R_robot_sensor.col(2).dot(way);
    const LitSight<T> sight{mount.position_robot,     way / range_m,    z_m / range_m, column,
                            water.template tail<3>(), shining.asymmetry};
    light.in_water += share * shining.scattered * lampsInWater(lamps, sight, range_m);
  }
  return light;
}

/// A patch's albedo with what its marker is covered with.
template <class T>
Vector3<T> coveredAlbedo(const PatchSurface& patch, const EffectParameters<T>& effects, double t_s) {
  MarkerCover<T> cover{patch.marker_id};
  applyEffects(effects, t_s, cover);
  const Vector3<T> print = patch.albedo.cast<T>();
  return print + cover.share * (cover.albedo - print);
}

/// The light that comes to the camera from a patch z_m and range_m away, in a water as waterParameters();
/// `under_lamps` counts as far as an effect has them shine.
template <class T>
Vector3<T> predictPatchLight(const PatchSurface& patch, const T& z_m, const T& range_m,
                             const SceneLight<T>& shining, const PatchUnderLamps<T>& under_lamps,
                             const Vector9<T>& water, const EffectParameters<T>& effects, double t_s,
                             const SightInScene<T>& sight) {
  const WaterColumn<T> column{water.template head<3>(), water.template segment<3>(3)};
  const Vector3<T> irradiance =
      shining.daylight * water.template tail<3>() + shining.lamps * under_lamps.irradiance;
  const SceneRadiance<T> scene(irradiance.asDiagonal() * coveredAlbedo(patch, effects, t_s),
                               irradiance.asDiagonal() * patch.albedo_around.cast<T>());
  return predictLight<T>(scene, z_m, range_m, column, effects, t_s, sight) +
         shining.lamps * under_lamps.in_water;
}

/// The radiance that the camera's numbers then stand for, by its data sheet; `gain` of all colours.
template <class T>
Vector3<T> predictPatchReading(const Vector3<T>& light, const PatchSurface& patch,
                               const EffectParameters<T>& effects, double t_s, const T& gain = T(1)) {
  using std::pow;
  PixelResponse<T> response{T(patch.image_radius), patch.image_tangent, Vector3<T>::Constant(gain)};
  ResponseCurve<T> curve{T(patch.response_gamma)};
  applyEffects(effects, t_s, response);
  applyEffects(effects, t_s, curve);
  StrayLight<T> stray;
  applyEffects(effects, t_s, stray);
  ViewCover<T> cover{patch.image_place, patch.image_spread};
  applyEffects(effects, t_s, cover);
  Vector3<T> reading;
  for (int c = 0; c < 3; ++c) {
    const T let_in = light[c] + cover.share * (cover.radiance - light[c]);
    reading[c] = predictReading(T(let_in + stray.share * (patch.image_mean[c] - let_in)), response, curve, c);
  }
  if (patch.response_gamma != 1)
    for (int c = 0; c < 3; ++c) reading[c] = pow(reading[c], 1 / patch.response_gamma);
  return reading;
}

/// What a patch should read. `state` is the robot's motion at t_s + validityOffset<Camera>(), `panel`
/// its panel's nominal pose, `lamps` the vehicle's, `water` as waterParameters(). Which pixels it is stays as
/// it was: those of its own panel's point.
template <class T>
Vector3<T> predictPatch(const KinematicState<T>& state, PanelPlacement<T> panel, const ImagePatch& patch,
                        const std::vector<LampSheet>& lamps, const Vector9<T>& water,
                        const EffectParameters<T>& effects, double t_s) {
  const auto mount = cameraMounting(patch.T_robot_camera, effects, t_s);
  applyEffects(effects, t_s, panel);
  const Matrix3<T> R_robot_panel = state.R_odom_robot.transpose() * panel.R_odom_panel;
  const Vector3<T> panel_robot = state.R_odom_robot.transpose() * (panel.position_odom - state.position_odom);
  const Vector3<T> from_camera_robot =
      panel_robot + R_robot_panel * patch.point_panel.cast<T>() - mount.position_robot;
  const T z_m = mount.R_robot_sensor.col(2).dot(from_camera_robot), range_m = from_camera_robot.norm();

  const SceneLight<T> shining = sceneLightOn<T>(patch, effects, t_s);
  PatchUnderLamps<T> under_lamps;
  if (effects.isActive(kEffectIndex<Lamp>, t_s)) {  // be it 0: its derivative is not
    PatchOnRobot<T> place{{}, R_robot_panel.col(2)};
    for (std::size_t i = 0; i < place.around_robot.size(); ++i)
      place.around_robot[i] = panel_robot + R_robot_panel * patch.around_panel[i].template cast<T>();
    under_lamps = underLamps<T>(place, lamps, mount, water, shining);
  }
  const SightInScene<T> sight{
      state.position_odom + state.R_odom_robot * mount.position_robot - patch.scene_odom.template cast<T>(),
      state.R_odom_robot * (from_camera_robot / range_m)};
  const Vector3<T> light =
      predictPatchLight<T>(patch, z_m, range_m, shining, under_lamps, water, effects, t_s, sight);
  return predictPatchReading<T>(light, patch, effects, t_s);
}

// Without derivatives: compiled once, in image_patch.cpp.
extern template Vector3<double> predictPatchLight(const PatchSurface&, const double&, const double&,
                                                  const SceneLight<double>&, const PatchUnderLamps<double>&,
                                                  const Vector9<double>&, const EffectParameters<double>&,
                                                  double, const SightInScene<double>&);
extern template Vector3<double> predictPatch(const KinematicState<double>&, PanelPlacement<double>,
                                             const ImagePatch&, const std::vector<LampSheet>&,
                                             const Vector9<double>&, const EffectParameters<double>&, double);

}  // namespace fathom
