#pragma once

#include <array>
#include <bitset>
#include <limits>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "localization/error_state_filter.h"
#include "localization/landmark_fuser.h"
#include "localization/measurements.h"
#include "localization/noise_adaptation.h"
#include "localization/pose_fixes.h"
#include "recording/instrument_entries.h"

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
    const SymmetricFactors noise(R);
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
  std::array<Rejections, kChannelCount> rejected{};
  typename LandmarkFuser<N>::Memory landmarks;
  OdomFrame frame;
  NoiseAdaptation noise{N == kFullSize};
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
    context_.vehicle = &setup.vehicle;
    context_.calibration = setup.calibration;
    for (int dof = 1; dof <= 6; ++dof)
      gates_[static_cast<std::size_t>(dof)] = setup.options.gate.kind == Gate::Kind::chi_square
                                                  ? chiSquareQuantile(dof, setup.options.gate.probability)
                                                  : std::numeric_limits<double>::infinity();
    for (const Channel channel : setup.options.fuse) fused_.set(indexOf(channel));
    variance_times_.fill(1.0);
    for (const auto& [channel, times] : setup.options.sigma_times)
      variance_times_[indexOf(channel)] = times * times;
  }

  void fuse(GatedFilter<N>& state, const Sample& sample, double t_s, FusionLog& log) {
    ErrorStateFilter<N>& filter = state.filter;
    if (state.frame.defined().any() && meetFrame(state, sample, t_s, log)) return;
    context_.t_s = secondsBetween(setup_.time_zero, sample.time);
    const auto update = [&](Channel channel, const auto& m) {
      constexpr int M = std::remove_cvref_t<decltype(m.residual)>::RowsAtCompileTime;
      Rejections& rejected = state.rejected[indexOf(channel)];
      const double gate = gates_[M];
      const bool believed = rejected.in_a_row >= kRejectionsBelieved;
      const Update done = filter.update(m, believed ? kAlways : gate);
      if (done.nis <= gate)
        rejected.in_a_row = 0;
      else
        rejected.template add<M>(m.residual, m.R, gate);
      const Shown shown = shownBy(m, done, gate);
      log.innovations.push_back({t_s, channel, M, done.nis, done.fused, rejected.in_a_row, done.determinant,
                                 state.noise.contradicts(channel, shown, done.nis)});
      if (setup_.options.adapts_noise) state.noise.add(channel, shown);
    };
    forEachObservation(sample, setup_.vehicle, [&]<class C>(const Observation& seen) {
      if (!isTold<C>()) return;
      auto m = measure<N, C::channel.component_count>(filter.x, kChannel<C>, seen, context_);
      m.R *= variance_times_[indexOf(kChannel<C>)] * state.noise.varianceTimes(kChannel<C>);
      update(kChannel<C>, m);
    });
    if constexpr (N == kFullSize) widenBiases(state, log);
    if (!uses(kChannel<Landmark>)) return;
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading);
        pose && baseOf(sample.label) == labels::kMarkers)
      landmarks_.fuse(filter, state.landmarks, state.noise, *pose, t_s, log);
    if (const auto* panels = std::get_if<PanelSample>(&sample.reading))
      landmarks_.fuse(filter, state.landmarks, state.noise, *panels, t_s, log);
  }

  /// Where the filter is, and all of its fixes.
  std::vector<ReckonedFix> fixes(const GatedFilter<N>& state, const Sample& sample, double t_s) const {
    std::vector<ReckonedFix> reckoned;
    const auto& motion = state.filter.x.motion;
    for (PoseFix& fix : poseFixes(setup_, sample, t_s, motion))
      reckoned.push_back({std::move(fix), {motion.R_odom_robot, motion.position_odom}});
    return reckoned;
  }

  bool uses(Channel channel) const { return fused_[indexOf(channel)]; }
  typename LandmarkFuser<N>::Memory startLandmarks() const { return landmarks_.start(); }

 private:
  /// Where the sample tells what is a definition only. True: it is not to be fused. (What this filter does
  /// not fuse says where it starts, and nothing after that.)
  bool meetFrame(GatedFilter<N>& state, const Sample& sample, double t_s, FusionLog& log) const {
    bool used_up = false;
    for (const auto& [fix, T_odom_robot] : fixes(state, sample, t_s)) {
      if (!uses(fix.channel)) continue;
      const bool was_turned = state.frame.isTurned();
      const auto [move, is_used_up] = state.frame.meet(T_odom_robot, fix);
      if (!move) continue;
      used_up = used_up || is_used_up;
      state.filter.moveFrame(*move);
      log.frame_moves.push_back(*move);
      if (fix.tells.heading) LandmarkFuser<N>::startByFix(state.landmarks);
      if (was_turned && state.frame.isTurned()) continue;  // one more of many
      log.events.push_back({t_s, "frame-moved", textOf(*move, fix.by, state.frame)});
    }
    return used_up;
  }

  static std::string textOf(const FrameMove& move, const std::string& by, const OdomFrame& frame) {
    const Vector3d& shift = move.T_new_old.position;
    return by +
           print(" tells where odom is: moved by (%.3f, %.3f, %.3f) m, turned by %.2f deg", shift.x(),
                 shift.y(), shift.z(), degrees(logSO3<double>(move.T_new_old.rotation).z())) +
           (frame.isTurned() ? "; its heading is not known until the robot has come some way" : "");
  }

  void widenBiases(GatedFilter<N>& state, FusionLog& log) const {
    if (!setup_.options.adapts_noise) return;
    const std::vector<int> widened = state.noise.widenBiases(state.filter);
    log.anew.insert(log.anew.end(), widened.begin(), widened.end());
  }

  /// Without a state for the sea floor a range says nothing of the vehicle's height.
  template <class C>
  bool isTold() const {
    return (N == kFullSize || !C::channel.is_indirect) && uses(kChannel<C>);
  }

  static constexpr double kAlways = std::numeric_limits<double>::infinity();
  const LocalizationSetup& setup_;
  MeasurementContext context_;
  std::array<double, 7> gates_{};
  std::array<double, kChannelCount> variance_times_{};
  std::bitset<kChannelCount> fused_;
  LandmarkFuser<N> landmarks_;
};

}  // namespace fathom
