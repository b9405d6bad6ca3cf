#include "ros_bag/transform_checks.h"

#include <algorithm>

#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {

/// Halfway in time, or where the neighbours are of one time the first.
std::optional<PosesApart> offNeighbours(const StampedPose& before, const StampedPose& at,
                                        const StampedPose& after) {
  const auto between = before.time == after.time ? before.T_odom_robot : poseAt({before, after}, at.time);
  return between ? std::optional(apart(*between, at.T_odom_robot)) : std::nullopt;
}

}  // namespace

std::string PosesApart::text() const { return print("%.3g m and %.3g deg", m, deg); }

PosesApart apart(const Pose& a, const Pose& b) {
  return {(a.position - b.position).norm(), degrees(angleBetween(a.rotation, b.rotation))};
}

PosesApart largest(const PosesApart& a, const PosesApart& b) {
  return {std::max(a.m, b.m), std::max(a.deg, b.deg)};
}

std::optional<JumpingPoses> jumpingPoses(const std::vector<StampedPose>& poses) {
  constexpr double kFar_m = 0.05, kFar_deg = 1, kBeyondMotion = 3, kShare = 0.02;
  constexpr std::size_t kFewest = 10;
  std::vector<double> off_m, off_deg;
  for (std::size_t k = 1; k + 1 < poses.size(); ++k) {
    const auto off = offNeighbours(poses[k - 1], poses[k], poses[k + 1]);
    const PosesApart motion = apart(poses[k - 1].T_odom_robot, poses[k + 1].T_odom_robot);
    if (!off || !off->exceeds(std::max(kFar_m, kBeyondMotion * motion.m),
                              std::max(kFar_deg, kBeyondMotion * motion.deg)))
      continue;
    off_m.push_back(off->m);
    off_deg.push_back(off->deg);
  }
  if (off_m.size() < kFewest ||
      static_cast<double>(off_m.size()) < kShare * static_cast<double>(poses.size()))
    return {};
  return JumpingPoses{off_m.size(), {upperMedian(off_m), upperMedian(off_deg)}};
}

}  // namespace fathom
