#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sea_trial/sampled_signal.h"
#include "sea_trial/sea_trial.h"

/// A sea trial's streams on one clock, and what every comparison between them needs.
namespace fathom {

/// How far apart the clocks of two streams may be: searched on both sides.
constexpr double kLongestDelay_s = 3.0;

/// A gyro that is farther than this off the attitude's turning, a second or a row, contradicts it; below, the
/// vehicle may just turn too little to tell.
constexpr double kContradicting_rad = radians(1.0);

/// The same times, their distances from the first one multiplied.
std::vector<double> stretched(std::vector<double> time_s, double factor);

/// The streams on one clock, the IMU's, and the integrals that comparisons over intervals need.
struct AlignedStreams {
  const SeaTrialData& data;
  SampledSignal turned_imu, pushed_imu;  // integrals of rate and acceleration
  std::vector<double> gt_time_s;
  std::vector<double> dvl_time_s;

  AlignedStreams(const SeaTrialData& d, const SeaTrialConventions& c)
      : data(d),
        turned_imu(SampledSignal(d.imu_time_s, d.rate_imu).integral()),
        pushed_imu(SampledSignal(d.imu_time_s, d.acceleration_imu).integral()),
        gt_time_s(stretched(d.gt_time_s, c.stamp_stretch)),
        dvl_time_s(stretched(d.dvl_time_s, c.stamp_stretch)) {
    for (double& t : gt_time_s) t += c.imu_offset_s;
  }
};

/// The navigation solution's velocity, m/s, on the IMU's clock. R_ned_frd: of each of its rows.
SampledSignal velocityFrd(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd);

/// Zero of nothing.
double rootMeanSquare(double sum_of_squares, std::size_t count);

/// "(1.0, 2.0, 3.0)": a printf format for each number.
std::string printVector(const char* number_format, const Vector3d& v);

}  // namespace fathom
