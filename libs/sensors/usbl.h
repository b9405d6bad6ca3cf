#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "core/linear_algebra.h"
#include "sensors/instrument.h"
#include "sensors/pose_sample.h"

namespace fathom {

/// Section `usbl` of the vehicle file: position of the transponder.
struct UsblSheet {
  double rate_hz = 0.2;
  double position_sigma_m = 0.5;  ///< each axis
  Pose T_robot_usbl;
  bool is_absent = false;  ///< the vehicle file has no section: each entry's own mounting holds

  template <class Fields>
  void fields(Fields&& f) {
    f.positive("rate_hz", rate_hz);
    f.positive("position_sigma_m", position_sigma_m);
    f.pose("pose", T_robot_usbl);
  }
};

/// Ultra-short baseline positioning (USBL): position of a transponder on the robot. Entries bring their own
/// covariance; that of the orientation is huge.
struct Usbl {
  static constexpr const char* label = "USBL";
  static constexpr std::string_view section = "usbl", kind = "pose";
  using Sheet = UsblSheet;
  using Sample = PoseSample;
  struct OnBoard {
    std::optional<UsblSheet> usbl;
  };
  static constexpr auto on_board = &OnBoard::usbl;
  static constexpr bool needs_sheet = false;  ///< without one the transponder is at the reference point

  static constexpr std::array values{ValueText{
      .name = "position_odom", .unit = "m", .fault = "position_m", .wild_low = -10, .wild_high = 10}};
  template <class Entry, class F>
  static void forEachValue(Entry& s, F&& f) {
    f(0, &s.T_odom_robot.mean.position);
  }
  static std::vector<Pose> mountings(const PoseSample& s) { return {s.T_robot_sensor}; }
  static std::vector<Pose> mountings(const UsblSheet& s) { return {s.T_robot_usbl}; }

  class Simulated;

  using Channels = std::tuple<Usbl>;
  using Instrument = Usbl;
  static constexpr ChannelText channel{.id = "usbl",
                                       .label = label,
                                       .unit = "m",
                                       .metric = "usbl_rms_m",
                                       .material = 0.1,
                                       .has_outliers = true,
                                       .tells = ChannelText::Tells::position,
                                       .start = ChannelText::Start::position};
  static constexpr const char* lacking = "USBL with a covariance that is none";
  /// The mounting is the vehicle file's; where that has no section, the entry's.
  template <class F>
  static void observe(const PoseSample& s, const UsblSheet& sheet, F&& f) {
    const Matrix3d covariance = s.T_odom_robot.covariance.topLeftCorner<3, 3>();
    if (isPositiveDefinite(covariance))
      f(Observation{s.T_odom_robot.mean.position, covariance,
                    sheet.is_absent ? s.T_robot_sensor : sheet.T_robot_usbl});
  }
  /// Position of the transponder, odom, m.
  template <class T>
  static Vector3<T> predict(const Inputs<T>& in, const UsblSheet&, const Observation& seen) {
    return position(in, seen.T_robot_sensor);
  }
  template <class T>
  static Vector3<T> position(const Inputs<T>& in, const Pose& T_robot_usbl) {
    return in.state.position_odom +
           in.state.R_odom_robot * in.template mounting<Usbl>(T_robot_usbl).position_robot;
  }
};

class Usbl::Simulated {
 public:
  static constexpr std::uint64_t kFirstStream = 6, kStreams = 1;
  Simulated(const UsblSheet& sheet, const SimulatedNoise& noise)
      : sheet_(sheet), noise_(noise), random_(noise.stream(kFirstStream)) {}

  PoseSample read(const Inputs<double>* in) {
    constexpr double kUnknown_rad2 = 1e6;
    const Vector3d error = noise_.sigma(sheet_.position_sigma_m) * random_.normal3();
    PoseSample sample;
    sample.T_robot_sensor = sheet_.T_robot_usbl;
    sample.T_odom_robot.mean.position.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (in != nullptr) sample.T_odom_robot.mean.position = position(*in, sheet_.T_robot_usbl) + error;
    sample.T_odom_robot.covariance.setZero();
    sample.T_odom_robot.covariance.diagonal().head<3>().setConstant(std::pow(sheet_.position_sigma_m, 2));
    sample.T_odom_robot.covariance.diagonal().tail<3>().setConstant(kUnknown_rad2);
    return sample;
  }

 private:
  const UsblSheet& sheet_;
  SimulatedNoise noise_;
  Random random_;
};

}  // namespace fathom
