#include "localization/landmark_monitor.h"

#include <algorithm>

#include "core/chi_square.h"
#include "core/linear_algebra.h"

namespace fathom {
namespace {

using Monitor = LandmarkMonitor;

/// The panel where the filter saw it stand still between two sightings, up to noise. `doubt`: odometry errors
/// that nobody knows of are allowed for.
bool agree(const JudgedFix& a, const JudgedFix& b, bool doubt) {
  const auto [panel_a, unused, by_sighting_a] = composed(a.T_odom_robot, a.T_robot_panel.pose);
  const auto [panel_b, by_robot, by_sighting_b] = composed(b.T_odom_robot, b.T_robot_panel.pose);
  Vector6d drift = (b.pose_variance - a.pose_variance).cwiseMax(0.0);
  if (doubt) {
    const double dt = b.t_s - a.t_s;
    drift.head<3>().array() += Monitor::kDoubt_m_s * dt * Monitor::kDoubt_m_s * dt;
    drift.tail<3>().array() += Monitor::kDoubt_rad_s * dt * Monitor::kDoubt_rad_s * dt;
  }
  const Matrix6d covariance = by_sighting_a * a.T_robot_panel.covariance * by_sighting_a.transpose() +
                              by_sighting_b * b.T_robot_panel.covariance * by_sighting_b.transpose() +
                              by_robot * drift.asDiagonal() * by_robot.transpose();
  const Vector6d difference = poseDifference(panel_a, panel_b);
  static const double kGate = chiSquareQuantile(6, 0.9999);
  return normalizedSquare(covariance, difference) <= kGate;
}

/// Whether a panel stands still in the filter's dead reckoning, by the slope of its pose over time.
bool standsStill(const std::vector<JudgedFix>& fixes) {
  const JudgedFix &first = fixes.front(), &last = fixes.back();
  const auto [T_odom_panel, by_robot, by_sighting] = composed(last.T_odom_robot, last.T_robot_panel.pose);
  double mean_s = 0.0, spread_s2 = 0.0;
  for (const JudgedFix& fix : fixes) mean_s += fix.t_s / static_cast<double>(fixes.size());
  Vector6d slope = Vector6d::Zero();
  for (const JudgedFix& fix : fixes) {
    slope += (fix.t_s - mean_s) * poseDifference(T_odom_panel, fix.T_odom_robot * fix.T_robot_panel.pose);
    spread_s2 += (fix.t_s - mean_s) * (fix.t_s - mean_s);
  }
  slope /= spread_s2;
  const double duration_s = last.t_s - first.t_s;
  const Vector6d drift = (last.pose_variance - first.pose_variance).cwiseMax(0.0) / (duration_s * duration_s);
  const Matrix6d covariance =
      by_sighting * last.T_robot_panel.covariance * by_sighting.transpose() / spread_s2 +
      by_robot * drift.asDiagonal() * by_robot.transpose();
  static const double kGate = chiSquareQuantile(6, 0.999);
  return normalizedSquare(covariance, slope) <= kGate;
}

}  // namespace

auto LandmarkMonitor::panel(int index) -> Panel& {
  const auto found =
      std::find_if(panels_.begin(), panels_.end(), [&](const Panel& known) { return known.index == index; });
  if (found != panels_.end()) return *found;
  panels_.emplace_back().index = index;
  return panels_.back();
}

void LandmarkMonitor::fused(int index, const JudgedFix& fix) {
  Panel& seen = panel(index);
  seen.streak.clear();
  ++seen.confirmations;
  seen.last_fused_s = fix.t_s;
  if (recent_innovations_.size() == kRecent) recent_innovations_.erase(recent_innovations_.begin());
  recent_innovations_.push_back(fix.whitened_innovation);
  ++confirmations_;
  shown_.clear();
  rejected_since_s_.reset();
  leading_ = false;
  last_fused_s_ = fix.t_s;
  variance_then_ = fix.pose_variance;
}

auto LandmarkMonitor::rejected(int index, const JudgedFix& fix) -> Judgement {
  Panel& seen = panel(index);
  auto& streak = seen.streak;
  const bool agrees = std::all_of(streak.begin(), streak.end(),
                                  [&](const JudgedFix& earlier) { return agree(earlier, fix, true); });
  if (!agrees) streak.clear();
  if (streak.size() == kAgreeing) streak.erase(streak.begin());
  streak.push_back(fix);
  rejected_since_s_ = rejected_since_s_.value_or(fix.t_s);
  const bool leads = plausible(fix) && fix.t_s - *rejected_since_s_ > kPatience_s;

  Judgement judgement{Verdict::outlier, static_cast<int>(streak.size()), streak.front().t_s, last_fused_s_,
                      leading_};
  if (judgement.agreeing >= enough()) judgement.verdict = verdict(seen, fix);
  if (judgement.verdict == Verdict::outlier && leads) judgement.verdict = Verdict::lead;
  if (judgement.verdict == Verdict::outlier) return judgement;
  streak.clear();
  leading_ = judgement.verdict == Verdict::lead;
  if (judgement.verdict == Verdict::panel_moved || judgement.verdict == Verdict::panel_restart)
    seen.confirmations = 0;
  return judgement;
}

/// How many fixes that agree are believed.
int LandmarkMonitor::enough() const {
  return by_fix_ ? std::clamp(confirmations_ + 1, 2, kAgreeing) : kAgreeing;
}

auto LandmarkMonitor::verdict(const Panel& seen, const JudgedFix& fix) const -> Verdict {
  if (fix.panel_is_estimated && seen.confirmations < kConfirming) return Verdict::panel_restart;
  if (!vouched(seen)) return Verdict::reacquire;
  return fix.panel_is_movable ? Verdict::panel_moved : Verdict::outlier;
}

/// Of the fixes by themselves: the filter is not asked.
bool LandmarkMonitor::plausible(const JudgedFix& fix) {
  const Pose T_odom_robot = fix.T_odom_panel * fix.T_robot_panel.pose.inverse();
  if (!shown_.empty()) {
    const double dt = fix.t_s - shown_.back().first;
    const Matrix6d& covariance = fix.T_robot_panel.covariance;
    const double turn_sigma_rad = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
    const double shift_sigma_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace()) +
                                 turn_sigma_rad * fix.T_robot_panel.pose.position.norm();
    const Vector6d step = poseDifference(shown_.back().second, T_odom_robot);
    if (step.head<3>().norm() > kPlausible_m_s * dt + 5.0 * shift_sigma_m ||
        step.tail<3>().norm() > kPlausible_rad_s * dt + 5.0 * turn_sigma_rad)
      shown_.clear();
  }
  if (shown_.size() == kAgreeing) shown_.erase(shown_.begin());
  shown_.emplace_back(fix.t_s, T_odom_robot);
  return shown_.size() == kAgreeing;
}

bool LandmarkMonitor::vouched(const Panel& seen) const {
  const JudgedFix &first = seen.streak.front(), &last = seen.streak.back();
  if (confirmations_ < kConfirming || !last_fused_s_) return false;
  const double gap_s = std::max(0.0, first.t_s - *last_fused_s_);
  if (gap_s > kVouching_s) return false;
  Vector6d pull = Vector6d::Zero(), push = Vector6d::Zero();
  for (const Vector6d& innovation : recent_innovations_)
    pull += innovation / static_cast<double>(recent_innovations_.size());
  for (const JudgedFix& fix : seen.streak)
    push += fix.whitened_innovation / static_cast<double>(seen.streak.size());
  if (push.norm() < kSudden * pull.norm()) return false;
  if (!standsStill(seen.streak)) return false;
  const bool another_too = std::any_of(panels_.begin(), panels_.end(), [&](const Panel& other) {
    return other.index != seen.index && other.streak.size() >= 2 && other.streak.back().t_s >= first.t_s &&
           other.last_fused_s.value_or(first.t_s - 1.0) < first.t_s;
  });
  if (another_too) return false;
  const Vector6d jump = poseDifference(last.T_odom_panel, last.T_odom_robot * last.T_robot_panel.pose);
  const Vector6d growth = (first.pose_variance - variance_then_).cwiseMax(0.0);
  const double distance_m = last.T_robot_panel.pose.position.norm();
  const double turn_rad = kDoubt_rad_s * gap_s + 3.0 * std::sqrt(growth.tail<3>().sum());
  const double shift_m = kDoubt_m_s * gap_s + 3.0 * std::sqrt(growth.head<3>().sum()) + distance_m * turn_rad;
  return jump.head<3>().norm() > shift_m || jump.tail<3>().norm() > turn_rad;
}

void LandmarkMonitor::startAnew() {
  for (Panel& known : panels_) known.streak.clear();
  confirmations_ = 0;
  by_fix_ = false;
  recent_innovations_.clear();
  last_fused_s_.reset();
}

}  // namespace fathom
