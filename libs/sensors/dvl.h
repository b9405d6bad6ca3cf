#pragma once

#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include "sensors/instrument.h"

namespace fathom {

/// Section `dvl` of the vehicle file.
struct DvlSheet {
  double rate_hz = 5;
  double assumed_sound_speed_m_s = 1500;
  double beam_sigma_m_s = 0.007;
  double velocity_sigma_xy_m_s = 0.0099;
  double velocity_sigma_z_m_s = 0.00404;
  double range_sigma_m = 0.015;
  double beam_angle_rad = radians(30);                                                ///< from straight down
  std::vector<double> beam_azimuths_rad{0, radians(90), radians(180), radians(270)};  ///< DVL frame
  Pose T_robot_dvl;

  BeamGeometry beams() const { return {beam_angle_rad, beam_azimuths_rad}; }
  /// Beam k's frame on the robot: x along the beam, down and out.
  Pose T_robot_beam(std::size_t k) const {
    return T_robot_dvl * Pose{beams().R_dvl_beam(static_cast<std::ptrdiff_t>(k)), Vector3d::Zero()};
  }

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positive("assumed_sound_speed_m_s", assumed_sound_speed_m_s);
    f.positive("beam_sigma_m_s", beam_sigma_m_s);
    f.positive("velocity_sigma_xy_m_s", velocity_sigma_xy_m_s);
    f.positive("velocity_sigma_z_m_s", velocity_sigma_z_m_s);
    f.positive("range_sigma_m", range_sigma_m);
    f.degreesBelow("beam_angle_deg", beam_angle_rad, 90);
    f.listOfDegrees("beam_azimuths_deg", beam_azimuths_rad);
    f.pose("pose", T_robot_dvl);
  }
};

/// An entry DVL.
struct DvlSample {
  Pose T_robot_dvl;
  std::optional<Vector3d> velocity_dvl;  ///< m/s over ground, sensor frame; absent: no bottom lock
};

/// An entry DVL_BEAMS.
struct DvlBeam {
  Pose T_robot_beam;              ///< x along the beam
  std::optional<double> range_m;  ///< slant range; absent: no echo (stored as 0)
};
struct DvlBeamsSample {
  std::vector<DvlBeam> beams;
};

/// The Doppler velocity log (DVL): velocity over ground at the sensor, R_dvl_robot (v + omega x l).
struct Dvl {
  static constexpr const char* label = "DVL";
  static constexpr std::string_view section = "dvl", kind = "DVL";
  using Sheet = DvlSheet;
  using Sample = DvlSample;
  struct OnBoard {
    std::optional<DvlSheet> dvl;
  };
  static constexpr auto on_board = &OnBoard::dvl;

  static constexpr std::array values{ValueText{.name = "velocity_dvl",
                                               .unit = "m_s",
                                               .absent = "bottom lock",
                                               .fault = "velocity_m_s",
                                               .lowest = -50,
                                               .highest = 50,
                                               .wild_low = -3,
                                               .wild_high = 3}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, s.velocity_dvl ? &*s.velocity_dvl : nullptr);
  }
  static std::vector<Pose> mountings(const DvlSample& s) { return {s.T_robot_dvl}; }
  static std::vector<Pose> mountings(const DvlSheet& s) { return {s.T_robot_dvl}; }

  class Simulated;

  using Channels = std::tuple<Dvl>;
  using Instrument = Dvl;
  static constexpr ChannelText channel{.id = "dvl",
                                       .label = label,
                                       .unit = "mm/s",
                                       .scale = 1000,
                                       .metric = "dvl_rms_mm_s",
                                       .material = 0.001,
                                       .has_outliers = true,
                                       .shows_motion = true,
                                       .tells = ChannelText::Tells::velocity,
                                       .start = ChannelText::Start::velocity};
  static constexpr const char* lacking = "DVL without bottom lock";
  template <class F>
  static void observe(const DvlSample& s, const DvlSheet& sheet, F&& f) {
    if (s.velocity_dvl)
      f(Observation::vector(
          *s.velocity_dvl,
          {sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_z_m_s},
          s.T_robot_dvl));
  }
  /// m/s, DVL frame.
  template <class T>
  static Vector3<T> predict(const Inputs<T>& in, const DvlSheet& sheet, const Observation& seen) {
    return velocity(in, seen.T_robot_sensor, sheet.beams());
  }
  template <class T>
  static Vector3<T> velocity(const Inputs<T>& in, const Pose& T_robot_dvl, const BeamGeometry& beams = {}) {
    const auto mount = in.template mounting<Dvl>(T_robot_dvl);
    const Vector3<T> at_sensor =
        in.state.velocity_robot + in.state.angular_velocity_robot.cross(mount.position_robot);
    return in
        .at(DvlVelocity<T>{mount.R_robot_sensor.transpose() * at_sensor,
                           in.state.R_odom_robot * mount.R_robot_sensor, beams})
        .velocity_dvl;
  }
};

/// The same instrument's beams: their slant ranges to the flat sea floor.
struct DvlBeams {
  static constexpr const char* label = "DVL_BEAMS";
  static constexpr std::string_view section = "dvl", kind = "DVL beams";
  using Sheet = DvlSheet;
  using Sample = DvlBeamsSample;
  struct OnBoard {};  ///< the DVL's
  static constexpr auto on_board = Dvl::on_board;

  /// One value a beam: they are numbered.
  static constexpr bool numbered = true;
  static constexpr std::array values{ValueText{.name = "range",
                                               .unit = "m",
                                               .kind = ValueText::Kind::scalar,
                                               .absent = "echo of beam",
                                               .fault = "range_m",
                                               .lowest = 0,
                                               .highest = 12'000,  // the deepest sea
                                               .wild_low = 0,
                                               .wild_high = 50,
                                               .least = 1e-3}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    for (auto& beam : s.beams) f(0, beam.range_m ? &*beam.range_m : nullptr);
  }
  static std::vector<Pose> mountings(const DvlBeamsSample& s) {
    std::vector<Pose> poses;
    for (const DvlBeam& beam : s.beams) poses.push_back(beam.T_robot_beam);
    return poses;
  }
  static std::vector<Pose> mountings(const DvlSheet& s) {
    std::vector<Pose> poses;
    for (std::size_t k = 0; k < s.beam_azimuths_rad.size(); ++k) poses.push_back(s.T_robot_beam(k));
    return poses;
  }

  class Simulated;

  using Channels = std::tuple<DvlBeams>;
  using Instrument = Dvl;  ///< one ping for both, and one mounting
  /// The batch estimate has no unknown for the ground's shape.
  static constexpr ChannelText channel{.id = "altitude",
                                       .label = label,
                                       .unit = "m",
                                       .metric = "altitude_rms_m",
                                       .material = 0.1,
                                       .component_count = 1,
                                       .is_estimated = false,
                                       .start = ChannelText::Start::sea_floor,
                                       .is_indirect = true};
  template <class F>
  static void observe(const DvlBeamsSample& s, const DvlSheet& sheet, F&& f) {
    for (const DvlBeam& beam : s.beams)
      if (beam.range_m) f(Observation::scalar(*beam.range_m, sheet.range_sigma_m, beam.T_robot_beam));
  }
  template <class T>
  static Vector1<T> predict(const Inputs<T>& in, const DvlSheet& sheet, const Observation& seen) {
    return Vector1<T>(range(in, sheet.T_robot_dvl, seen.T_robot_sensor));
  }
  /// m. Not finite or negative where the beam looks up or along. Beams hang on the DVL: its misalignment and
  /// lever arm move them too.
  template <class T>
  static T range(const Inputs<T>& in, const Pose& T_robot_dvl, const Pose& T_robot_beam) {
    const auto mount = in.template mounting<Dvl>(T_robot_dvl);
    const Pose T_dvl_beam = T_robot_dvl.inverse() * T_robot_beam;
    const Vector3<T> origin_robot =
        mount.position_robot + mount.R_robot_sensor * T_dvl_beam.position.template cast<T>();
    const Vector3<T> along_robot = mount.R_robot_sensor * T_dvl_beam.rotation.col(0).template cast<T>();
    return rangeToFloor<T>(in, origin_robot, along_robot);
  }
};

/// Ranges without noise; absent where the beam looks up or the floor is out of reach.
inline std::vector<std::optional<double>> echoes(const Inputs<double>& in, const DvlSheet& sheet,
                                                 const SimulatedNoise& noise) {
  std::vector<std::optional<double>> ranges_m;
  for (std::size_t k = 0; k < sheet.beam_azimuths_rad.size(); ++k) {
    const double range_m = DvlBeams::range(in, sheet.T_robot_dvl, sheet.T_robot_beam(k));
    const bool heard = range_m >= noise.beam_min_range_m && range_m <= noise.beam_max_range_m;
    ranges_m.push_back(heard ? std::optional(range_m) : std::nullopt);
  }
  return ranges_m;
}

/// Bottom lock with echoes on three beams.
class Dvl::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 3, kStreams = 1;
  Simulated(const DvlSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {}

  DvlSample read(const Inputs<double>* in) {
    const double xy = noise_.sigma(sheet_.velocity_sigma_xy_m_s),
                 z = noise_.sigma(sheet_.velocity_sigma_z_m_s);
    const Vector3d error = Vector3d(xy, xy, z).cwiseProduct(random_.normal3());
    DvlSample sample{sheet_.T_robot_dvl, {}};
    if (in != nullptr && hasBottomLock(*in))
      sample.velocity_dvl = velocity(*in, sheet_.T_robot_dvl, sheet_.beams()) + error;
    return sample;
  }

 private:
  bool hasBottomLock(const Inputs<double>& in) const {
    const auto ranges_m = echoes(in, sheet_, noise_);
    const auto heard = std::count_if(ranges_m.begin(), ranges_m.end(), [](auto& r) { return r.has_value(); });
    return heard >= std::min<std::ptrdiff_t>(3, std::ssize(ranges_m));
  }

  const DvlSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
};

class DvlBeams::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 4, kStreams = 1;
  Simulated(const DvlSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {}

  DvlBeamsSample read(const Inputs<double>* in) {
    std::vector<std::optional<double>> ranges_m(sheet_.beam_azimuths_rad.size());
    if (in != nullptr) ranges_m = echoes(*in, sheet_, noise_);
    DvlBeamsSample sample;
    for (std::size_t k = 0; k < ranges_m.size(); ++k) {
      const double error_m = noise_.sigma(sheet_.range_sigma_m) * random_.normal();
      if (ranges_m[k]) ranges_m[k] = std::max(*ranges_m[k] + error_m, values[0].least);
      sample.beams.push_back({sheet_.T_robot_beam(k), ranges_m[k]});
    }
    return sample;
  }

 private:
  const DvlSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
};

}  // namespace fathom
