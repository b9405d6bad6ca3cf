#pragma once

#include <array>
#include <concepts>
#include <string_view>

#include "core/random.h"
#include "recording/samples.h"

/// Changes of the values in a sample. A landmark comes in two forms of one image: MARKERS (T_odom_robot) and
/// PANEL (T_camera_panel of each panel seen). Both are changed alike: as if the robot stood elsewhere, by an
/// offset and a turn in robot axes,
///
///   T_odom_robot' = T_odom_robot D        T_camera_panel' = (T_robot_camera)^-1 D^-1 T_robot_camera
///   T_camera_panel
///
/// so the pose that a panel implies moves by the same D. Covariances stay as they are: a sensor does not know
/// of its fault.
namespace fathom {

/// How much is added to which value. In YAML a number goes for every axis, or [x, y, z].
struct Amounts {
  Vector3d gyro_rad_s = Vector3d::Zero();          ///< INS, its axes
  Vector3d accelerometer_m_s2 = Vector3d::Zero();  ///< INS, its axes
  Vector3d attitude_deg = Vector3d::Zero();        ///< INS that gives one: rotation vector in its axes
  Vector3d velocity_m_s = Vector3d::Zero();        ///< DVL, its axes
  double range_m = 0.0;                            ///< DVL_BEAMS; a range stays above 1 mm, as 0 is "no echo"
  double pressure_pa = 0.0;                        ///< DEPTH
  Vector3d position_m = Vector3d::Zero();          ///< USBL: odom axes; landmarks: robot axes
  Vector3d angle_deg = Vector3d::Zero();           ///< landmarks: rotation vector in robot axes

  template <class F>
  void fields(F& f, const auto& limit) {
    f.amount("gyro_rad_s", {labels::kIns}, gyro_rad_s, limit);
    f.amount("accelerometer_m_s2", {labels::kIns}, accelerometer_m_s2, limit);
    f.amount("attitude_deg", {labels::kIns}, attitude_deg, limit);
    f.amount("velocity_m_s", {labels::kDvl}, velocity_m_s, limit);
    f.amount("range_m", {labels::kDvlBeams}, range_m, limit);
    f.amount("pressure_pa", {labels::kDepth}, pressure_pa, limit);
    f.amount("position_m", {labels::kUsbl, labels::kMarkers, labels::kPanel}, position_m, limit);
    f.amount("angle_deg", {labels::kMarkers, labels::kPanel}, angle_deg, limit);
  }
};

namespace detail {
void addToRange(std::optional<double>& range_m, double amount_m);
void addToUsbl(PoseSample& sample, const Vector3d& amount_m);
/// D from an offset and a rotation vector; none where both are zero, which then changes no digit.
void moveRobot(Sample& sample, const Vector3d& offset_m, const Vector3d& turn_rad);
}  // namespace detail

/// Adds change(amount) to every value; `change` is a Vector3d of a Vector3d, called in the order of Amounts,
/// however large they are, once for each value (of a scalar, its first component counts).
template <std::invocable<Vector3d> Change>
void addTo(Sample& sample, const Amounts& amounts, Change change) {
  const auto scalar = [&](double amount) -> double { return change(Vector3d(amount, 0, 0)).x(); };
  if (auto* ins = std::get_if<InsSample>(&sample.reading)) {
    const Vector3d rate = change(amounts.gyro_rad_s), force = change(amounts.accelerometer_m_s2),
                   turn = change(amounts.attitude_deg);
    if (ins->angular_velocity_ins) *ins->angular_velocity_ins += rate;
    if (ins->specific_force_ins) *ins->specific_force_ins += force;
    if (ins->R_odom_ins && !turn.isZero(0)) *ins->R_odom_ins *= expSO3<double>(turn * radians(1));
  } else if (auto* dvl = std::get_if<DvlSample>(&sample.reading)) {
    const Vector3d velocity = change(amounts.velocity_m_s);
    if (dvl->velocity_dvl) *dvl->velocity_dvl += velocity;
  } else if (auto* beams = std::get_if<DvlBeamsSample>(&sample.reading)) {
    for (DvlBeam& beam : beams->beams) detail::addToRange(beam.range_m, scalar(amounts.range_m));
  } else if (auto* depth = std::get_if<DepthSample>(&sample.reading)) {
    depth->pressure_pa += scalar(amounts.pressure_pa);
  } else if (sample.label == labels::kUsbl && std::holds_alternative<PoseSample>(sample.reading)) {
    detail::addToUsbl(std::get<PoseSample>(sample.reading), change(amounts.position_m));
  } else {
    const Vector3d offset = change(amounts.position_m), turn = change(amounts.angle_deg);
    detail::moveRobot(sample, offset, turn * radians(1));
  }
}

/// What corrupted values look like.
enum class Garbage {
  nan,   ///< not a number, all of them
  huge,  ///< +-1e12 in the value's unit; an attitude at random
  wild,  ///< at random, within what the sensor could read: see value_changes.cpp
};
inline constexpr std::array<std::string_view, 3> kGarbageNames{"nan", "huge", "wild"};

/// Replaces all values that are there. Landmarks are moved as above, by a D of garbage.
void replaceValues(Sample& sample, Garbage garbage, Random& random);

/// True for the sensors whose samples have values that the above can change.
bool hasValues(const std::string& label);

}  // namespace fathom
