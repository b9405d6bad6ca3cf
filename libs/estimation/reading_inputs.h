#pragma once

#include <type_traits>
#include <vector>

#include "estimation/forward_point.h"
#include "sensors/inputs.h"

/// A point of the batch as the sensors' models take it, differentiated by what is asked for.
namespace fathom {

/// What any model is called with: beside what instruments look at, what is of images.
template <class T>
struct ReadingInputs : Inputs<T> {
  PanelPlacement<T> panel;
  Vector3<T> right_in_left;
  Matrix3<T> R_left_right;
  Vector9<T> water;
  Eigen::Matrix<T, kFlaws, 1> flaws;
};

template <class T>
Vector3<T> lifted(const Vector3d& v) {
  return v.cast<T>();
}

/// A rotation's derivative by a turn about one of its own axes: R [axis]x.
template <class Jet>
void turnBy(Matrix3<Jet>& R, int axis, int slot) {
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  for (int i = 0; i < 3; ++i) {
    R(i, next).v[slot] = R(i, last).a;
    R(i, last).v[slot] = -R(i, next).a;
  }
}

/// Takes one column's derivative into a slot of the Jets: of velocity and acceleration while they are in
/// odom.
template <class Jet>
void differentiateBy(int column, int slot, ReadingInputs<Jet>& in) {
  const int axis = column % 3;
  const auto move = [slot](Jet& scalar) { scalar.v[slot] = 1.0; };
  KinematicState<Jet>& state = in.state;
  if (column >= kEffectColumn)
    return move(in.effects.values[static_cast<std::size_t>(column - kEffectColumn)]);
  if (column >= kFloorColumn) return move(in.world.sea_floor_z_m);
  if (column >= kFlawColumn) return move(in.flaws[column - kFlawColumn]);
  if (column >= kWaterColumn) return move(in.water[column - kWaterColumn]);
  if (column >= kRightColumn + 3) return turnBy(in.R_left_right, axis, slot);
  if (column >= kRightColumn) return move(in.right_in_left[axis]);
  if (column >= kPanelColumn + 3) return turnBy(in.panel.R_odom_panel, axis, slot);
  if (column >= kPanelColumn) return move(in.panel.position_odom[axis]);
  if (column >= kRateDerivativeColumn) return move(state.angular_acceleration_robot[axis]);
  if (column >= kRateColumn) return move(state.angular_velocity_robot[axis]);
  if (column >= kAccelerationColumn) return move(state.acceleration_robot[axis]);
  if (column >= kVelocityColumn) return move(state.velocity_robot[axis]);
  if (column >= kOrientationColumn) return turnBy(state.R_odom_robot, axis, slot);
  move(state.position_odom[axis]);
}

/// `point`; as Jets, with derivatives by as many columns as they carry, from the first-th on. Those of
/// rotations are set directly: multiplied out as Jets they would cost more than most sensors' models.
template <class T>
ReadingInputs<T> inputsAt(const ForwardPoint& point, double t_s, const std::vector<int>& columns,
                          std::size_t first) {
  ReadingInputs<T> in;
  in.t_s = t_s;
  const Motion& m = point.motion;
  KinematicState<T>& state = in.state;
  state = {lifted<T>(m.T_odom_robot.position), m.T_odom_robot.rotation.cast<T>(),
           lifted<T>(m.velocity_odom),         lifted<T>(m.rate_robot),
           lifted<T>(m.acceleration_odom),     lifted<T>(m.rate_derivative_robot)};
  in.panel = {t_s, lifted<T>(point.T_odom_panel.position), point.T_odom_panel.rotation.cast<T>(),
              point.first_panel_odom};
  in.right_in_left = lifted<T>(point.T_left_right.position);
  in.R_left_right = point.T_left_right.rotation.cast<T>();
  in.water = point.water.cast<T>();
  in.flaws = point.flaws.cast<T>();
  in.world.sea_floor_z_m = T(point.sea_floor_z_m);
  in.effects.on = point.on;
  for (std::size_t e = 0; e < kEffectCount; ++e)
    for (std::size_t s = kEffectOffsets[e]; point.on[e] && s < kEffectOffsets[e + 1]; ++s)
      in.effects.values[s] = T(point.effects[s]);
  if constexpr (!std::is_same_v<T, double>)
    for (int slot = 0; slot < T::DIMENSION && first + slot < columns.size(); ++slot)
      differentiateBy(columns[first + static_cast<std::size_t>(slot)], slot, in);
  const Matrix3<T> R_robot_odom = state.R_odom_robot.transpose();
  state.velocity_robot = R_robot_odom * state.velocity_robot;
  state.acceleration_robot = R_robot_odom * state.acceleration_robot;
  return in;
}

/// The motion at another time of validity, on a path whose knots follow the INS's latency: extrapolated(),
/// and constant jerks too.
template <class T>
void carryOn(ReadingInputs<T>& in, const ForwardPoint& point, const T& validity_s) {
  T seconds = validity_s - point.validity_s;
  if (point.knot_latency_s) seconds += *in.effects.template of<InsLatency>() - *point.knot_latency_s;
  in.state = extrapolated(in.state, seconds);
  in.state.acceleration_robot +=
      in.state.R_odom_robot.transpose() * Vector3<T>(lifted<T>(point.motion.jerk_odom) * seconds);
  in.state.angular_acceleration_robot += lifted<T>(point.motion.rate_second_derivative_robot) * seconds;
}

}  // namespace fathom
