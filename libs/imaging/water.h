#pragma once

#include <filesystem>
#include <optional>

#include "core/geometry.h"

/// The water and the light around the vehicle: what no data sheet knows. See config/water_clear.yaml.
/// Colours are linear red, green, blue; a radiance of 1 is the camera's full scale.
namespace fathom {

/// The paper's water (DexROV 2018): light i from z metres away arrives as i exp(-a z) + (1 - exp(-a z)) b.
template <class T>
struct WaterColumn {
  Vector3<T> attenuation_per_m = Vector3<T>::Zero();  ///< a
  Vector3<T> veil = Vector3<T>::Zero();               ///< b, the radiance of endless water
};
using Water = WaterColumn<double>;

struct Environment {
  Water water;
  Vector3d ambient = Vector3d::Ones();  ///< daylight at the scene; 1 is full light
  /// Optional key. Irradiance of each of the vehicle's lamps on its axis at 1 m, in units of full ambient
  /// light; the base model lets it reach the scene undimmed. Absent: the lamps are off.
  std::optional<Vector3d> lamps_irradiance_1m;
};

/// Attenuation, veil, ambient light, red green blue each: what a fit finds of an environment.
template <class T>
using Vector9 = Eigen::Matrix<T, 9, 1>;
using Vector9d = Vector9<double>;
Vector9d waterParameters(const Environment& environment);
/// With the lamps off.
Environment environmentOf(const Vector9d& parameters);

/// Sigmas of a prior so wide that only a parameter of which the images tell nothing feels it.
Vector9d wideWaterSigma();

/// Strict, see core/yaml.h. Throws Error.
Environment readEnvironment(const std::filesystem::path& file);

}  // namespace fathom
