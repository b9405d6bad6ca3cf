#include "tasks/reference_clock.h"

#include <cmath>

#include "core/kinematics.h"
#include "recording/rawlog.h"

namespace fathom {
namespace {

constexpr double kCompared_s = 30.0, kLargest_s = 2.0, kStep_s = 0.01, kWindow_s = 1.0;

/// The turning since the first reading, by the first INS's gyro alone.
std::vector<StampedPose> turnedByGyro(const std::filesystem::path& rawlog) {
  std::vector<StampedPose> path;
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next()) {
    const auto* ins = std::get_if<InsSample>(&sample->reading);
    if (ins == nullptr || sample->label != labels::kIns || !ins->angular_velocity_ins) continue;
    if (path.empty()) path.push_back({sample->time, {}});
    const StampedPose& last = path.back();
    const double dt = secondsBetween(last.time, sample->time);
    if (dt <= 0.0 || !ins->angular_velocity_ins->allFinite()) continue;
    const Matrix3d turn = expSO3<double>(*ins->angular_velocity_ins * dt);
    path.push_back({sample->time, {last.T_odom_robot.rotation * turn, Vector3d::Zero()}});
    if (secondsBetween(path.front().time, sample->time) > kCompared_s + kWindow_s) break;
  }
  return path;
}

/// How far it turns in the window from `time` on, rad.
std::optional<double> turnOver(const std::vector<StampedPose>& path, const Time& time) {
  const auto first = poseAt(path, time), last = poseAt(path, after(time, kWindow_s));
  if (!first || !last) return std::nullopt;
  return angleBetween(first->rotation, last->rotation);
}

/// The windows' turns by the gyro, and by the reference so much later.
struct TurnsBeside {
  std::vector<std::pair<Time, double>> gyro;
  const std::vector<StampedPose>& reference;

  /// Root mean square of the differences; nothing where the reference has too few of them.
  std::optional<double> misfit(double offset_s) const {
    double sum = 0.0;
    std::size_t count = 0;
    for (const auto& [time, turn] : gyro)
      if (const auto other = turnOver(reference, after(time, offset_s))) {
        sum += (*other - turn) * (*other - turn);
        ++count;
      }
    if (2 * count < gyro.size()) return std::nullopt;
    return std::sqrt(sum / static_cast<double>(count));
  }
};

}  // namespace

std::optional<double> referenceClockOffset(const std::filesystem::path& rawlog,
                                           const std::vector<StampedPose>& reference) {
  const std::vector<StampedPose> gyro = turnedByGyro(rawlog);
  if (gyro.size() < 2 || reference.size() < 2) return std::nullopt;
  TurnsBeside turns{{}, reference};
  for (double t_s = 0.0; t_s < kCompared_s; t_s += 0.5 * kWindow_s) {
    const Time time = after(gyro.front().time, t_s);
    if (const auto turn = turnOver(gyro, time)) turns.gyro.emplace_back(time, *turn);
  }
  constexpr std::size_t kEnough = 10;
  if (turns.gyro.size() < kEnough) return std::nullopt;
  double best_s = 0.0, best = std::numeric_limits<double>::infinity();
  const int steps = static_cast<int>(kLargest_s / kStep_s);
  for (int k = -steps; k <= steps; ++k)
    if (const auto misfit = turns.misfit(k * kStep_s); misfit && *misfit < best) {
      best = *misfit;
      best_s = k * kStep_s;
    }
  // Thirty seconds that do not overlap: half as large again is 12 in the log likelihood, which no chance
  // makes. And it has to turn by more than the best misfit.
  constexpr double kClearly = 1.5, kTurning = 3.0, kLeast_s = 0.05;
  const auto as_it_stands = turns.misfit(0.0);
  double turned = 0.0;
  for (const auto& [time, turn] : turns.gyro) turned += turn * turn / static_cast<double>(turns.gyro.size());
  if (!as_it_stands || std::abs(best_s) < kLeast_s || *as_it_stands < kClearly * best ||
      std::sqrt(turned) < kTurning * best)
    return std::nullopt;
  return best_s;
}

}  // namespace fathom
