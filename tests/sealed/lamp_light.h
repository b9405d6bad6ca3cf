#pragma once

#include <vector>

#include "phase_function.h"
#include "port.h"
#include "sight_lines.h"
#include "vehicle.h"
#include "water_light.h"

namespace fathom::sealed {

/// The vehicle's lamps, as seen by its camera: all in the camera's frame.
class LampLight {
 public:
  /// Without lamps where the irradiance is zero. `daylight`: at rest, which the veil is built of.
  /// `beam_exponent`: a beam that goes with the cosine's power, instead of the data sheet's.
  LampLight(const Vehicle& vehicle, double irradiance_1m, const WaterLight& water, const Array3d& daylight,
            const SightLines& sight, PhaseFunction phase = henyeyGreenstein(0), double beam_exponent = 0);

  bool shines() const { return irradiance_1m_ > 0; }
  /// Of a surface there that looks along `normal`.
  Array3d irradianceOn(const Vector3d& point_camera, const Vector3d& normal_camera) const;
  /// Of what is small and catches light from everywhere.
  Array3d irradianceAt(const Vector3d& point_camera) const;
  /// What the water before this pixel scatters to the camera, up to a point so far along its line of sight.
  Array3d glow(const Vector2d& pixel, double range_m) const;

 private:
  struct Beam {
    Vector3d position_camera, axis_camera;
    double half_angle_cosine;
  };
  Array3d fromLamp(const Beam& beam, const Vector3d& point_camera) const;
  Array3d scattered(const Vector3d& point_camera, double range_m) const;
  void march(const SightLines& sight);

  std::vector<Beam> beams_;
  double irradiance_1m_, beam_exponent_;
  PhaseFunction phase_;
  WaterLight water_;
  Array3d scattering_per_m_;
  int columns_ = 0, rows_ = 0;
  std::vector<Array3d> glow_;  ///< by row and column of a coarse grid of pixels, and range
};

}  // namespace fathom::sealed
