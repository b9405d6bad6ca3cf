#include "localization/measurements.h"

#include "sensors/models.h"

namespace fathom {
namespace {

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

}  // namespace

template <int N>
auto SensorMeasurements<N>::gyro(const NavigationState<double>& x, const Vector3d& angular_velocity_ins,
                                 const Pose& T_robot_ins, double sigma_rad_s,
                                 const MeasurementContext& context)
    -> Measurement<3, typename Columns::Gyro> {
  using Cols = typename Columns::Gyro;
  const auto y = lift<Cols>(x);
  return fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      angular_velocity_ins,
      predictGyro(y.motion, T_robot_ins, effectsOf(y, context.calibration, context.t_s), context.t_s),
      Matrix3d::Identity() * sigma_rad_s * sigma_rad_s);
}

template <int N>
auto SensorMeasurements<N>::accelerometer(const NavigationState<double>& x,
                                          const Vector3d& specific_force_ins, const Pose& T_robot_ins,
                                          double sigma_m_s2, const MeasurementContext& context)
    -> Measurement<3, typename Columns::Accelerometer> {
  using Cols = typename Columns::Accelerometer;
  const auto y = lift<Cols>(x);
  return fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      specific_force_ins,
      predictSpecificForce(y.motion, worldOf(y, context), T_robot_ins,
                           effectsOf(y, context.calibration, context.t_s), context.t_s),
      Matrix3d::Identity() * sigma_m_s2 * sigma_m_s2);
}

template <int N>
auto SensorMeasurements<N>::attitude(const NavigationState<double>& x, const Matrix3d& R_odom_ins,
                                     const Pose& T_robot_ins, const Matrix3d& covariance,
                                     const MeasurementContext& context)
    -> Measurement<3, typename Columns::Orientation> {
  using Cols = typename Columns::Orientation;
  using Jet = ceres::Jet<double, Cols::size>;
  const auto y = lift<Cols>(x);
  const Matrix3<Jet> predicted =
      predictAttitude(y.motion, T_robot_ins, effectsOf(y, context.calibration, context.t_s), context.t_s);
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
auto SensorMeasurements<N>::dvl(const NavigationState<double>& x, const Vector3d& velocity_dvl,
                                const Pose& T_robot_dvl, const Vector3d& sigma_m_s,
                                const MeasurementContext& context) -> Measurement<3, typename Columns::Dvl> {
  using Cols = typename Columns::Dvl;
  const auto y = lift<Cols>(x);
  return fromPrediction<ErrorStateFilter<N>, 3, Cols>(
      velocity_dvl,
      predictDvlVelocity(y.motion, T_robot_dvl, effectsOf(y, context.calibration, context.t_s), context.t_s),
      Matrix3d(sigma_m_s.cwiseAbs2().asDiagonal()));
}

template <int N>
auto SensorMeasurements<N>::beam(const NavigationState<double>& x, double range_m, const Pose& T_robot_dvl,
                                 const Pose& T_robot_beam, double sigma_m, const MeasurementContext& context)
    -> Measurement<1, typename Columns::Beam> {
  using Cols = typename Columns::Beam;
  using Jet = ceres::Jet<double, Cols::size>;
  const auto y = lift<Cols>(x);
  const Eigen::Matrix<Jet, 1, 1> prediction(
      predictBeamRange(y.motion, worldOf(y, context), T_robot_dvl, T_robot_beam,
                       effectsOf(y, context.calibration, context.t_s), context.t_s));
  return fromPrediction<ErrorStateFilter<N>, 1, Cols>(Eigen::Matrix<double, 1, 1>(range_m), prediction,
                                                      Eigen::Matrix<double, 1, 1>(sigma_m * sigma_m));
}

template <int N>
auto SensorMeasurements<N>::depth(const NavigationState<double>& x, double pressure_pa,
                                  const DepthSheet& sheet, const Pose& T_robot_depth,
                                  const MeasurementContext& context)
    -> Measurement<1, typename Columns::Depth> {
  using Cols = typename Columns::Depth;
  using Jet = ceres::Jet<double, Cols::size>;
  const auto y = lift<Cols>(x);
  const Eigen::Matrix<Jet, 1, 1> prediction(
      predictPressure(y.motion, worldOf(y, context), sheet, T_robot_depth,
                      effectsOf(y, context.calibration, context.t_s), context.t_s));
  return fromPrediction<ErrorStateFilter<N>, 1, Cols>(
      Eigen::Matrix<double, 1, 1>(pressure_pa), prediction,
      Eigen::Matrix<double, 1, 1>(sheet.pressure_sigma_pa * sheet.pressure_sigma_pa));
}

template <int N>
auto SensorMeasurements<N>::usbl(const NavigationState<double>& x, const Vector3d& position_odom,
                                 const Pose& T_robot_usbl, const Matrix3d& covariance)
    -> Measurement<3, typename Columns::Pose> {
  using Cols = typename Columns::Pose;
  const auto y = lift<Cols>(x);
  return fromPrediction<ErrorStateFilter<N>, 3, Cols>(position_odom, predictUsbl(y.motion, T_robot_usbl),
                                                      covariance);
}

template struct SensorMeasurements<kCoreSize>;
template struct SensorMeasurements<kFullSize>;
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Gyro>&, double);
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Accelerometer>&, double);
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Orientation>&, double);
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Dvl>&, double);
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<1, SensorColumns<kCoreSize>::Beam>&, double);
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Measurement<3, SensorColumns<kCoreSize>::Pose>&, double);
template double ErrorStateFilter<kCoreSize>::update(
    const ErrorStateFilter<kCoreSize>::Selection<SensorColumns<kCoreSize>::Pose>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Gyro>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Accelerometer>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Orientation>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Dvl>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<1, SensorColumns<kFullSize>::Beam>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<1, SensorColumns<kFullSize>::Depth>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Measurement<3, SensorColumns<kFullSize>::Pose>&, double);
template double ErrorStateFilter<kFullSize>::update(
    const ErrorStateFilter<kFullSize>::Selection<SensorColumns<kFullSize>::Pose>&, double);

}  // namespace fathom
