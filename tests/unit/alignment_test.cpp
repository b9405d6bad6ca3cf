// The filter's start, from readings that a calibration's effects have changed.
#include "localization/alignment.h"

#include <gtest/gtest.h>

#include "support/observed.h"

namespace fathom {
namespace {

/// A robot that drifts tilted, and one reading of each of its sensors, without noise.
struct Drifting {
  LocalizationSetup setup;
  KinematicState<double> truth;
  double floor_z_m = -7.0;

  Drifting() {
    setup.vehicle = readVehicle(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/rov.yaml");
    setup.vehicle.depth->T_robot_depth.position.setZero();  // its height is taken as if the robot were level
    setup.vehicle.usbl.emplace().T_robot_usbl.position = {0.2, -0.1, 0.6};
    truth.position_odom = {3.0, -2.0, -4.0};
    truth.R_odom_robot = rotationFromYawPitchRoll(0.0, 0.15, -0.2);
    truth.velocity_robot = {0.4, -0.1, 0.05};
  }

  std::vector<Sample> readings() const {
    const Vehicle& v = setup.vehicle;
    const Inputs<double> in = test::inputs(truth, {v.gravityOdom(), floor_z_m}, setup.calibration);
    InsSample ins{v.ins->T_robot_ins, Gyro::angularVelocity(in, v.ins->T_robot_ins),
                  Accelerometer::specificForce(in, v.ins->T_robot_ins), std::nullopt};
    const Pose& T_robot_dvl = v.dvl->T_robot_dvl;
    const DvlSample dvl{T_robot_dvl, Dvl::velocity(in, T_robot_dvl)};
    DvlBeamsSample beams;
    for (std::size_t k = 0; k < v.dvl->beam_azimuths_rad.size(); ++k) {
      const Pose T_robot_beam = v.dvl->T_robot_beam(k);
      beams.beams.push_back({T_robot_beam, DvlBeams::range(in, T_robot_dvl, T_robot_beam)});
    }
    const DepthSample depth{
        v.depth->T_robot_depth, Depth::pressure(in, *v.depth, v.depth->T_robot_depth), {}};
    PoseSample usbl;
    usbl.T_odom_robot = {{Matrix3d::Identity(), Usbl::position(in, v.usbl->T_robot_usbl)},
                         Matrix6d::Identity()};
    const Time time = setup.time_zero;
    return {{time, labels::kIns, ins},
            {time, labels::kDvl, dvl},
            {time, labels::kDvlBeams, beams},
            {time, labels::kDepth, depth},
            {time, labels::kUsbl, usbl}};
  }

  void expectFound() const {
    const InitialState initial = alignInitially(setup, readings());
    const auto& found = initial.state.motion;
    EXPECT_LT(angleBetween(found.R_odom_robot, truth.R_odom_robot), 1e-7);
    EXPECT_LT((found.position_odom - truth.position_odom).norm(), 1e-7);
    EXPECT_LT((found.velocity_robot - truth.velocity_robot).norm(), 1e-9);
    EXPECT_LT(found.angular_velocity_robot.norm(), 1e-9);
    EXPECT_NEAR(initial.state.sea_floor_z_m, floor_z_m, 1e-7);
  }
};

TEST(Alignment, FindsTheStart) { Drifting().expectFound(); }

TEST(Alignment, TakesCalibratedEffectsOutOfTheReadings) {
  Drifting robot;
  EffectParameters<double>& effects = robot.setup.calibration;
  effects.add<AccelerometerBias>({0.5, -0.3, 0.2});
  effects.add<InsMisalignment>({0.05, -0.03, 0.04});
  effects.add<GyroScale>({0.1});
  effects.add<GyroBias>({0.02, -0.01, 0.03});
  effects.add<EarthRotation>({5e-4, 0, 5e-4});
  effects.add<DvlMisalignment>({0.1, 0.05, -0.08});
  effects.add<DvlLeverArm>({0.3, -0.2, 0.5});
  effects.add<DvlScale>({0.05});
  effects.add<WaterCurrent>({0.2, -0.3, 0.0});
  effects.add<PressureDensity>({-20});
  effects.add<PressureOffset>({3000});
  robot.expectFound();
}

}  // namespace
}  // namespace fathom
