#pragma once

#include "localization/error_state_filter.h"
#include "sensors/channel_model.h"

/// Observations as linearized measurements: the residual comes from the sensors' forward model
/// (libs/sensors), its Jacobian from running that model on Jets.
namespace fathom {

/// What an observation is judged against: the world, the calibration and the vehicle file.
struct MeasurementContext {
  const Vehicle* vehicle = nullptr;      ///< not null
  EffectParameters<double> calibration;  ///< effects known to be there
  double t_s = 0.0;                      ///< the observation's time stamp, since the recording's first entry
};

/// The columns of the error state that a channel's measurement depends on, of a filter of N states: traced
/// through its model, with all effects that a calibration may have or with none.
template <int N>
const StateColumns& columnsOf(Channel channel, bool has_effects);

/// residual = z - h(x) (of rotations z [-] h(x)), H = dh/d(error). M: the channel's components. The filter's
/// bias states, where it has any (N = 23), are the first instance's: of others what drifts counts as noise
/// (Drift::whiteVariance()).
template <int N, int M>
typename ErrorStateFilter<N>::template Measurement<M> measure(const NavigationState<double>& x,
                                                              Channel channel, const Observation& seen,
                                                              const MeasurementContext& context);

/// A reading of the error state's own coordinates I…, as robot_localization's users have them: residual z [-]
/// x, with all three orientation columns or none. The value is given as a state of which the listed
/// coordinates count; R is its covariance, for the orientation in the tangent space at z. Moved to the
/// tangent space at x, by the left Jacobian of the residual (which leaves the residual itself alone), the
/// Jacobian becomes exactly the identity.
template <int N, int... I, class Covariance>
auto directMeasurement(const NavigationState<double>& x, const NavigationState<double>& z,
                       const Eigen::MatrixBase<Covariance>& R) {
  using Cols = Columns<I...>;
  typename ErrorStateFilter<N>::template Selection<Cols> m;
  const Eigen::Matrix<double, N, 1> all = vectorDifference<N>(z, x);
  for (int k = 0; k < Cols::size; ++k) m.residual[k] = all[Cols::list[static_cast<std::size_t>(k)]];
  m.R = R;
  constexpr int k = Cols::find(kOrientation);
  if constexpr (k >= 0) {
    static_assert(Cols::find(kOrientation + 1) == k + 1 && Cols::find(kOrientation + 2) == k + 2);
    const Vector3d r = attitudeDifference(z, x);
    m.residual.template segment<3>(k) = r;
    const Matrix3d J = rightJacobianSO3<double>(-r);  // the left Jacobian at r
    m.R.template middleRows<3>(k) = (J * m.R.template middleRows<3>(k)).eval();
    m.R.template middleCols<3>(k) = (m.R.template middleCols<3>(k) * J.transpose()).eval();
  }
  return m;
}

/// A pose of the robot, e.g. from a landmark.
template <int N>
auto poseMeasurement(const NavigationState<double>& x, const UncertainPose& T_odom_robot) {
  NavigationState<double> z;
  z.motion.position_odom = T_odom_robot.pose.position;
  z.motion.R_odom_robot = T_odom_robot.pose.rotation;
  return directMeasurement<N, 0, 1, 2, 3, 4, 5>(x, z, T_odom_robot.covariance);
}

}  // namespace fathom
