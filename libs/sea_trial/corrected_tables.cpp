#include "sea_trial/corrected_tables.h"

#include <algorithm>

#include "sea_trial/conventions.h"

namespace fathom {
namespace {

void correctStamps(std::vector<double>& time_s, const std::string& label, const Correction& correction,
                   Time start, Time time_zero) {
  if (correction.label() != label) return;
  for (double& t : time_s) {
    Sample sample{after(start, t), label, {}};
    correction.apply(sample, {}, time_zero);
    t = secondsBetween(start, sample.time);
  }
}

void correctClock(SeaTrialData& data, const Correction& correction, Time start) {
  const Time time_zero = after(start, std::min(data.imu_time_s.front(), data.dvl_time_s.front()));
  correctStamps(data.imu_time_s, labels::kIns, correction, start, time_zero);
  correctStamps(data.dvl_time_s, labels::kDvl, correction, start, time_zero);
}

void correctIns(SeaTrialData& data, const SeaTrialConventions& c, const Correction& correction) {
  const Matrix3d gyro = flipFrdRobot() * c.gyro.matrix(),
                 accelerometer = flipFrdRobot() * c.accelerometer.matrix();
  for (std::size_t k = 0; k < data.imu_time_s.size(); ++k) {
    Sample sample{{},
                  labels::kIns,
                  InsSample{Pose{}, gyro * data.rate_imu[k], accelerometer * data.acceleration_imu[k], {}}};
    correction.apply(sample, {}, {});
    const auto& ins = std::get<InsSample>(sample.reading);
    data.rate_imu[k] = gyro.transpose() * *ins.angular_velocity_ins;
    data.acceleration_imu[k] = accelerometer.transpose() * *ins.specific_force_ins;
  }
}

void correctDvl(SeaTrialData& data, const SeaTrialConventions& c, const Correction& correction) {
  const Matrix3d dvl = flipFrdRobot() * c.dvl.matrix();
  for (Vector3d& velocity : data.velocity_dvl) {
    Sample sample{{}, labels::kDvl, DvlSample{Pose{}, dvl * velocity}};
    correction.apply(sample, {}, {});
    velocity = dvl.transpose() * *std::get<DvlSample>(sample.reading).velocity_dvl;
  }
}

}  // namespace

SeaTrialData correctedTables(SeaTrialData data, const std::vector<Correction>& corrections, Time start) {
  for (const Correction& correction : corrections)
    if (correction.reorders()) correctClock(data, correction, start);
  for (const Correction& correction : corrections) {
    if (correction.reorders()) continue;
    const SeaTrialConventions c = establishConventions(data);
    if (correction.label() == labels::kIns) correctIns(data, c, correction);
    if (correction.label() == labels::kDvl) correctDvl(data, c, correction);
  }
  return data;
}

}  // namespace fathom
