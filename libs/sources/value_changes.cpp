#include "sources/value_changes.h"

#include <algorithm>
#include <limits>
#include <set>

namespace fathom {
namespace {

/// What a sensor of a slow vehicle could read, from -limit to limit in each axis.
constexpr double kWildRate_rad_s = 2.0, kWildForce_m_s2 = 20.0, kWildVelocity_m_s = 3.0;
constexpr double kWildPosition_m = 10.0, kWildAngle_rad = 2.0;
constexpr double kWildRange_m = 50.0;       // from 0
constexpr double kWildPressure_pa = 1.1e6;  // from 0: 100 m of water
constexpr double kShortestRange_m = 1e-3;   // 0 is "no echo" in a recording
constexpr double kHuge = 1e12;

/// Draws garbage values.
struct GarbageDraw {
  Garbage kind;
  Random& random;

  double value(double low, double high) const {
    const double wild = random.uniform(low, high);
    if (kind == Garbage::nan) return std::numeric_limits<double>::quiet_NaN();
    if (kind == Garbage::huge) return wild < 0.5 * (low + high) && low < 0 ? -kHuge : kHuge;
    return wild;
  }
  Vector3d vector(double limit) const {
    const double x = value(-limit, limit), y = value(-limit, limit), z = value(-limit, limit);
    return {x, y, z};
  }
  Matrix3d rotation() const {
    const Vector3d axis = random.normal3().normalized();
    const Matrix3d R = expSO3<double>(random.uniform(0, kWildAngle_rad) * axis);
    return kind == Garbage::nan ? Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()) : R;
  }
};

void replaceInLandmark(Sample& sample, const GarbageDraw& draw) {
  const Vector3d offset = draw.vector(kWildPosition_m);
  const Vector3d turn = logSO3<double>(GarbageDraw{Garbage::wild, draw.random}.rotation());
  detail::moveRobot(sample, offset, turn);
}

}  // namespace

namespace detail {

void addToRange(std::optional<double>& range_m, double amount_m) {
  if (range_m && amount_m != 0) range_m = std::max(*range_m + amount_m, kShortestRange_m);
}

void addToUsbl(PoseSample& sample, const Vector3d& amount_m) {
  sample.T_odom_robot.mean.position += amount_m;
}

void moveRobot(Sample& sample, const Vector3d& offset_m, const Vector3d& turn_rad) {
  if (offset_m.isZero(0) && turn_rad.isZero(0)) return;
  const Pose D{expSO3<double>(turn_rad), offset_m};
  if (auto* pose = std::get_if<PoseSample>(&sample.reading)) {
    pose->T_odom_robot.mean = pose->T_odom_robot.mean * D;
  } else if (auto* panels = std::get_if<PanelSample>(&sample.reading)) {
    const Pose change = panels->T_robot_camera.inverse() * D.inverse() * panels->T_robot_camera;
    for (SeenPanel& seen : panels->panels) seen.T_camera_panel.pose = change * seen.T_camera_panel.pose;
  }
}

}  // namespace detail

void replaceValues(Sample& sample, Garbage garbage, Random& random) {
  const GarbageDraw draw{garbage, random};
  if (auto* ins = std::get_if<InsSample>(&sample.reading)) {
    if (ins->angular_velocity_ins) ins->angular_velocity_ins = draw.vector(kWildRate_rad_s);
    if (ins->specific_force_ins) ins->specific_force_ins = draw.vector(kWildForce_m_s2);
    if (ins->R_odom_ins) ins->R_odom_ins = draw.rotation();
  } else if (auto* dvl = std::get_if<DvlSample>(&sample.reading)) {
    if (dvl->velocity_dvl) dvl->velocity_dvl = draw.vector(kWildVelocity_m_s);
  } else if (auto* beams = std::get_if<DvlBeamsSample>(&sample.reading)) {
    for (DvlBeam& beam : beams->beams)
      if (beam.range_m) beam.range_m = draw.value(0, kWildRange_m);
  } else if (auto* depth = std::get_if<DepthSample>(&sample.reading)) {
    depth->pressure_pa = draw.value(0, kWildPressure_pa);
  } else if (sample.label == labels::kUsbl && std::holds_alternative<PoseSample>(sample.reading)) {
    std::get<PoseSample>(sample.reading).T_odom_robot.mean.position = draw.vector(kWildPosition_m);
  } else {
    replaceInLandmark(sample, draw);
  }
}

bool hasValues(const std::string& label) {
  static const std::set<std::string> with{labels::kIns,  labels::kDvl,     labels::kDvlBeams, labels::kDepth,
                                          labels::kUsbl, labels::kMarkers, labels::kPanel};
  return with.contains(label);
}

}  // namespace fathom
