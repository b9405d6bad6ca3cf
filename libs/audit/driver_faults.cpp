#include <cmath>

#include "audit/assumption.h"
#include "audit/correction.h"
#include "audit/sensor_units.h"
#include "core/text.h"

namespace fathom {
namespace {

// Of faults that drivers make: forward-right-down for forward-left-up, all signs; other signs, east-north for
// north-east; an instrument mounted the other way round, two axes exchanged.
double unusualOf(const SignedAxes& axes) {
  constexpr double kUsual = 5, kLess = 5.5, kLesser = 6, kRare = 7.5;
  const bool in_order = axes.source == std::array{0, 1, 2};
  const bool forward_right_down = axes == SignedAxes{{0, 1, 2}, {1, -1, -1}};
  const bool all_signs = axes == SignedAxes{{0, 1, 2}, {-1, -1, -1}};
  if (forward_right_down || all_signs) return kUsual;
  const bool ned = axes == SignedAxes{{1, 0, 2}, {1, 1, -1}};
  if (in_order || ned) return kLess;
  const bool exchanged = axes.sign == std::array{1, 1, 1} && !axes.proper();
  return exchanged || axes.source[2] == 2 ? kLesser : kRare;
}

constexpr double kTwoFaults = 3;  // more
constexpr const char* kAgree = "agree with the others";

class DriverFaults {
 public:
  std::vector<DriverFault> all;

  DriverFault& add(const std::string& correction, const std::string& says, const std::string& corrected,
                   double unusual) {
    DriverFault& fault = all.emplace_back();
    fault.parts.push_back({correction, says, corrected});
    fault.unusual = unusual;
    return fault;
  }

  void addInertial() {
    for (const SignedAxes& axes : allAxes()) {
      if (axes == SignedAxes{}) continue;
      const Matrix3d m = axes.matrix();
      const std::string text = axes.text();
      add(correction("accelerometer-axes", axes), "the accelerometer's axes are " + text, kAgree,
          unusualOf(axes))
          .taken_for.accelerometer = m;
      add(correction("gyro-axes", axes), "the gyro's axes are " + text, kAgree, unusualOf(axes))
          .taken_for.gyro = m;
      if (!axes.proper()) {  // no instrument as a whole
        addInertialPair(axes);
        continue;
      }
      DriverFault& all_of_it =
          add(correction("ins-axes", axes), "the INS's axes are " + text, kAgree, unusualOf(axes));
      all_of_it.taken_for.gyro = all_of_it.taken_for.accelerometer = all_of_it.taken_for.attitude_axes = m;
    }
    for (const SensorUnit& unit : kRateUnits)
      add(unit.name, unit.says, "radians a second", unit.unusual).taken_for.gyro *= unit.si;
  }

  /// Of vectors, by a driver's own formulas, which leave an attitude alone.
  void addInertialPair(const SignedAxes& axes) {
    DriverFault& pair = all.emplace_back();
    pair.parts = {
        {correction("gyro-axes", axes), "the gyro's axes are " + axes.text(), kAgree},
        {correction("accelerometer-axes", axes), "the accelerometer's axes are " + axes.text(), kAgree}};
    pair.taken_for.gyro = pair.taken_for.accelerometer = axes.matrix();
    pair.unusual = unusualOf(axes) + 1;
  }

  /// Of an attitude, alone or with the INS's axes; and of a gyro and an accelerometer whose attitude is
  /// right.
  void addAttitude(const Matrix3d& R_robot_ins) {
    const std::vector<const AttitudeReading*> readings = readingsThatDiffer(R_robot_ins);
    for (const AttitudeReading* reading : readings)
      add(reading->name, reading->says, kAgree, 5).taken_for.attitude = reading;
    for (const SignedAxes& axes : allAxes()) {
      if (axes == SignedAxes{} || !axes.proper()) continue;
      const Matrix3d m = axes.matrix();
      const DriverFault::Part axes_part{correction("ins-axes", axes), "the INS's axes are " + axes.text(),
                                        kAgree};
      for (const AttitudeReading* reading : readings) {
        DriverFault& both = all.emplace_back();
        both.parts = {axes_part, {reading->name, reading->says, kAgree}};
        both.taken_for.gyro = both.taken_for.accelerometer = both.taken_for.attitude_axes = m;
        both.taken_for.attitude = reading;
        both.unusual = unusualOf(axes) + kTwoFaults;
      }
      addInertialPair(axes);
    }
  }

  /// An attitude's convention and a DVL's axes, which an INS's axes could be taken for.
  void addAttitudeAndDvl(const Matrix3d& R_robot_ins) {
    for (const AttitudeReading* reading : readingsThatDiffer(R_robot_ins))
      for (const SignedAxes& axes : allAxes()) {
        if (axes == SignedAxes{} || !axes.proper()) continue;
        DriverFault& both = all.emplace_back();
        both.parts = {{reading->name, reading->says, kAgree},
                      {correction("dvl-axes", axes), "the DVL's axes are " + axes.text(), kAgree}};
        both.taken_for.attitude = reading;
        both.taken_for.dvl = axes.matrix();
        both.unusual = unusualOf(axes) + kTwoFaults;
      }
  }

  void addDvl() {
    for (const SignedAxes& axes : allAxes())
      if (axes != SignedAxes{})
        add(correction("dvl-axes", axes), "its axes are " + axes.text(), kAgree, unusualOf(axes))
            .taken_for.dvl = axes.matrix();
    for (const SensorUnit& unit : kVelocityUnits)
      add(unit.name, unit.says, "metres a second", unit.unusual).taken_for.dvl *= unit.si;
  }

  void addDepth() { add("pressure-falls", "it falls as the vehicle dives", "", 5).taken_for.rise = -1; }

 private:
  /// Others than as it stands, with an INS so mounted.
  static std::vector<const AttitudeReading*> readingsThatDiffer(const Matrix3d& R_robot_ins) {
    const Matrix3d some = rotationFromYawPitchRoll(0.4, 0.3, 0.2);
    std::vector<const AttitudeReading*> readings;
    for (const AttitudeReading& reading : attitudeReadings().subspan(1))
      if (angleBetween(reading.read(some, R_robot_ins), some) > radians(10)) readings.push_back(&reading);
    return readings;
  }

  static std::string correction(const std::string& name, const SignedAxes& axes) {
    return name + ":" + plainText(axes);
  }
};

}  // namespace

std::vector<DriverFault> driverFaults(bool has_attitude, bool has_dvl, bool has_depth,
                                      const Matrix3d& R_robot_ins) {
  DriverFaults faults;
  faults.addInertial();
  if (has_attitude) faults.addAttitude(R_robot_ins);
  if (has_dvl) faults.addDvl();
  if (has_dvl && has_attitude) faults.addAttitudeAndDvl(R_robot_ins);
  if (has_dvl && has_depth) faults.addDepth();
  return faults.all;
}

}  // namespace fathom
