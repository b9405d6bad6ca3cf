#include "sound.h"

#include <algorithm>
#include <cmath>

namespace fathom::sealed {
namespace {

constexpr double kSalinity = 35.0;
constexpr double kColdest_celsius = 0.0, kWarmest_celsius = 30.0;  // the equation's range
constexpr int kLayers = 10;

}  // namespace

double soundSpeed_m_s(double temperature_celsius, double salinity, double depth_m) {
  const double T = temperature_celsius, S = salinity, D = depth_m;
  return 1448.96 + 4.591 * T - 5.304e-2 * T * T + 2.374e-4 * T * T * T + 1.340 * (S - 35) + 1.630e-2 * D +
         1.675e-7 * D * D - 1.025e-2 * T * (S - 35) - 7.139e-13 * T * D * D * D;
}

/// Sound speed grows with temperature all over the range: bisection.
SoundProfile SoundProfile::through(double speed_m_s, double depth_m, double gradient_celsius_per_m) {
  double cold = kColdest_celsius, warm = kWarmest_celsius;
  for (int i = 0; i < 60; ++i) {
    const double middle = (cold + warm) / 2;
    (soundSpeed_m_s(middle, kSalinity, depth_m) < speed_m_s ? cold : warm) = middle;
  }
  return {(cold + warm) / 2, depth_m, gradient_celsius_per_m};
}

double SoundProfile::speedAt(double depth_m) const {
  return soundSpeed_m_s(temperature_celsius_ + gradient_celsius_per_m_ * (depth_m - depth_m_), kSalinity,
                        depth_m);
}

double SoundProfile::travelTime_s(double from_depth_m, double to_depth_m, double angle_rad) const {
  const double slowness_s_m = std::sin(angle_rad) / speedAt(from_depth_m);
  const double layer_m = (to_depth_m - from_depth_m) / kLayers;
  double seconds = 0;
  for (int i = 0; i < kLayers; ++i) {
    const double speed_m_s = speedAt(from_depth_m + (i + 0.5) * layer_m);
    const double sine = std::min(slowness_s_m * speed_m_s, 0.999);
    seconds += layer_m / (speed_m_s * std::sqrt(1 - sine * sine));
  }
  return seconds;
}

}  // namespace fathom::sealed
