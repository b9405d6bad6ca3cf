#include "water_light.h"

#include <array>
#include <cmath>

namespace fathom::sealed {
namespace {

constexpr double kPlumeWidth_s = 10.0;

struct Water {
  const char* name;
  Array3d attenuation_per_m, veil, daylight;
};

/// Clear: some way off the coast, Jerlov's oceanic types; turbid: his coastal types 3 to 5 (Jerlov 1976,
/// tables XXVI and XXVII, roughly, at 620, 540 and 460 nm). Daylight is 0.87 in the mean of its colours.
const Water& waterNamed(const std::string& name) {
  static const std::array<Water, 3> waters{
      {{"clear", {0.35, 0.10, 0.08}, {0.025, 0.150, 0.215}, {0.80, 0.90, 0.91}},
       {"moderate", {0.45, 0.22, 0.20}, {0.035, 0.180, 0.200}, {0.80, 0.90, 0.91}},
       {"turbid", {0.85, 0.50, 0.56}, {0.050, 0.220, 0.200}, {0.80, 0.92, 0.89}}}};
  for (const Water& water : waters)
    if (name == water.name) return water;
  return waters[0];
}

/// A diffusing puff that drifts past (Fischer et al. 1979, sec. 2.3): Gaussian in time.
double plume_per_m(const SealedCase& sealed, double t_s) {
  const double width_s = kPlumeWidth_s * std::exp(sealed.number("turbidity-plume", "log_width", t_s));
  const double widths_off = (t_s - sealed.number("turbidity-plume", "time_s", t_s)) / width_s;
  return sealed.number("turbidity-plume", "peak_extra_attenuation_per_m", t_s) *
         std::exp(-widths_off * widths_off / 2);
}

}  // namespace

WaterLight waterLightAt(const SealedCase& sealed, double t_s, double log_sun) {
  const Water& water = waterNamed(sealed.dive.water);
  WaterLight light;
  light.attenuation_per_m = water.attenuation_per_m + plume_per_m(sealed, t_s);
  light.veil_attenuation_per_m =
      light.attenuation_per_m +
      sealed.vector("separate-backscatter", "backscatter_difference_per_m", t_s).array();
  light.veil = water.veil;
  light.daylight = water.daylight * std::exp(log_sun * sealed.number("sun-flicker", "log_light_sd", t_s));
  light.slant_share = sealed.number("slant-range", "slant_share", t_s);
  light.scattered_fraction = sealed.number("forward-scatter", "scattered_fraction", t_s);
  return light;
}

}  // namespace fathom::sealed
