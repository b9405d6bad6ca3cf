#pragma once

#include <limits>
#include <memory>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "core/text.h"
#include "localization/landmark_monitor.h"
#include "localization/measurements.h"
#include "localization/noise_adaptation.h"
#include "localization/pose_fixes.h"
#include "localization/result.h"
#include "localization/setup.h"

namespace fathom {

/// What fusing one reading had to say.
struct FusionLog {
  std::vector<Innovation> innovations;
  std::vector<Event> events;
  std::vector<std::pair<std::size_t, PanelMove>> moves;  ///< panel, move
  std::vector<FrameMove> frame_moves;                    ///< one after the other, before anything is fused
  std::vector<int> anew;                                 ///< error coordinates that were reset
  bool corrected = false;                                ///< the robot's pose or a panel's was put right

  /// As new, but for the memory it holds.
  void clear() {
    innovations.clear();
    events.clear();
    moves.clear();
    frame_moves.clear();
    anew.clear();
    corrected = false;
  }
};

/// What is remembered of landmarks from one to the next.
struct LandmarkMemory {
  static constexpr int kExact = -1, kUnseen = -2;
  std::vector<int> attached;  ///< of each panel: its index among the filter's attached poses, or one of these
  LandmarkMonitor monitor;
  int rejected_in_a_row = 0;
};

/// The landmark channel: sightings of panels, exact or to be estimated, and of robot poses from markers.
template <int N>
class LandmarkFuser {
 public:
  using Memory =
      std::shared_ptr<const LandmarkMemory>;  ///< shared by all states that no landmark lies between

  explicit LandmarkFuser(const LocalizationSetup& setup)
      : setup_(setup),
        gate_(setup.options.gate.kind == Gate::Kind::chi_square
                  ? chiSquareQuantile(6, setup.options.gate.probability)
                  : kAlways) {
    const auto times = setup.options.sigma_times.find(kChannel<Landmark>);
    if (times != setup.options.sigma_times.end()) variance_times_ = times->second * times->second;
  }

  Memory start() const {
    LandmarkMemory memory;
    for (const PanelPrior& panel : setup_.panels)
      memory.attached.push_back(isExact(panel) ? LandmarkMemory::kExact : LandmarkMemory::kUnseen);
    return std::make_shared<const LandmarkMemory>(std::move(memory));
  }

  /// The frame is where one fix says: see LandmarkMonitor.
  static void startByFix(Memory& shared, bool in_doubt = false) {
    LandmarkMemory memory = *shared;
    memory.monitor.startByFix(in_doubt);
    shared = std::make_shared<const LandmarkMemory>(std::move(memory));
  }

  void fuse(ErrorStateFilter<N>& filter, Memory& memory, NoiseAdaptation& noise, const PoseSample& markers,
            double t_s, FusionLog& log) const {
    fuseFix(filter, memory, noise, fixOf(markers), t_s, log);
  }
  void fuse(ErrorStateFilter<N>& filter, Memory& memory, NoiseAdaptation& noise, const PanelSample& sample,
            double t_s, FusionLog& log) const {
    for (const SeenPanel& seen : sample.panels) {
      if (seen.panel >= 0 && static_cast<std::size_t>(seen.panel) < setup_.panels.size())
        fuseFix(filter, memory, noise, {seen.panel, sample.T_robot_camera * seen.T_camera_panel, {}}, t_s,
                log);
      else
        log.events.push_back(
            {t_s, "unknown-panel",
             print("a sighting of panel %d, of which nothing is known; left out", seen.panel)});
    }
  }

 private:
  /// A fixed gate locks nobody out: after so many rejections in a row it lets pass until a fix is inside
  /// again.
  static constexpr int kFixedGatePatience = 5;
  static constexpr double kAlways = std::numeric_limits<double>::infinity(), kNever = -1.0;
  /// A mean over the markers of several panels, or of none that is known: as if of a panel at odom's origin.
  static constexpr int kNoPanel = -1;
  using Verdict = LandmarkMonitor::Verdict;

  struct Fix {
    int panel = kNoPanel;
    UncertainPose T_robot_panel;
    std::optional<UncertainPose> T_odom_robot;  ///< as it was given
  };

  static bool isExact(const PanelPrior& panel) {
    return panel.position_sigma_m == 0.0 && panel.angle_sigma_rad == 0.0;
  }
  const PanelPrior& prior(int panel) const { return setup_.panels[static_cast<std::size_t>(panel)]; }
  std::string nameOf(int panel) const { return panel == kNoPanel ? "markers" : "panel " + prior(panel).name; }

  Fix fixOf(const PoseSample& markers) const {
    const UncertainPose T_odom_robot = markersPose(setup_, markers);
    Fix fix{setup_.panels.size() == 1 ? 0 : kNoPanel, {}, T_odom_robot};
    const auto [T_robot_panel, J, unused] =
        between(T_odom_robot.pose, fix.panel == kNoPanel ? Pose{} : prior(fix.panel).T_odom_panel);
    fix.T_robot_panel = {T_robot_panel, J * T_odom_robot.covariance * J.transpose()};
    return fix;
  }

  static Pose robotOf(const ErrorStateFilter<N>& filter) {
    return {filter.x.motion.R_odom_robot, filter.x.motion.position_odom};
  }

  void fuseFix(ErrorStateFilter<N>& filter, Memory& shared, NoiseAdaptation& noise, Fix fix, double t_s,
               FusionLog& log) const {
    LandmarkMemory memory = *shared;
    const double times = variance_times_ * noise.varianceTimes(kChannel<Landmark>);
    fix.T_robot_panel.covariance *= times;
    if (fix.T_odom_robot) fix.T_odom_robot->covariance *= times;
    int* attached = fix.panel == kNoPanel ? nullptr : &memory.attached[static_cast<std::size_t>(fix.panel)];
    if (attached != nullptr && *attached == LandmarkMemory::kUnseen) {
      *attached = filter.attach(fix.T_robot_panel);
      fusePrior(filter, *attached, fix.panel, t_s, log);
    } else {
      fuseKnown(filter, memory, noise, fix, t_s, log);
    }
    shared = std::make_shared<const LandmarkMemory>(std::move(memory));
  }

  /// What was known of a panel that has just been seen for the first time.
  void fusePrior(ErrorStateFilter<N>& filter, int attached, int panel, double t_s, FusionLog& log) const {
    constexpr double kInfinite = 1e6;  // as good as
    const PanelPrior& known = prior(panel);
    const double position_sigma_m = std::min(known.position_sigma_m, kInfinite);
    const double angle_sigma_rad = std::min(known.angle_sigma_rad, kInfinite);
    if (position_sigma_m == kInfinite && angle_sigma_rad == kInfinite) return;
    UncertainPose T_odom_panel{known.T_odom_panel};
    T_odom_panel.covariance.diagonal() << Vector3d::Constant(position_sigma_m * position_sigma_m),
        Vector3d::Constant(angle_sigma_rad * angle_sigma_rad);
    const Vector6d offset = poseDifference(known.T_odom_panel, filter.attachedPose(attached).pose);
    const double nis = filter.updateAttached(attached, T_odom_panel, gate_).nis;
    if (nis > gate_)
      log.events.push_back(
          {t_s, "panel-prior",
           print("%s is seen %.3f m and %.2f deg from its prior pose (NIS %.0f, gate %.1f): the prior is "
                 "not believed",
                 nameOf(panel).c_str(), offset.head<3>().norm(), degrees(offset.tail<3>().norm()), nis,
                 gate_)});
  }

  void fuseKnown(ErrorStateFilter<N>& filter, LandmarkMemory& memory, NoiseAdaptation& noise, const Fix& fix,
                 double t_s, FusionLog& log) const {
    const int attached =
        fix.panel == kNoPanel ? LandmarkMemory::kExact : memory.attached[static_cast<std::size_t>(fix.panel)];
    const bool estimated = attached >= 0;
    const Pose T_odom_panel = estimated       ? filter.attachedPose(attached).pose
                              : fix.panel < 0 ? Pose{}
                                              : prior(fix.panel).T_odom_panel;
    const Pose T_odom_robot = T_odom_panel * fix.T_robot_panel.pose.inverse();
    const Vector6d off = poseDifference(robotOf(filter), T_odom_robot);
    JudgedFix judged{t_s,
                     robotOf(filter),
                     filter.P.diagonal().template head<6>(),
                     fix.T_robot_panel,
                     T_odom_panel,
                     whitenedInnovation(filter, attached, T_odom_panel, fix.T_robot_panel),
                     fix.panel != kNoPanel,
                     estimated};
    const bool patient = memory.rejected_in_a_row < kFixedGatePatience;
    const double gate = setup_.options.gate.kind != Gate::Kind::fixed || isInside(off) ? gate_ : kNever;
    const bool believed = setup_.options.gate.kind == Gate::Kind::fixed && !patient;
    if (!estimated && setup_.options.gate.kind == Gate::Kind::chi_square && isTooWide(filter)) {
      const double nis = updateByRobotPose(filter, fix, T_odom_panel, kNever).nis;
      if (nis <= gate) return restart(filter, memory, fix, judged, off, nis, log);
    }
    const Update done = estimated
                            ? filter.updateSighting(attached, fix.T_robot_panel, believed ? kAlways : gate)
                            : updateByRobotPose(filter, fix, T_odom_panel, believed ? kAlways : gate);
    const double nis = done.nis;
    const bool passed = nis <= gate;
    memory.rejected_in_a_row = passed ? 0 : memory.rejected_in_a_row + 1;
    const Shown shown = shownBySighting(estimated ? fix.T_robot_panel : robotPose(fix, T_odom_panel), done);
    log.innovations.push_back({t_s, kChannel<Landmark>, 6, nis, done.fused, memory.rejected_in_a_row,
                               done.determinant, noise.contradicts(kChannel<Landmark>, shown, nis)});
    // Of one that is rejected the monitor decides what is wrong: the fix, the filter or the panel.
    if (passed && setup_.options.adapts_noise) noise.add(kChannel<Landmark>, shown);
    if (setup_.options.gate.kind != Gate::Kind::chi_square) return;
    if (passed) {
      judged.pose_variance = filter.P.diagonal().template head<6>();
      memory.monitor.fused(fix.panel, judged);
    } else {
      actOn(memory.monitor.rejected(fix.panel, judged), filter, memory, fix, judged, off, nis, log);
    }
  }

  static Update updateByRobotPose(ErrorStateFilter<N>& filter, const Fix& fix, const Pose& T_odom_panel,
                                  double gate) {
    return filter.update(poseMeasurement<N>(filter.x, robotPose(fix, T_odom_panel)), gate);
  }
  static UncertainPose robotPose(const Fix& fix, const Pose& T_odom_panel) {
    return fix.T_odom_robot.value_or(T_odom_panel * fix.T_robot_panel.inverse());
  }

  /// Whether the orientation may be off by more than a linear update bears: it would turn what is known of
  /// position and velocity by that much, and take the turn for knowledge.
  static bool isTooWide(const ErrorStateFilter<N>& filter) {
    constexpr double kWidest_rad = radians(25.0);
    return filter.P.diagonal().template segment<3>(kOrientation).sum() > kWidest_rad * kWidest_rad;
  }

  /// How fast a vehicle of which nothing is known moves, each axis: m/s, rad/s, m/s².
  static constexpr std::array<std::pair<int, double>, 3> kMotionAtRest{
      {{kVelocity, 0.5}, {kAngularVelocity, 0.2}, {kAcceleration, 0.3}}};

  /// Where the filter knows less of its motion than that.
  static void restartMotion(ErrorStateFilter<N>& filter, int block, double sigma, FusionLog& log) {
    if (filter.P.diagonal().template segment<3>(block).sum() < 3.0 * sigma * sigma) return;
    filter.resetMotion(block, sigma);
    for (int row = block; row < block + 3; ++row) log.anew.push_back(row);
  }

  /// The first fix after a time in which the pose has become anyone's guess sets it.
  void restart(ErrorStateFilter<N>& filter, LandmarkMemory& memory, const Fix& fix, JudgedFix& judged,
               const Vector6d& off, double nis, FusionLog& log) const {
    const double angle_sigma_rad = std::sqrt(filter.P.diagonal().template segment<3>(kOrientation).sum());
    reacquire(filter, memory, fix, log);
    log.corrected = false;  // nothing contradicts anything
    for (const auto& [block, sigma] : kMotionAtRest) restartMotion(filter, block, sigma, log);
    log.innovations.push_back({judged.t_s, kChannel<Landmark>, 6, nis, true, 0});
    log.events.push_back(
        {judged.t_s, "reacquired",
         print("%s: the orientation's own sigma had grown to %.0f deg: pose set by this fix, "
               "%.3f m and %.2f deg from where it was",
               nameOf(fix.panel).c_str(), degrees(angle_sigma_rad), off.head<3>().norm(),
               degrees(off.tail<3>().norm()))});
    judged.pose_variance = filter.P.diagonal().template head<6>();
    memory.monitor.fused(fix.panel, judged);
  }

  /// Of the robot's pose. (An estimated panel's correlation with the robot is left out: whiter than white.)
  static Vector6d whitenedInnovation(const ErrorStateFilter<N>& filter, int attached,
                                     const Pose& T_odom_panel, const UncertainPose& T_robot_panel) {
    const UncertainPose T_panel_robot = T_robot_panel.inverse();
    const auto [T_odom_robot, wrt_panel, wrt_sighting] = composed(T_odom_panel, T_panel_robot.pose);
    Matrix6d S = filter.P.template topLeftCorner<6, 6>() +
                 wrt_sighting * T_panel_robot.covariance * wrt_sighting.transpose();
    if (attached >= 0) S += wrt_panel * filter.attachedPose(attached).covariance * wrt_panel.transpose();
    return lowerWhitener(S).value_or(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN())) *
           poseDifference(robotOf(filter), T_odom_robot);
  }

  bool isInside(const Vector6d& off) const {
    return off.head<3>().norm() <= setup_.options.gate.max_position_m &&
           off.tail<3>().norm() <= setup_.options.gate.max_angle_rad;
  }

  void actOn(const LandmarkMonitor::Judgement& judgement, ErrorStateFilter<N>& filter, LandmarkMemory& memory,
             const Fix& fix, const JudgedFix& judged, const Vector6d& off, double nis, FusionLog& log) const {
    const std::string who = nameOf(fix.panel);
    const std::string offset =
        print("%.3f m and %.2f deg", off.head<3>().norm(), degrees(off.tail<3>().norm()));
    switch (judgement.verdict) {
      case Verdict::outlier:
        log.events.push_back(
            {judged.t_s, "fix-rejected",
             print("%s: a fix %s from the prediction (NIS %.0f, gate %.1f); %d in a row that "
                   "agree with each other",
                   who.c_str(), offset.c_str(), nis, gate_, judgement.agreeing)});
        return;
      case Verdict::reacquire:
        reacquire(filter, memory, fix, log);
        log.events.push_back(
            {judged.t_s, "reacquired",
             print("%s: %d fixes agree with each other and not with the filter, which had %s: pose set by "
                   "them, %s from where it was",
                   who.c_str(), judgement.agreeing,
                   judgement.last_fused_s
                       ? print("fused none for %.1f s", judged.t_s - *judgement.last_fused_s).c_str()
                       : "fused none before",
                   offset.c_str())});
        return;
      case Verdict::lead:
        reacquire(filter, memory, fix, log);
        if (!judgement.leads_already)
          log.events.push_back(
              {judged.t_s, "reacquired",
               print(
                   "%s: for more than %.0f s fixes have contradicted the other sensors and been plausible by "
                   "themselves: they set the pose until the filter agrees, %s from where it was",
                   who.c_str(), LandmarkMonitor::kPatience_s, offset.c_str())});
        return;
      case Verdict::panel_moved:
        return notePanelMove(judgement, filter, memory, fix, judged, log);
      case Verdict::panel_restart:
        startPanelAnew(filter, memory, fix, log);
        log.events.push_back({judged.t_s, "panel-restarted",
                              print("%s: first sighted wrongly, by %s; its estimate starts anew", who.c_str(),
                                    offset.c_str())});
        return;
    }
  }

  void reacquire(ErrorStateFilter<N>& filter, LandmarkMemory& memory, const Fix& fix, FusionLog& log) const {
    const int attached =
        fix.panel == kNoPanel ? LandmarkMemory::kExact : memory.attached[static_cast<std::size_t>(fix.panel)];
    if (attached < 0 && memory.monitor.isByFix()) return startAgain(filter, memory, fix, log);
    if (attached >= 0)
      filter.resetPose(attached, fix.T_robot_panel);
    else
      filter.resetPose(fix.panel == kNoPanel ? Pose{} : prior(fix.panel).T_odom_panel, fix.T_robot_panel);
    memory.monitor.startAnew();
    for (int row = kPosition; row < kVelocity; ++row) log.anew.push_back(row);
    log.corrected = true;
  }

  /// The fix that told where odom is was false, and with it all of the path before.
  void startAgain(ErrorStateFilter<N>& filter, LandmarkMemory& memory, const Fix& fix, FusionLog& log) const {
    const UncertainPose there =
        robotPose(fix, fix.panel == kNoPanel ? Pose{} : prior(fix.panel).T_odom_panel);
    const FrameMove move = moveTo(there.pose, robotOf(filter), {true, true, true});
    filter.moveFrame(move);
    log.frame_moves.push_back(move);
    filter.update(poseMeasurement<N>(filter.x, there), kAlways);
    memory.monitor.startAnew();
    memory.monitor.startByFix(false);
    log.corrected = true;
  }

  void startPanelAnew(ErrorStateFilter<N>& filter, LandmarkMemory& memory, const Fix& fix,
                      FusionLog& log) const {
    int& attached = memory.attached[static_cast<std::size_t>(fix.panel)];
    if (attached < 0) {
      attached = filter.attach(fix.T_robot_panel);
      return;
    }
    filter.attachAnew(attached, fix.T_robot_panel);
    for (int row = 0; row < 6; ++row) log.anew.push_back(N + 6 * attached + row);
  }

  void notePanelMove(const LandmarkMonitor::Judgement& judgement, ErrorStateFilter<N>& filter,
                     LandmarkMemory& memory, const Fix& fix, const JudgedFix& judged, FusionLog& log) const {
    const int before = memory.attached[static_cast<std::size_t>(fix.panel)];
    // The panel as it is now, as one more state beside what it was: their offset with all correlations.
    ErrorStateFilter<N> both = filter;
    const int now = both.attach(fix.T_robot_panel);
    const UncertainPose T_odom_now = both.attachedPose(now);
    const auto [T_before_now, wrt_before, wrt_now] = between(judged.T_odom_panel, T_odom_now.pose);
    Matrix6d covariance = wrt_now * T_odom_now.covariance * wrt_now.transpose();
    if (before >= 0) {
      const Matrix6d cross = both.attached.block.template block<6, 6>(6 * before, 6 * now);
      const Matrix6d mixed = wrt_before * cross * wrt_now.transpose();
      covariance += wrt_before * both.attachedPose(before).covariance * wrt_before.transpose() + mixed +
                    mixed.transpose();
    }
    startPanelAnew(filter, memory, fix, log);
    log.corrected = true;
    log.moves.push_back(
        {static_cast<std::size_t>(fix.panel), {judgement.since_s, {T_before_now, covariance}}});
    const Vector3d& offset = T_before_now.position;
    const Vector3d turn = logSO3<double>(T_before_now.rotation) * degrees(1.0);
    const Vector6d sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    log.events.push_back(
        {judged.t_s, "panel-moved",
         print(
             "%s has moved, first seen at %.2f s: by (%.3f, %.3f, %.3f) m, sigma (%.3f, %.3f, %.3f); turned "
             "by (%.2f, %.2f, %.2f) deg, sigma (%.2f, %.2f, %.2f), in its own axes. It is estimated from now "
             "on",
             nameOf(fix.panel).c_str(), judgement.since_s, offset.x(), offset.y(), offset.z(), sigma[0],
             sigma[1], sigma[2], turn.x(), turn.y(), turn.z(), degrees(sigma[3]), degrees(sigma[4]),
             degrees(sigma[5]))});
  }

  const LocalizationSetup& setup_;
  double gate_;
  double variance_times_ = 1.0;
};

}  // namespace fathom
