#pragma once

#include <optional>
#include <tuple>
#include <vector>

#include "core/geodesy.h"
#include "sensors/instrument.h"

namespace fathom {

/// Section `gnss` of the vehicle file, which says where odom is, too.
struct GnssSheet {
  double rate_hz = 1;
  double horizontal_sigma_m = 1.5, vertical_sigma_m = 3;  ///< each axis
  Geodetic origin;                                        ///< of odom: at the water's surface
  double odom_yaw_rad = 0;                                ///< from east to odom's x axis, about up
  Pose T_robot_gnss;

  Matrix3d R_odom_enu() const { return rotationFromYawPitchRoll(-odom_yaw_rad, 0, 0); }

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positive("horizontal_sigma_m", horizontal_sigma_m);
    f.positive("vertical_sigma_m", vertical_sigma_m);
    f.numberWithin("origin_latitude_deg", origin.latitude_deg, 89);  // odom has an east there
    f.numberWithin("origin_longitude_deg", origin.longitude_deg, 180);
    f.numberWithin("origin_height_m", origin.height_m, 10000);
    f.degrees("odom_yaw_deg", odom_yaw_rad);
    f.pose("pose", T_robot_gnss);
  }
};

/// An entry GNSS.
struct GnssSample {
  Pose T_robot_gnss;
  std::optional<Vector3d> geodetic;  ///< latitude and longitude (degrees), height (m); absent: no fix
};

/// A satellite receiver's fixes: there are none below the surface.
struct Gnss {
  static constexpr const char* label = "GNSS";
  static constexpr std::string_view section = "gnss", kind = "GNSS";
  using Instrument = Gnss;
  using Sheet = GnssSheet;
  using Sample = GnssSample;
  struct OnBoard {
    std::optional<GnssSheet> gnss;
  };
  static constexpr auto on_board = &OnBoard::gnss;

  static constexpr std::array values{ValueText{.name = "geodetic",
                                               .unit = "deg_deg_m",
                                               .kind = ValueText::Kind::geodetic,
                                               .absent = "fix",
                                               .fault = "fix_m",
                                               .lowest = -12'000,
                                               .highest = 12'000,
                                               .wild_low = -80,
                                               .wild_high = 80}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, s.geodetic ? &*s.geodetic : nullptr);
  }
  static std::vector<Pose> mountings(const GnssSample& s) { return {s.T_robot_gnss}; }
  static std::vector<Pose> mountings(const GnssSheet& s) { return {s.T_robot_gnss}; }

  class Simulated;

  using Channels = std::tuple<Gnss>;
  static constexpr ChannelText channel{.id = "gnss",
                                       .label = label,
                                       .unit = "m",
                                       .metric = "gnss_rms_m",
                                       .material = 0.1,
                                       .has_outliers = true,
                                       .tells = ChannelText::Tells::position,
                                       .start = ChannelText::Start::position};
  static constexpr const char* lacking = "GNSS without a fix";
  /// The antenna's position in odom.
  template <class F>
  static void observe(const GnssSample& s, const GnssSheet& sheet, F&& f) {
    if (!s.geodetic) return;
    const Geodetic at{s.geodetic->x(), s.geodetic->y(), s.geodetic->z()};
    f(Observation::vector(sheet.R_odom_enu() * eastNorthUp(at, sheet.origin),
                          {sheet.horizontal_sigma_m, sheet.horizontal_sigma_m, sheet.vertical_sigma_m},
                          s.T_robot_gnss));
  }
  template <class T>
  static Vector3<T> predict(const Inputs<T>& in, const GnssSheet&, const Observation& seen) {
    return antenna(in, seen.T_robot_sensor);
  }
  /// Odom, m.
  template <class T>
  static Vector3<T> antenna(const Inputs<T>& in, const Pose& T_robot_gnss) {
    return in.state.position_odom +
           in.state.R_odom_robot * in.template mounting<Gnss>(T_robot_gnss).position_robot;
  }
};

/// Fixes while the antenna is above the surface, odom's z = 0.
class Gnss::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 8, kStreams = 1;
  Simulated(const GnssSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {}

  GnssSample read(const Inputs<double>* in) {
    const Vector3d sigma(sheet_.horizontal_sigma_m, sheet_.horizontal_sigma_m, sheet_.vertical_sigma_m);
    const Vector3d error = noise_.sigma(1) * sigma.cwiseProduct(random_.normal3());
    GnssSample sample{sheet_.T_robot_gnss, {}};
    if (in == nullptr) return sample;
    const Vector3d antenna_odom = antenna(*in, sheet_.T_robot_gnss);
    if (antenna_odom.z() < 0) return sample;
    const Geodetic at = geodetic(sheet_.R_odom_enu().transpose() * (antenna_odom + error), sheet_.origin);
    sample.geodetic = {at.latitude_deg, at.longitude_deg, at.height_m};
    return sample;
  }

 private:
  const GnssSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
};

}  // namespace fathom
