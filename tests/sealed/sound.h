#pragma once

namespace fathom::sealed {

/// Sound speed in sea water, m/s: Mackenzie 1981 (J. Acoust. Soc. Am. 70, 807), nine terms.
double soundSpeed_m_s(double temperature_celsius, double salinity, double depth_m);

/// The water's sound speed over depth: temperature changes with depth by a constant gradient.
class SoundProfile {
 public:
  /// As near to `speed_m_s` at `depth_m` as sea water of 0 to 30 degrees and salinity 35 comes.
  static SoundProfile through(double speed_m_s, double depth_m, double gradient_celsius_per_m);

  double speedAt(double depth_m) const;
  /// One way along a ray that leaves downwards at this angle to the vertical: Snell's law keeps
  /// sin(angle) / speed (e.g. Urick 1983, sec. 5.5).
  double travelTime_s(double from_depth_m, double to_depth_m, double angle_rad) const;

 private:
  SoundProfile(double celsius, double depth_m, double gradient)
      : temperature_celsius_(celsius), depth_m_(depth_m), gradient_celsius_per_m_(gradient) {}

  double temperature_celsius_, depth_m_, gradient_celsius_per_m_;
};

}  // namespace fathom::sealed
