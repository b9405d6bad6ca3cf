#include "sea_trial/conventions.h"

#include <stdexcept>

#include "core/text.h"
#include "sea_trial/attitude_axes.h"
#include "sea_trial/clocks.h"
#include "sea_trial/columns.h"
#include "sea_trial/remarks.h"

namespace fathom {
namespace {

/// What is changed, or contradicted, though another answer is as good.
void doubtLast(SeaTrialConventions& c) {
  const Conclusion& last = c.conclusions.back();
  if (last.runner_up.empty() || last.residual_ratio >= kDecisiveRatio) return;
  c.doubts.push_back(last.what + print(": not told (residual ratio %.3g): ", last.residual_ratio) +
                     last.concluded + "; or else " + last.runner_up);
}

}  // namespace

SeaTrialConventions establishConventions(const SeaTrialData& data) {
  if (data.gt_time_s.size() < 10 || data.dvl_time_s.size() < 10 || data.imu_time_s.size() < 10)
    throw std::invalid_argument("too few rows to establish anything: 10 are needed");
  SeaTrialConventions c;
  settlePositionColumns(data, c);
  settleAltitude(data, c);
  settleClocks(data, SampledSignal(data.imu_time_s, data.rate_imu).integral(), c);
  doubtLast(c);

  const AlignedStreams streams(data, c);
  const auto ranked = rankAttitudes(streams);
  const AttitudeHypothesis& best = ranked[0];
  if (best.dvl_rows == 0) throw std::invalid_argument("DVL and navigation solution hardly overlap in time");
  settleAttitude(ranked, c);
  if (c.attitude_sign != Vector3d::Ones()) doubtLast(c);
  c.accelerometer =
      settleAxes("accelerometer axes (specific force)", best.accelerometer, best.accelerometer_rows,
                 "change of velocity less gravity, in the body, against accelerometer", "m/s2", c);
  if (c.accelerometer != SignedAxes{}) doubtLast(c);
  settleGyro(best, c);
  if (c.gyro != SignedAxes{} || best.gyroContradicts()) doubtLast(c);
  concludeImuFrame(c);
  c.dvl = settleAxes("DVL axes", best.dvl, best.dvl_rows,
                     "velocity north, east, down turned into the body, against DVL", "m/s", c);
  if (c.dvl != SignedAxes{}) doubtLast(c);
  settleReferencePoint(streams, c);
  reportDvl(streams, c);
  reportEarthRate(streams, c);
  return c;
}

}  // namespace fathom
