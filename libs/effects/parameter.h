#pragma once

#include <limits>
#include <string_view>

#include "core/geometry.h"

namespace fathom {

/// What a fit can do with a parameter.
enum class ParameterKind {
  continuous,  ///< readings depend on it smoothly: a fit may differentiate
  marker_id,   ///< a whole number, one of the panel map's ids: tried one by one
  sensor,      ///< a kind of sensors by its label, its place in kSensorKinds: tried one by one
  region,      ///< a part of the image by its name, its place in kImageRegions: tried one by one
  time,        ///< s since the recording's first entry, of a step: derivatives are zero, so searched
  peak_time,   ///< the same of a peak: searched, and then estimated. Neutral is any time
  log_width,   ///< ln of a peak's width over its usual one, likewise
  shape,       ///< of which make what is there is: estimated, but by itself it changes nothing
  spread       ///< standard deviation of what is drawn anew for each image: a fit estimates each draw
};

/// Whether readings depend on it, or on what is drawn of it, smoothly.
constexpr bool isDifferentiated(ParameterKind kind) {
  return kind != ParameterKind::marker_id && kind != ParameterKind::sensor && kind != ParameterKind::region &&
         kind != ParameterKind::time;
}
/// Whether a fit estimates it itself, where it is once known roughly.
constexpr bool isEstimated(ParameterKind kind) {
  return isDifferentiated(kind) && kind != ParameterKind::spread;
}
/// Whether it says when a peak is, and how long: how well that is known is the search's to say.
constexpr bool isPeak(ParameterKind kind) {
  return kind == ParameterKind::peak_time || kind == ParameterKind::log_width;
}
/// Whether it says how large an effect is; else only where or when it is, or of which make.
constexpr bool isSize(ParameterKind kind) {
  return kind == ParameterKind::continuous || kind == ParameterKind::spread;
}

/// One named parameter of an effect, a scalar or a list of two or three. Neutral is always zero: at zero the
/// effect changes nothing, so every effect's size is also its distance from "not there".
struct Parameter {
  std::string_view name{};  ///< with the unit as suffix, e.g. "offset_m"
  std::string_view unit{};  ///< "1", "m", "deg", "s", …
  int size = 1;             ///< 1, or 2 for x y, 3 for x y z
  /// How large an engineer would expect it, same unit: keeps near-aliases apart. 0 where it is not
  /// continuous: any is as likely.
  double prior_sigma = 0;
  double limit = 0;  ///< |value| beyond this is a mistake in a calibration file, same unit
  ParameterKind kind = ParameterKind::continuous;
  bool positive = false;  ///< less than nothing is impossible: neither read nor believed
  /// Readings are linear in its square, which is what EffectParameters and prior_sigma hold; files and
  /// reports have the root, see asNamed(). Or else nothing could be told of it at zero, where a derivative by
  /// it is zero.
  bool squared = false;
  /// Files and reports have this times the exponential of what EffectParameters and prior_sigma hold: of what
  /// has a usual value that is not zero. 0: they have the value itself.
  double at_zero = 0;
  bool optional = false;  ///< a calibration file may leave it out: zero
  /// A value from which a fit finds what it may miss from zero: of a camera by itself, which may stand
  /// anywhere, both are tried. 0: zero will do.
  double other_start = 0;
  std::string_view usual{};  ///< what it stands for and its usual range
  double usual_width_s = 0;  ///< of a log_width
};

/// What people know an effect by, where that is its parameters and what else was estimated: results have it,
/// calibration files do not.
struct DerivedParameter {
  std::string_view name{}, unit{};
  int size = 3;  ///< red, green, blue; or 1
};

/// What a derived parameter is made of besides the effect's own.
struct DerivedFrom {
  Vector3d attenuation_per_m = Vector3d::Zero();  ///< of the water: red, green, blue
  /// Mean height of the first camera over where the map has the first panel's origin, along odom's z; NaN
  /// where there is none.
  double camera_over_panel_m = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace fathom
