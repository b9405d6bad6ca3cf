#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <bitset>
#include <limits>

#include "core/chi_square.h"
#include "localization/error_state_filter.h"
#include "localization/landmark_fuser.h"
#include "localization/measurements.h"

/// What a reading does to the filter, gates included. Used within this room only.
namespace fathom {

/// A channel's readings that the gate has rejected one after the other, and that say the same.
struct Rejections {
  int in_a_row = 0;
  Vector3d residual = Vector3d::Zero();  ///< of the latest, in as many entries as it has

  /// Garbage is rejected too, again and again, but says something else each time; a filter that has gone
  /// astray sees the same contradiction, or one that grows. So a residual counts that is like the one before:
  /// the difference is within the gate of two readings' own noise, or a quarter of its size.
  template <int M>
  void add(const Eigen::Matrix<double, M, 1>& now, const Eigen::Matrix<double, M, M>& R, double gate) {
    const Eigen::LDLT<Eigen::Matrix<double, M, M>> noise(R);
    const Eigen::Matrix<double, M, 1> change = now - residual.template head<M>();
    const double changed = change.dot(noise.solve(change)), size = now.dot(noise.solve(now));
    constexpr double kLikeness = 0.25;
    const bool alike = in_a_row > 0 && (changed <= 2.0 * gate || changed <= kLikeness * kLikeness * size);
    in_a_row = alike ? in_a_row + 1 : 1;
    residual.template head<M>() = now;
  }
};

/// The filter with what it remembers of its gates: a late reading rewinds both.
template <int N>
struct GatedFilter {
  ErrorStateFilter<N> filter;
  std::array<Rejections, kAllChannels.size()> rejected{};
  typename LandmarkFuser<N>::Memory landmarks;
};

/// One rejected reading is an outlier. This many in a row that agree are a filter that has gone astray: the
/// channel is believed again until a reading passes the gate, so that a gate cannot lock the filter out for
/// good. (Of landmarks LandmarkFuser and LandmarkMonitor decide.)
inline constexpr int kRejectionsBelieved = 5;

/// Turns one sample into updates of a filter.
template <int N>
class Fuser {
 public:
  explicit Fuser(const LocalizationSetup& setup) : setup_(setup), landmarks_(setup) {
    context_.gravity_odom = setup.vehicle.gravityOdom();
    context_.calibration = setup.calibration;
    for (int dof = 1; dof <= 6; ++dof)
      gates_[static_cast<std::size_t>(dof)] = setup.options.gate.kind == Gate::Kind::chi_square
                                                  ? chiSquareQuantile(dof, setup.options.gate.probability)
                                                  : std::numeric_limits<double>::infinity();
    for (const Channel channel : setup.options.fuse) fused_.set(static_cast<std::size_t>(channel));
  }

  void fuse(GatedFilter<N>& state, const Sample& sample, double t_s, FusionLog& log) const {
    ErrorStateFilter<N>& filter = state.filter;
    MeasurementContext context = context_;
    context.t_s = secondsBetween(setup_.time_zero, sample.time);
    const auto update = [&](Channel channel, const auto& m) {
      constexpr int M = std::remove_cvref_t<decltype(m.residual)>::RowsAtCompileTime;
      Rejections& rejected = state.rejected[static_cast<std::size_t>(channel)];
      const double gate = gates_[M];
      const bool believed = rejected.in_a_row >= kRejectionsBelieved;
      const double nis = filter.update(m, believed ? kAlways : gate);
      if (nis <= gate)
        rejected.in_a_row = 0;
      else
        rejected.template add<M>(m.residual, m.R, gate);
      log.innovations.push_back({t_s, channel, M, nis, believed || nis <= gate, rejected.in_a_row});
    };
    if (const auto* ins = std::get_if<InsSample>(&sample.reading)) fuseIns(filter, *ins, context, update);
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading)) fuseDvl(filter, *dvl, context, update);
    if (const auto* beams = std::get_if<DvlBeamsSample>(&sample.reading))
      fuseBeams(filter, *beams, context, update);
    if (const auto* depth = std::get_if<DepthSample>(&sample.reading))
      fuseDepth(filter, *depth, context, update);
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading)) {
      if (sample.label == labels::kUsbl) fuseUsbl(filter, *pose, update);
      if (sample.label == labels::kMarkers && uses(Channel::landmark))
        landmarks_.fuse(filter, state.landmarks, *pose, t_s, log);
    }
    if (const auto* panels = std::get_if<PanelSample>(&sample.reading); panels && uses(Channel::landmark))
      landmarks_.fuse(filter, state.landmarks, *panels, t_s, log);
  }

  typename LandmarkFuser<N>::Memory startLandmarks() const { return landmarks_.start(); }

 private:
  bool uses(Channel channel) const { return fused_[static_cast<std::size_t>(channel)]; }

  template <class Update>
  void fuseIns(ErrorStateFilter<N>& f, const InsSample& s, const MeasurementContext& context,
               const Update& update) const {
    if (!setup_.vehicle.ins) return;
    const InsSheet& sheet = *setup_.vehicle.ins;
    if (s.angular_velocity_ins && uses(Channel::gyro))
      update(Channel::gyro, SensorMeasurements<N>::gyro(f.x, *s.angular_velocity_ins, s.T_robot_ins,
                                                        sheet.gyro_sigma_rad_s, context));
    if (s.specific_force_ins && uses(Channel::accelerometer))
      update(Channel::accelerometer,
             SensorMeasurements<N>::accelerometer(f.x, *s.specific_force_ins, s.T_robot_ins,
                                                  sheet.accelerometer_sigma_m_s2, context));
    if (s.R_odom_ins && sheet.attitude_sigma_rad && uses(Channel::attitude)) {
      const double variance = *sheet.attitude_sigma_rad * *sheet.attitude_sigma_rad;
      update(Channel::attitude, SensorMeasurements<N>::attitude(f.x, *s.R_odom_ins, s.T_robot_ins,
                                                                Matrix3d::Identity() * variance, context));
    }
  }

  template <class Update>
  void fuseDvl(ErrorStateFilter<N>& f, const DvlSample& s, const MeasurementContext& context,
               const Update& update) const {
    if (!setup_.vehicle.dvl || !s.velocity_dvl || !uses(Channel::dvl)) return;
    const DvlSheet& sheet = *setup_.vehicle.dvl;
    const Vector3d sigma(sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_xy_m_s,
                         sheet.velocity_sigma_z_m_s);
    update(Channel::dvl, SensorMeasurements<N>::dvl(f.x, *s.velocity_dvl, s.T_robot_dvl, sigma, context));
  }

  template <class Update>
  void fuseBeams(ErrorStateFilter<N>& f, const DvlBeamsSample& s, const MeasurementContext& context,
                 const Update& update) const {
    // Without a state for the sea floor a range says nothing of the vehicle's height.
    if (N != kFullSize || !setup_.vehicle.dvl || !uses(Channel::altitude)) return;
    const DvlSheet& sheet = *setup_.vehicle.dvl;
    for (const DvlBeam& beam : s.beams)
      if (beam.range_m)
        update(Channel::altitude,
               SensorMeasurements<N>::beam(f.x, *beam.range_m, sheet.T_robot_dvl, beam.T_robot_beam,
                                           sheet.range_sigma_m, context));
  }

  template <class Update>
  void fuseDepth(ErrorStateFilter<N>& f, const DepthSample& s, const MeasurementContext& context,
                 const Update& update) const {
    if (!setup_.vehicle.depth || !uses(Channel::depth)) return;
    update(Channel::depth,
           SensorMeasurements<N>::depth(f.x, s.pressure_pa, *setup_.vehicle.depth, s.T_robot_depth, context));
  }

  template <class Update>
  void fuseUsbl(ErrorStateFilter<N>& f, const PoseSample& s, const Update& update) const {
    if (!uses(Channel::usbl)) return;
    const Pose T_robot_usbl = setup_.vehicle.usbl ? setup_.vehicle.usbl->T_robot_usbl : Pose{};
    update(Channel::usbl,
           SensorMeasurements<N>::usbl(f.x, s.T_odom_robot.mean.position, T_robot_usbl,
                                       Matrix3d(s.T_odom_robot.covariance.topLeftCorner<3, 3>())));
  }

  static constexpr double kAlways = std::numeric_limits<double>::infinity();
  const LocalizationSetup& setup_;
  MeasurementContext context_;
  std::array<double, 7> gates_{};
  std::bitset<kAllChannels.size()> fused_;
  LandmarkFuser<N> landmarks_;
};

}  // namespace fathom
