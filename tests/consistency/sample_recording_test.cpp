#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "recording/rawlog.h"
#include "simulation/read_trajectory.h"
#include "support/observed.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

/// Sum of squares of residuals in units of the data sheet's sigma, and their count.
struct Chi2 {
  double sum = 0;
  int count = 0;
  void add(double residual, double sigma) { sum += std::pow(residual / sigma, 2), ++count; }
  double perReading() const { return sum / count; }
};

/// (a, b, c) of the plane z = a x + b y + c, least squares. The sample's floor is seen to slope by about 1.2
/// degrees, which the convention does not forbid; our own simulator's is level.
Vector3d planeThrough(const std::vector<Vector3d>& points) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Vector3d& p : points) {
    const Vector3d row(p.x(), p.y(), 1);
    normal += row * row.transpose();
    right += row * p.z();
  }
  return solveSymmetric(normal, right);
}

// The forward model against a generator that shares no code with it: along the sample recording's true poses,
// what we predict must differ from what was recorded by the data sheet's noise and by nothing else. A wrong
// frame, sign, lever arm or unit anywhere would show as a ratio far from one.
TEST(SampleRecording, ForwardModelPredictsItToTheDataSheetsNoise) {
  FATHOM_NEEDS_SHARED("data/sample/none/recording.rawlog");
  const Vehicle vehicle = readVehicle(test::sharedData("data/sample/none/vehicle.yaml"));
  const auto truth = readTum(test::sharedData("data/sample/none/truth.tum"));
  const Trajectory trajectory = Trajectory::fromTum(truth);
  RawlogReader reader(test::sharedData("data/sample/none/recording.rawlog"));
  const World<double> world{vehicle.gravityOdom(), 0.0};

  Chi2 gyro, force, velocity_xy, velocity_z, pressure, range;
  std::vector<Vector3d> gyro_error, force_error;
  std::vector<double> pressure_error;
  std::vector<Vector3d> floor_hits;
  while (const auto sample = reader.next()) {
    const double t = secondsBetween(truth.front().time, sample->time);
    // The ends of a natural spline know no acceleration.
    if (t < trajectory.start_s() + 1 || t > trajectory.end_s() - 1) continue;
    const auto state = trajectory.at(t);
    const Inputs<double> in = test::inputs(state, world);
    if (const auto* ins = std::get_if<InsSample>(&sample->reading)) {
      gyro_error.emplace_back(*ins->angular_velocity_ins - Gyro::angularVelocity(in, ins->T_robot_ins));
      force_error.emplace_back(*ins->specific_force_ins - Accelerometer::specificForce(in, ins->T_robot_ins));
    } else if (const auto* dvl = std::get_if<DvlSample>(&sample->reading)) {
      const Vector3d error = *dvl->velocity_dvl - Dvl::velocity(in, dvl->T_robot_dvl);
      velocity_xy.add(error.x(), vehicle.dvl->velocity_sigma_xy_m_s);
      velocity_xy.add(error.y(), vehicle.dvl->velocity_sigma_xy_m_s);
      velocity_z.add(error.z(), vehicle.dvl->velocity_sigma_z_m_s);
    } else if (const auto* depth = std::get_if<DepthSample>(&sample->reading)) {
      pressure_error.push_back(depth->pressure_pa -
                               Depth::pressure(in, *vehicle.depth, depth->T_robot_depth));
    } else if (const auto* beams = std::get_if<DvlBeamsSample>(&sample->reading)) {
      for (const DvlBeam& beam : beams->beams) {
        const Pose T_odom_beam = Pose{state.R_odom_robot, state.position_odom} * beam.T_robot_beam;
        floor_hits.push_back(T_odom_beam * Vector3d(beam.range_m.value(), 0, 0));
      }
    }
  }
  const auto mean = [](const auto& list) {
    auto sum = list.front();
    for (std::size_t i = 1; i < list.size(); ++i) sum += list[i];
    return decltype(sum)(sum / static_cast<double>(list.size()));
  };
  const Vector3d gyro_mean = mean(gyro_error), force_mean = mean(force_error);
  const double offset_pa = mean(pressure_error);
  const Vector3d floor = planeThrough(floor_hits);
  for (const Vector3d& e : gyro_error)
    for (int j = 0; j < 3; ++j) gyro.add(e[j] - gyro_mean[j], vehicle.ins->gyro_sigma_rad_s);
  for (const Vector3d& e : force_error)
    for (int j = 0; j < 3; ++j) force.add(e[j] - force_mean[j], vehicle.ins->accelerometer_sigma_m_s2);
  for (const double e : pressure_error) pressure.add(e - offset_pa, vehicle.depth->pressure_sigma_pa);
  // A range error moves the hit on the floor by cos(30 deg) of itself, at level attitude.
  for (const Vector3d& hit : floor_hits)
    range.add((hit.z() - floor.dot(Vector3d(hit.x(), hit.y(), 1))) / std::cos(vehicle.dvl->beam_angle_rad),
              vehicle.dvl->range_sigma_m);

  // Chi2 over n readings is 1 +- sqrt(2/n); 4.5 of it for 900 readings is 0.21, for 54000 it is 0.03, and
  // slow bias within the run adds (3e-3/1e-2)² = 9 % to the accelerometer at most.
  for (const auto& [name, chi2] : {std::pair{"gyro", &gyro},
                                   {"force", &force},
                                   {"velocity_xy", &velocity_xy},
                                   {"velocity_z", &velocity_z},
                                   {"pressure", &pressure},
                                   {"range", &range}})
    RecordProperty(name, std::to_string(chi2->perReading()));
  EXPECT_NEAR(gyro.perReading(), 1, 0.05);
  EXPECT_NEAR(force.perReading(), 1, 0.15);
  EXPECT_NEAR(velocity_xy.perReading(), 1, 0.15);
  EXPECT_NEAR(velocity_z.perReading(), 1, 0.21);
  EXPECT_NEAR(pressure.perReading(), 1, 0.21);
  EXPECT_NEAR(range.perReading(), 1, 0.11);
  EXPECT_LT(std::hypot(floor[0], floor[1]), 0.05);
  EXPECT_LT(gyro_mean.norm(), 5 * vehicle.ins->gyro_bias_sigma_rad_s);
  EXPECT_LT(force_mean.norm(), 5 * vehicle.ins->accelerometer_bias_sigma_m_s2);
  EXPECT_LT(std::abs(offset_pa), 5 * vehicle.depth->pressure_offset_sigma_pa);
}

}  // namespace
}  // namespace fathom
