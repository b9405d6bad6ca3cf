#pragma once

#include "localization/error_state_filter.h"
#include "recording/samples.h"
#include "sensors/vehicle.h"

/// Readings as linearized measurements: the residual comes from the sensors' forward model (libs/sensors),
/// its Jacobian from running that model on Jets. To add a sensor, add its forward model there, a function
/// here, and a line in Fuser::fuse().
namespace fathom {

/// What a reading is judged against: the world, the calibration and the data sheet's noise.
struct MeasurementContext {
  Vector3d gravity_odom = World<double>{}.gravity_odom;
  EffectParameters<double> calibration;  ///< effects known to be there
  double t_s = 0.0;                      ///< the reading's time stamp, since the recording's first entry
};

/// Columns of the error state, without those that a filter of size N has not got.
template <int N>
struct SensorColumns {
  using Orientation = Columns<3, 4, 5>;
  // A gyro and a DVL sense the attitude where the Earth turns or the water flows.
  using Gyro = std::conditional_t<N == kFullSize, Columns<3, 4, 5, 9, 10, 11, 15, 16, 17>,
                                  Columns<3, 4, 5, 9, 10, 11>>;
  using Accelerometer =
      std::conditional_t<N == kFullSize, Columns<3, 4, 5, 9, 10, 11, 12, 13, 14, 18, 19, 20>,
                         Columns<3, 4, 5, 9, 10, 11, 12, 13, 14>>;
  using Dvl = Columns<3, 4, 5, 6, 7, 8, 9, 10, 11>;
  using Beam = std::conditional_t<N == kFullSize, Columns<2, 3, 4, 5, 22>, Columns<2, 3, 4, 5>>;
  using Depth = std::conditional_t<N == kFullSize, Columns<2, 3, 4, 5, 21>, Columns<2, 3, 4, 5>>;
  using Pose = Columns<0, 1, 2, 3, 4, 5>;
};

/// What each sensor's reading says of a state of N entries: residual, Jacobian, covariance.
template <int N>
struct SensorMeasurements {
  template <int M, class Cols>
  using Measurement = typename ErrorStateFilter<N>::template Measurement<M, Cols>;
  using Columns = SensorColumns<N>;

  static Measurement<3, typename Columns::Gyro> gyro(const NavigationState<double>& x,
                                                     const Vector3d& angular_velocity_ins,
                                                     const Pose& T_robot_ins, double sigma_rad_s,
                                                     const MeasurementContext& context);

  static Measurement<3, typename Columns::Accelerometer> accelerometer(const NavigationState<double>& x,
                                                                       const Vector3d& specific_force_ins,
                                                                       const Pose& T_robot_ins,
                                                                       double sigma_m_s2,
                                                                       const MeasurementContext& context);

  /// residual = Log(R_predicted^T R_measured), rad, INS axes; R is the covariance of that rotation vector.
  static Measurement<3, typename Columns::Orientation> attitude(const NavigationState<double>& x,
                                                                const Matrix3d& R_odom_ins,
                                                                const Pose& T_robot_ins,
                                                                const Matrix3d& covariance,
                                                                const MeasurementContext& context);

  static Measurement<3, typename Columns::Dvl> dvl(const NavigationState<double>& x,
                                                   const Vector3d& velocity_dvl, const Pose& T_robot_dvl,
                                                   const Vector3d& sigma_m_s,
                                                   const MeasurementContext& context);

  static Measurement<1, typename Columns::Beam> beam(const NavigationState<double>& x, double range_m,
                                                     const Pose& T_robot_dvl, const Pose& T_robot_beam,
                                                     double sigma_m, const MeasurementContext& context);

  static Measurement<1, typename Columns::Depth> depth(const NavigationState<double>& x, double pressure_pa,
                                                       const DepthSheet& sheet, const Pose& T_robot_depth,
                                                       const MeasurementContext& context);

  static Measurement<3, typename Columns::Pose> usbl(const NavigationState<double>& x,
                                                     const Vector3d& position_odom, const Pose& T_robot_usbl,
                                                     const Matrix3d& covariance);
};

/// A reading of the error state's own coordinates I…, as robot_localization's users have them: residual z [-]
/// x, with all three orientation columns or none. The value is given as a state of which the listed
/// coordinates count; R is its covariance, for the orientation in the tangent space at z. Moved to the
/// tangent space at x, by the left Jacobian of the residual (which leaves the residual itself alone), the
/// Jacobian becomes exactly the identity.
template <int N, int... I>
auto directMeasurement(const NavigationState<double>& x, const NavigationState<double>& z,
                       const Eigen::Matrix<double, sizeof...(I), sizeof...(I)>& R) {
  using Cols = Columns<I...>;
  typename ErrorStateFilter<N>::template Selection<Cols> m;
  const Eigen::Matrix<double, N, 1> all = difference<N>(z, x);
  for (int k = 0; k < Cols::size; ++k) m.residual[k] = all[Cols::list[static_cast<std::size_t>(k)]];
  m.R = R;
  constexpr int k = Cols::find(kOrientation);
  if constexpr (k >= 0) {
    static_assert(Cols::find(kOrientation + 1) == k + 1 && Cols::find(kOrientation + 2) == k + 2);
    const Vector3d r = m.residual.template segment<3>(k);
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

// The sensors' models run on Jets, and updates are unrolled: long to compile, so done once, in
// measurements.cpp.
extern template struct SensorMeasurements<kCoreSize>;
extern template struct SensorMeasurements<kFullSize>;
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Gyro>&, double);
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Accelerometer>&, double);
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Orientation>&, double);
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Dvl>&, double);
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<1, SensorColumns<kCoreSize>::Beam>&, double);
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Pose>&, double);
extern template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Selection<SensorColumns<kCoreSize>::Pose>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Gyro>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Accelerometer>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Orientation>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Dvl>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<1, SensorColumns<kFullSize>::Beam>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<1, SensorColumns<kFullSize>::Depth>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Pose>&, double);
extern template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Selection<SensorColumns<kFullSize>::Pose>&, double);

}  // namespace fathom
