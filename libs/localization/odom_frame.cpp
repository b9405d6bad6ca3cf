#include "localization/odom_frame.h"

#include <algorithm>
#include <cmath>

#include "core/chi_square.h"
#include "core/linear_algebra.h"

namespace fathom {
namespace {

/// As good as no knowledge: what a fix then tells stays its own. The heading's is no wider than a linear
/// update bears; the frame is turned to where the fix is before it.
constexpr double kUnknown_m = 100.0, kUnknown_rad = radians(20.0);
/// The heading is told by a path once it tells it this well.
constexpr double kTurn_rad = radians(5.0);
/// What dead reckoning may be off by within seconds.
constexpr double kReckoning_m_s = 0.05, kReckoning_rad_s = 0.01;

/// The turn about z that comes nearest to a rotation.
double turnAboutUp(const Matrix3d& R) { return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1)); }

Matrix3d aboutUp(double turn_rad) { return rotationFromYawPitchRoll(turn_rad, 0, 0); }

FrameCoordinates both(const FrameCoordinates& a, const FrameCoordinates& b) {
  return {a.position && b.position, a.height && b.height, a.heading && b.heading};
}

/// The turn and shift that lay one set of points in the plane upon another.
struct PlaneFit {
  double turn_rad = 0.0, turn_sigma_rad = std::numeric_limits<double>::infinity();
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();  ///< their centres
  double sigma_m = 0.0;                                                          ///< of the centre

  Eigen::Vector2d residual(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    return b - to - Eigen::Rotation2Dd(turn_rad) * (a - from);
  }
};

template <class Places>
PlaneFit fitPlane(const Places& places) {
  PlaneFit fit;
  double weights = 0.0;
  for (const auto& place : places) {
    const double weight = 1.0 / (place.sigma_m * place.sigma_m);
    fit.from += weight * place.reckoned;
    fit.to += weight * place.fixed;
    weights += weight;
  }
  fit.from /= weights;
  fit.to /= weights;
  fit.sigma_m = 1.0 / std::sqrt(weights);
  double along = 0.0, across = 0.0, spread = 0.0;
  for (const auto& place : places) {
    const double weight = 1.0 / (place.sigma_m * place.sigma_m);
    const Eigen::Vector2d a = place.reckoned - fit.from, b = place.fixed - fit.to;
    along += weight * a.dot(b);
    across += weight * (a.x() * b.y() - a.y() * b.x());
    spread += weight * a.squaredNorm();
  }
  fit.turn_rad = std::atan2(across, along);
  if (spread > 0.0) fit.turn_sigma_rad = 1.0 / std::sqrt(spread);
  return fit;
}

/// The same, leaving out one after the other what does not fit.
template <class Places>
PlaneFit fitRobustly(Places places) {
  static const double kGate = chiSquareQuantile(2, 0.999);
  for (;;) {
    PlaneFit fit = fitPlane(places);
    const auto misfit = [&](const auto& place) {
      return fit.residual(place.reckoned, place.fixed).squaredNorm() / (place.sigma_m * place.sigma_m);
    };
    const auto worst = std::max_element(places.begin(), places.end(),
                                        [&](const auto& a, const auto& b) { return misfit(a) < misfit(b); });
    constexpr std::size_t kLeast = 3;
    if (places.size() <= kLeast || misfit(*worst) <= kGate) return fit;
    places.erase(worst);
  }
}

/// Every second of a list that has become long.
template <class List>
void thinOut(List& list) {
  constexpr std::size_t kMost = 400;
  if (list.size() < kMost) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size(); i += 2) list[kept++] = list[i];
  list.resize(kept);
}

}  // namespace

FrameMove moveTo(const Pose& there, const Pose& T_odom_robot, const FrameCoordinates& free) {
  FrameMove move;
  if (free.heading)
    move.T_new_old.rotation = aboutUp(turnAboutUp(there.rotation * T_odom_robot.rotation.transpose()));
  // About the robot: coordinates that are not free stay as they are.
  Vector3d to = T_odom_robot.position;
  if (free.position) to.head<2>() = there.position.head<2>();
  if (free.height) to.z() = there.position.z();
  move.T_new_old.position = to - move.T_new_old.rotation * T_odom_robot.position;
  move.pivot_new = to;
  const double horizontal_m = free.position ? kUnknown_m : 0.0;
  move.sigma << horizontal_m, horizontal_m, free.height ? kUnknown_m : 0.0, free.heading ? kUnknown_rad : 0.0;
  return move;
}

auto OdomFrame::meet(const Pose& T_odom_robot, const PoseFix& fix) -> Meeting {
  const FrameCoordinates free = both(defined_, fix.tells);
  if (!free.any()) return {};
  if (free.position && defined_.heading && !fix.tells.heading) return shift(T_odom_robot, fix);
  defined_.position = defined_.position && !free.position;
  defined_.height = defined_.height && !free.height;
  defined_.heading = defined_.heading && !free.heading;
  if (!defined_.heading) track_.reset();
  return {moveTo(fix.T_odom_robot.pose, T_odom_robot, free), false};
}

/// A position, while the heading is a definition.
auto OdomFrame::shift(const Pose& T_odom_robot, const PoseFix& fix) -> Meeting {
  auto track = track_ ? std::make_shared<Track>(*track_) : std::make_shared<Track>();
  const Vector3d &here = T_odom_robot.position, &there = fix.T_odom_robot.pose.position;
  thinOut(*track);
  track->push_back({here.head<2>() - shifted_, there.head<2>(),
                    std::sqrt(fix.T_odom_robot.covariance.diagonal().head<2>().maxCoeff())});
  track_ = track;
  const PlaneFit fit = fitRobustly(*track);
  const FrameCoordinates free = both(defined_, fix.tells);
  defined_.height = defined_.height && !free.height;
  if (fit.turn_sigma_rad > kTurn_rad) {
    shifted_ += there.head<2>() - here.head<2>();
    return {moveTo(fix.T_odom_robot.pose, T_odom_robot, free), false};
  }
  FrameMove move;
  move.T_new_old.rotation = aboutUp(fit.turn_rad);
  move.pivot_new << fit.to, here.z();
  Vector3d centre;
  centre << fit.from + shifted_, here.z();
  move.T_new_old.position = move.pivot_new - move.T_new_old.rotation * centre;
  move.sigma << fit.sigma_m, fit.sigma_m, 0.0, fit.turn_sigma_rad;
  defined_ = {};
  track_.reset();
  return {move, true};
}

namespace {

/// By the way from one to the other: nothing else of the frame is asked.
bool confirm(const ReckonedFix& a, const ReckonedFix& b) {
  if (a.fix.tells.heading != b.fix.tells.heading || a.fix.tells.position != b.fix.tells.position)
    return false;
  const Pose& there = b.fix.T_odom_robot.pose;
  const double dt = b.fix.t_s - a.fix.t_s;
  Matrix6d covariance = a.fix.T_odom_robot.covariance + b.fix.T_odom_robot.covariance;
  covariance.diagonal().head<3>().array() += kReckoning_m_s * dt * kReckoning_m_s * dt;
  covariance.diagonal().tail<3>().array() += kReckoning_rad_s * dt * kReckoning_rad_s * dt;
  static const double kPlaneGate = chiSquareQuantile(2, 0.9999), kPoseGate = chiSquareQuantile(6, 0.9999);
  if (a.fix.tells.heading) {
    const Pose way = a.T_odom_robot.inverse() * b.T_odom_robot;
    return normalizedSquare(covariance, poseDifference(a.fix.T_odom_robot.pose * way, there)) <= kPoseGate;
  }
  const Vector3d way = b.T_odom_robot.position - a.T_odom_robot.position;
  const Vector3d off = there.position - a.fix.T_odom_robot.pose.position - way;
  return normalizedSquare(covariance.topLeftCorner<2, 2>(), off.head<2>()) <= kPlaneGate;
}

/// What is known of the frame by one fix at the start: the fix itself will be fused too, so that it counts
/// for a tenth of what it tells.
Eigen::Vector4d sigmaByOne(const PoseFix& fix, const FrameMove& move) {
  constexpr double kWider = 3.0, kLeast_m = 0.05, kLeast_rad = radians(0.5);
  const Vector6d own = fix.T_odom_robot.covariance.diagonal().cwiseSqrt();
  Eigen::Vector4d sigma = move.sigma;
  for (int i = 0; i < 3; ++i)
    if (sigma[i] > 0.0) sigma[i] = std::hypot(kWider * own[i], kLeast_m);
  if (sigma[3] > 0.0)
    sigma[3] = std::min(kUnknown_rad, std::hypot(kWider * own.tail<3>().maxCoeff(), kLeast_rad));
  return sigma;
}

/// What is known of the frame by a fix that none of the others confirms: no more than what they differ by.
Eigen::Vector4d sigmaByContradiction(const ReckonedFix& by, const std::vector<ReckonedFix>& fixes,
                                     Eigen::Vector4d sigma) {
  for (const ReckonedFix& other : fixes) {
    const Pose expected = by.fix.T_odom_robot.pose * (by.T_odom_robot.inverse() * other.T_odom_robot);
    const Vector6d off = poseDifference(expected, other.fix.T_odom_robot.pose).cwiseAbs();
    for (int i = 0; i < 3; ++i)
      if (sigma[i] > 0.0) sigma[i] = std::max(sigma[i], off[i]);
    if (sigma[3] > 0.0) sigma[3] = std::clamp(off[5], sigma[3], std::max(sigma[3], kUnknown_rad));
  }
  return sigma;
}

}  // namespace

std::optional<FrameConsensus> consensus(const OdomFrame& frame, const std::vector<ReckonedFix>& fixes) {
  std::optional<FrameConsensus> best;
  const ReckonedFix* by = nullptr;
  std::size_t of = 0;
  for (const ReckonedFix& candidate : fixes) {
    const FrameCoordinates free = both(frame.defined(), candidate.fix.tells);
    if (!free.position) continue;
    ++of;
    FrameMove move = moveTo(candidate.fix.T_odom_robot.pose, candidate.T_odom_robot, free);
    const auto agreeing = static_cast<std::size_t>(std::count_if(
        fixes.begin(), fixes.end(), [&](const ReckonedFix& seen) { return confirm(candidate, seen); }));
    // A pose tells more than any number of positions.
    const bool more = !best || std::pair(candidate.fix.tells.heading, agreeing) >
                                   std::pair(best->by->tells.heading, best->agreeing);
    if (!more) continue;
    move.sigma = sigmaByOne(candidate.fix, move);
    best = {move, &candidate.fix, agreeing, 0};
    by = &candidate;
  }
  if (!best) return {};
  best->of = of;
  if (best->isInDoubt()) best->move.sigma = sigmaByContradiction(*by, fixes, best->move.sigma);
  return best;
}

}  // namespace fathom
