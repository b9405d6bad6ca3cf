#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "sensors/instrument.h"

namespace fathom {

/// Section `compass` of the vehicle file.
struct CompassSheet {
  double rate_hz = 5;
  double heading_sigma_rad = radians(1);  ///< white, each sample
  Pose T_robot_compass;

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positiveDegrees("heading_sigma_deg", heading_sigma_rad);
    f.pose("pose", T_robot_compass);
  }
};

/// An entry COMPASS.
struct CompassSample {
  Pose T_robot_compass;
  /// Angle about odom's z axis from odom's x axis to the sensor's, declination and convergence applied.
  double heading_rad = 0;
};

/// Heading of a magnetometer or compass. Iron about: effect heading-disturbance.
struct Compass {
  static constexpr const char* label = "COMPASS";
  static constexpr std::string_view section = "compass", kind = "compass";
  using Instrument = Compass;
  using Sheet = CompassSheet;
  using Sample = CompassSample;
  struct OnBoard {
    std::optional<CompassSheet> compass;
  };
  static constexpr auto on_board = &OnBoard::compass;

  static constexpr std::array values{ValueText{.name = "heading",
                                               .unit = "rad",
                                               .kind = ValueText::Kind::scalar,
                                               .fault = "heading_rad",
                                               .wild_low = -3,
                                               .wild_high = 3}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, &s.heading_rad);
  }
  static std::vector<Pose> mountings(const CompassSample& s) { return {s.T_robot_compass}; }
  static std::vector<Pose> mountings(const CompassSheet& s) { return {s.T_robot_compass}; }

  class Simulated;

  using Channels = std::tuple<Compass>;
  static constexpr ChannelText channel{.id = "heading",
                                       .label = label,
                                       .unit = "deg",
                                       .scale = degrees(1.0),
                                       .metric = "heading_rms_deg",
                                       .material = radians(0.1),
                                       .component_count = 1,
                                       .has_outliers = true,
                                       .start = ChannelText::Start::heading};
  /// Of the angle from the heading that was read, which does not wrap.
  template <class F>
  static void observe(const CompassSample& s, const CompassSheet& sheet, F&& f) {
    Observation seen = Observation::scalar(0, sheet.heading_sigma_rad, s.T_robot_compass);
    seen.about = rotationFromYawPitchRoll(s.heading_rad, 0, 0);
    f(seen);
  }
  template <class T>
  static Vector1<T> predict(const Inputs<T>& in, const CompassSheet&, const Observation& seen) {
    return Vector1<T>(heading(in, seen.T_robot_sensor, seen.about));
  }
  /// rad, from the x axis of `about`, a turn about odom's z axis.
  template <class T>
  static T heading(const Inputs<T>& in, const Pose& T_robot_compass, const Matrix3d& about) {
    using std::atan2;
    const Vector3<T> x = about.transpose().cast<T>() * in.state.R_odom_robot *
                         in.template mounting<Compass>(T_robot_compass).R_robot_sensor.col(0);
    return in.at(HeadingReading<T>{atan2(x.y(), x.x()), in.state.position_odom}).heading_rad;
  }
};

class Compass::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 7, kStreams = 1;
  Simulated(const CompassSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {}

  CompassSample read(const Inputs<double>* in) {
    const double error_rad = noise_.sigma(sheet_.heading_sigma_rad) * random_.normal();
    CompassSample sample{sheet_.T_robot_compass, std::numeric_limits<double>::quiet_NaN()};
    if (in != nullptr)
      sample.heading_rad = wrapAngle(heading(*in, sheet_.T_robot_compass, Matrix3d::Identity()) + error_rad);
    return sample;
  }

 private:
  const CompassSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
};

}  // namespace fathom
