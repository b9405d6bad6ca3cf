#pragma once

#include "localization/error_state_filter.h"
#include "recording/samples.h"
#include "sensors/models.h"

/// Readings as linearized measurements: the residual comes from the sensors' forward model (libs/sensors),
/// its Jacobian from running that model on Jets. To add a sensor, add its forward model there, a function
/// here, and a line in Localizer::fuse().
namespace fathom {

/// What a reading is judged against: the world, the calibration and the data sheet's noise.
struct MeasurementContext {
  Vector3d gravity_odom{0.0, 0.0, -9.80665};
  EffectParameters<double> calibration;  ///< effects known to be there
};

namespace detail {

/// residual = z - h(x), H = dh/d(error), from h evaluated on Jets.
template <class Filter, int M, class Cols>
typename Filter::template Measurement<M, Cols> fromPrediction(
    const Eigen::Matrix<double, M, 1>& z,
    const Eigen::Matrix<ceres::Jet<double, Cols::size>, M, 1>& prediction,
    const Eigen::Matrix<double, M, M>& R) {
  typename Filter::template Measurement<M, Cols> m;
  for (int i = 0; i < M; ++i) {
    m.residual[i] = z[i] - prediction[i].a;
    m.H.row(i) = prediction[i].v.transpose();
  }
  m.R = R;
  return m;
}

/// The world as the filter sees it: the sea floor is one of its states.
template <class T>
World<T> worldOf(const NavigationState<T>& x, const MeasurementContext& context) {
  return {context.gravity_odom, x.sea_floor_z_m};
}

}  // namespace detail

/// Columns of the error state, without those that a filter of size N has not got.
template <int N>
struct SensorColumns {
  using Orientation = Columns<3, 4, 5>;
  using Gyro = std::conditional_t<N == kFullSize, Columns<9, 10, 11, 15, 16, 17>, Columns<9, 10, 11>>;
  using Accelerometer =
      std::conditional_t<N == kFullSize, Columns<3, 4, 5, 9, 10, 11, 12, 13, 14, 18, 19, 20>,
                         Columns<3, 4, 5, 9, 10, 11, 12, 13, 14>>;
  using Dvl = Columns<6, 7, 8, 9, 10, 11>;
  using Beam = std::conditional_t<N == kFullSize, Columns<2, 3, 4, 5, 22>, Columns<2, 3, 4, 5>>;
  using Depth = std::conditional_t<N == kFullSize, Columns<2, 3, 4, 5, 21>, Columns<2, 3, 4, 5>>;
  using Pose = Columns<0, 1, 2, 3, 4, 5>;
};

template <int N>
auto gyroMeasurement(const NavigationState<double>& x, const Vector3d& angular_velocity_ins,
                     const Pose& T_robot_ins, double sigma_rad_s, const MeasurementContext& context) {
  using Cols = typename SensorColumns<N>::Gyro;
  const auto y = lift<Cols>(x);
  return detail::fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      angular_velocity_ins, predictGyro(y.motion, T_robot_ins, effectsOf(y, context.calibration)),
      Matrix3d::Identity() * sigma_rad_s * sigma_rad_s);
}

template <int N>
auto accelerometerMeasurement(const NavigationState<double>& x, const Vector3d& specific_force_ins,
                              const Pose& T_robot_ins, double sigma_m_s2, const MeasurementContext& context) {
  using Cols = typename SensorColumns<N>::Accelerometer;
  const auto y = lift<Cols>(x);
  return detail::fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      specific_force_ins,
      predictSpecificForce(y.motion, detail::worldOf(y, context), T_robot_ins,
                           effectsOf(y, context.calibration)),
      Matrix3d::Identity() * sigma_m_s2 * sigma_m_s2);
}

/// residual = Log(R_predicted^T R_measured), rad, INS axes; R is the covariance of that rotation vector.
template <int N>
auto attitudeMeasurement(const NavigationState<double>& x, const Matrix3d& R_odom_ins,
                         const Pose& T_robot_ins, const Matrix3d& covariance,
                         const MeasurementContext& context) {
  using Cols = typename SensorColumns<N>::Orientation;
  using Jet = ceres::Jet<double, Cols::size>;
  const auto y = lift<Cols>(x);
  const Matrix3<Jet> predicted = predictAttitude(y.motion, T_robot_ins, effectsOf(y, context.calibration));
  const Vector3<Jet> residual = logSO3<Jet>(predicted.transpose() * R_odom_ins.cast<Jet>());
  typename ErrorStateFilter<N>::template Measurement<3, Cols> m;
  for (int i = 0; i < 3; ++i) {
    m.residual[i] = residual[i].a;
    m.H.row(i) = -residual[i].v.transpose();
  }
  m.R = covariance;
  return m;
}

template <int N>
auto dvlMeasurement(const NavigationState<double>& x, const Vector3d& velocity_dvl, const Pose& T_robot_dvl,
                    const Vector3d& sigma_m_s, const MeasurementContext& context) {
  using Cols = typename SensorColumns<N>::Dvl;
  const auto y = lift<Cols>(x);
  return detail::fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      velocity_dvl, predictDvlVelocity(y.motion, T_robot_dvl, effectsOf(y, context.calibration)),
      Matrix3d(sigma_m_s.cwiseAbs2().asDiagonal()));
}

template <int N>
auto beamMeasurement(const NavigationState<double>& x, double range_m, const Pose& T_robot_dvl,
                     const Pose& T_robot_beam, double sigma_m, const MeasurementContext& context) {
  using Cols = typename SensorColumns<N>::Beam;
  using Jet = ceres::Jet<double, Cols::size>;
  const auto y = lift<Cols>(x);
  const Eigen::Matrix<Jet, 1, 1> prediction(predictBeamRange(
      y.motion, detail::worldOf(y, context), T_robot_dvl, T_robot_beam, effectsOf(y, context.calibration)));
  return detail::fromPrediction<ErrorStateFilter<N>, 1, Cols>(
      Eigen::Matrix<double, 1, 1>(range_m), prediction, Eigen::Matrix<double, 1, 1>(sigma_m * sigma_m));
}

template <int N>
auto depthMeasurement(const NavigationState<double>& x, double pressure_pa, const DepthSheet& sheet,
                      const Pose& T_robot_depth, const MeasurementContext& context) {
  using Cols = typename SensorColumns<N>::Depth;
  using Jet = ceres::Jet<double, Cols::size>;
  const auto y = lift<Cols>(x);
  const Eigen::Matrix<Jet, 1, 1> prediction(predictPressure(
      y.motion, detail::worldOf(y, context), sheet, T_robot_depth, effectsOf(y, context.calibration)));
  return detail::fromPrediction<ErrorStateFilter<N>, 1, Cols>(
      Eigen::Matrix<double, 1, 1>(pressure_pa), prediction,
      Eigen::Matrix<double, 1, 1>(sheet.pressure_sigma_pa * sheet.pressure_sigma_pa));
}

template <int N>
auto usblMeasurement(const NavigationState<double>& x, const Vector3d& position_odom,
                     const Pose& T_robot_usbl, const Matrix3d& covariance) {
  using Cols = typename SensorColumns<N>::Pose;
  const auto y = lift<Cols>(x);
  return detail::fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      position_odom, predictUsbl(y.motion, T_robot_usbl), covariance);
}

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

/// A pose T_odom_robot with MRPT covariance (x y z yaw pitch roll), e.g. from a landmark.
template <int N>
auto poseMeasurement(const NavigationState<double>& x, const mrpt::poses::CPose3DPDFGaussian& T_odom_robot) {
  NavigationState<double> z;
  const Pose pose = Pose::fromMrpt(T_odom_robot.mean);
  z.motion.position_odom = pose.position;
  z.motion.R_odom_robot = pose.rotation;
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Identity();
  J.bottomRightCorner<3, 3>() = bodyRotationFromYawPitchRoll(yawPitchRollFromRotation(pose.rotation));
  return directMeasurement<N, 0, 1, 2, 3, 4, 5>(x, z, J * T_odom_robot.cov.asEigen() * J.transpose());
}

}  // namespace fathom
