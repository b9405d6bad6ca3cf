#pragma once

#include <algorithm>
#include <cmath>

#include "imaging/camera_geometry.h"
#include "imaging/image_model.h"
#include "panel/panel_map.h"

/// Where a detector sees a marker's corners: on the edges between black and white as the image has them,
/// which the camera's response shifts, and whatever else lets white grow over black.
namespace fathom {

/// What a marker's edges are between: light that reaches the camera, linear, in green, which is most of what
/// a gray image shows.
struct EdgeLight {
  double response_gamma = 1;  ///< nominal
  double dark_over_bright = 0.05;
  double bright = 0.5;  ///< of the camera's full scale
};

/// Of a marker so far away along the optical axis. Without light: of the panel itself.
inline EdgeLight edgeLight(const PanelMap& panel, const Environment& environment, double z_m,
                           double response_gamma) {
  constexpr int kGreen = 1;
  const double way_m = std::max(0.0, z_m);
  const auto seen = [&](double albedo) {
    const Vector3d scene = albedo * environment.ambient;
    return predictLight<double>(scene, way_m, way_m, environment.water, {})[kGreen];
  };
  const double dark = seen(panel.black_albedo), bright = seen(panel.white_albedo);
  if (bright > dark) return {response_gamma, dark / bright, std::min(1.0, bright)};
  return {response_gamma, panel.black_albedo / panel.white_albedo};
}

/// By how many pixels white spreads over black where the numbers are a curve R of the light: a pixel on the
/// edge, of which a share f is white, has (R(d + (b - d) f) - R(d)) / (R(b) - R(d)) of the step from dark to
/// bright, and all f are as likely. Of a lens that is sharper than its pixels; 0 for a straight line.
template <class T>
T spreadOfWhite_px(const ResponseCurve<T>& curve, const EdgeLight& light) {
  using std::pow;
  constexpr int kGreen = 1;
  const double ratio = std::clamp(light.dark_over_bright, 1e-3, 0.95), bright = light.bright;
  const auto meanPower = [&](const T& exponent) {
    return T(pow(T(bright), exponent) * (1.0 - pow(T(ratio), exponent + 1.0)) /
             ((exponent + 1.0) * (1.0 - ratio)));
  };
  const T& bend = curve.bend[kGreen];
  const T mean = (1.0 + bend) * meanPower(curve.exponent) - bend * meanPower(T(2.0 * curve.exponent));
  const T dark = curved(T(ratio * bright), curve, kGreen), white = curved(T(bright), curve, kGreen);
  return (mean - dark) / (white - dark) - 0.5;
}

/// Corners of a black square whose sides have all moved inward by so much.
template <class T>
std::array<Vector2<T>, 4> shrunk(const std::array<Vector2<T>, 4>& corners, const T& by_px) {
  const Vector2<T> middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const auto inward = [&](std::size_t side) {
    const Vector2<T> along = (corners[(side + 1) % 4] - corners[side]).normalized();
    const Vector2<T> normal(-along.y(), along.x());
    return Vector2<T>(valueOf(normal.dot(middle - corners[side])) < 0 ? Vector2<T>(-normal) : normal);
  };
  std::array<Vector2<T>, 4> moved = corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector2<T> before = inward((k + 3) % 4), after = inward(k);
    const T sine = before.x() * after.y() - before.y() * after.x();
    if (std::abs(valueOf(sine)) < 0.1) continue;  // seen nearly from its side
    const Vector2<T> way((after.y() - before.y()) / sine, (before.x() - after.x()) / sine);
    moved[k] += by_px * way;
  }
  return moved;
}

/// Corners as white that spreads over black moves them.
template <class T>
std::array<Vector2<T>, 4> withWhiteSpread(const std::array<Vector2<T>, 4>& corners, const T& by_px,
                                          const std::string& family, const MarkerLook& look) {
  if (look.saddle_corners) return corners;
  return shrunk<T>(corners, isBrightSquare(family, look) ? T(-by_px) : by_px);
}

/// Whether anything can make white spread over black.
template <class T>
bool anySpreadsWhite(const EffectParameters<T>& effects) {
  return anyActsAt<ResponseCurve<double>>(effects) || anyActsAt<EdgeSpread<double>>(effects);
}

/// By how many pixels white spreads over black, with these effects, further than nominally.
template <class T>
T spreadOfWhite_px(const EdgeLight& light, const EffectParameters<T>& effects, double t_s) {
  EdgeSpread<T> edges;
  applyEffects(effects, t_s, edges);
  if (!anyActsAt<ResponseCurve<double>>(effects)) return edges.white_px;
  const ResponseCurve<T> nominal{T(light.response_gamma)};
  ResponseCurve<T> curve = nominal;
  applyEffects(effects, t_s, curve);
  return edges.white_px + spreadOfWhite_px(curve, light) - spreadOfWhite_px(nominal, light);
}

/// predictCorners(), as a detector finds them in an image in which white may spread over black.
template <class T>
std::array<Vector2<T>, 4> predictDetectedCorners(const KinematicState<T>& state,
                                                 const PanelPlacement<T>& panel, const Marker& marker,
                                                 const CameraModel& camera, const Pose& T_robot_camera,
                                                 const EdgeLight& light, const EffectParameters<T>& effects,
                                                 double t_s, const Pose& T_left_right = {}) {
  auto corners = predictCorners(state, panel, marker, camera, T_robot_camera, effects, t_s, T_left_right);
  if (!anySpreadsWhite(effects)) return corners;
  return withWhiteSpread<T>(corners, spreadOfWhite_px(light, effects, t_s), marker.family, marker.look);
}

// Without derivatives: compiled once, in detected_corners.cpp.
extern template std::array<Vector2<double>, 4> predictDetectedCorners(
    const KinematicState<double>&, const PanelPlacement<double>&, const Marker&, const CameraModel&,
    const Pose&, const EdgeLight&, const EffectParameters<double>&, double, const Pose&);

}  // namespace fathom
