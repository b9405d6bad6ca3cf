#include "sensors/vehicle.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

std::filesystem::path shipped() { return std::filesystem::path(FATHOM_SOURCE_DIR) / "config/rov.yaml"; }

void expectExample(const Vehicle& v) {
  EXPECT_EQ(v.gravity_m_s2, 9.80665);
  EXPECT_EQ(v.gravityOdom(), Vector3d(0, 0, -9.80665));
  ASSERT_TRUE(v.ins && v.dvl && v.depth && v.camera);
  EXPECT_FALSE(v.usbl);
  EXPECT_FALSE(v.ins->attitude_sigma);
  EXPECT_EQ(v.ins->rate_hz, 100);
  EXPECT_EQ(v.ins->gyro_sigma_rad_s, 0.001);
  EXPECT_EQ(v.ins->accelerometer_sigma_m_s2, 0.01);
  EXPECT_EQ(v.ins->gyro_bias_sigma_rad_s, 0.00005);
  EXPECT_EQ(v.ins->accelerometer_bias_sigma_m_s2, 0.003);
  EXPECT_EQ(v.ins->bias_time_constant_s, 120);
  EXPECT_EQ(v.ins->T_robot_ins.position, Vector3d(0.05, -0.02, 0.03));
  EXPECT_EQ(v.dvl->rate_hz, 5);
  EXPECT_EQ(v.dvl->assumed_sound_speed_m_s, 1500);
  EXPECT_EQ(v.dvl->beam_sigma_m_s, 0.007);
  EXPECT_EQ(v.dvl->velocity_sigma_xy_m_s, 0.0099);
  EXPECT_EQ(v.dvl->velocity_sigma_z_m_s, 0.00404);
  EXPECT_EQ(v.dvl->range_sigma_m, 0.015);
  EXPECT_NEAR(v.dvl->beam_angle_rad, 0.5235987755982988, 1e-15);
  EXPECT_EQ(v.dvl->beam_azimuths_rad.size(), 4U);
  const double s = std::sqrt(0.5);
  EXPECT_LT((v.dvl->T_robot_dvl * Vector3d(1, 0, 0) - Vector3d(-0.2 + s, 0.05 + s, -0.18)).norm(), 1e-15);
  EXPECT_EQ(v.depth->pressure_sigma_pa, 100);
  EXPECT_EQ(v.depth->pressure_offset_sigma_pa, 100);
  EXPECT_EQ(v.depth->atmospheric_pressure_pa, 101325);
  EXPECT_EQ(v.depth->water_density_kg_m3, 1025);
  EXPECT_EQ(v.depth->T_robot_depth.position, Vector3d(-0.1, 0.1, 0.1));
  EXPECT_EQ(v.camera->model.width_px, 640);
  EXPECT_EQ(v.camera->gain, "fixed");
  // The optical axis is the robot's x, but for 2 degrees.
  EXPECT_GT(v.camera->T_robot_camera.rotation(0, 2), 0.999);
  ASSERT_FALSE(v.lamps.empty());
  EXPECT_EQ(v.lamps[0].name, "port");
  EXPECT_EQ(v.lamps[0].T_robot_lamp.position, Vector3d(0.33, 0.28, 0.14));
}

TEST(Vehicle, ShippedFileHasTheConventionsValues) {
  expectExample(readVehicle(shipped()));
  EXPECT_EQ(readVehicle(shipped()).camera->model.k1, -0.041737);
}

TEST(Vehicle, ReadsTheSampleRecordings) {
  FATHOM_NEEDS_SHARED("data/sample/none/vehicle.yaml");
  const Vehicle v = readVehicle(test::sharedData("data/sample/none/vehicle.yaml"));
  expectExample(v);
  EXPECT_EQ(v.lamps.size(), 2U);
}

TEST(Vehicle, OptionalPartsMayBeGivenOrLeftOut) {
  const auto file = test::scratchFolder() / "v.yaml";
  writeTextFile(file, "gravity_m_s2: 9.81\n");
  EXPECT_FALSE(readVehicle(file).ins || readVehicle(file).dvl || readVehicle(file).depth ||
               readVehicle(file).camera);
  writeTextFile(file, R"(gravity_m_s2: 9.81
ins:
  rate_hz: 100
  gyro_sigma_rad_s: 0.001
  accelerometer_sigma_m_s2: 0.01
  gyro_bias_sigma_rad_s: 0
  accelerometer_bias_sigma_m_s2: 0
  bias_time_constant_s: 120
  attitude_sigma_deg: 0.5
  pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}
usbl:
  rate_hz: 0.5
  position_sigma_m: 0.8
  pose: {x: 0, y: 0, z: 0.3, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}
)");
  const Vehicle v = readVehicle(file);
  EXPECT_NEAR(v.ins->attitude_sigma.value().roll_rad, radians(0.5), 1e-15);
  EXPECT_TRUE(v.ins->attitude_sigma->isOneOfAll());
  EXPECT_EQ(v.usbl.value().position_sigma_m, 0.8);
  EXPECT_EQ(v.usbl->T_robot_usbl.position.z(), 0.3);
}

// About the vertical the heading turns, about the level axis to the left the pitch, and nothing else of the
// three.
TEST(Vehicle, AnAttitudeMayBeKnownOtherwiseAboutEachAxis) {
  std::string text = readTextFile(shipped());
  const std::string key = "  bias_time_constant_s: 120\n";
  text.replace(text.find(key), key.size(), key + "  attitude_sigma_deg: [0.1, 0.2, 3]\n");
  const auto file = test::scratchFolder() / "v.yaml";
  writeTextFile(file, text);
  const AttitudeSigma sigma = readVehicle(file).ins->attitude_sigma.value();
  EXPECT_NEAR(sigma.heading_rad, radians(3.0), 1e-15);
  const Pose T_robot_ins{rotationFromYawPitchRoll(1.0, 0.5, -2.0), {}};
  const double yaw = 2.0, pitch = 0.3, roll = -0.4;
  const Matrix3d R_odom_ins = rotationFromYawPitchRoll(yaw, pitch, roll) * T_robot_ins.rotation;
  const Matrix3d root = sigma.errorRoot(R_odom_ins, T_robot_ins);
  const auto moved = [&](const Vector3d& n) -> Matrix3d {
    return R_odom_ins * expSO3<double>(root * n) * T_robot_ins.rotation.transpose();
  };
  EXPECT_LT(
      angleBetween(moved(Vector3d::UnitZ()), rotationFromYawPitchRoll(yaw + sigma.heading_rad, pitch, roll)),
      1e-12);
  EXPECT_LT(
      angleBetween(moved(Vector3d::UnitY()), rotationFromYawPitchRoll(yaw, pitch + sigma.pitch_rad, roll)),
      1e-12);
  EXPECT_NEAR(root.col(0).norm(), sigma.roll_rad, 1e-15);
}

TEST(Vehicle, APairOfCamerasMayLookThroughWindows) {
  std::string text = readTextFile(shipped());
  const auto lamps = text.find("lamps:");
  ASSERT_NE(lamps, std::string::npos);
  text.insert(lamps, R"(  right_pose: {x: 0.2, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}
  right_pose_sigma: {position_m: 0.002, angle_deg: 0.5}
  window: {distance_m: 0.2, tilt_deg: -5, tilt_y_deg: 3}
  right_window: {distance_m: 0.1, tilt_deg: 0, tilt_y_deg: 0}
)");
  const auto file = test::scratchFolder() / "v.yaml";
  writeTextFile(file, text);
  const CameraSheet camera = readVehicle(file).camera.value();
  EXPECT_EQ(camera.T_left_right.value().position.x(), 0.2);
  EXPECT_EQ(camera.right_position_sigma_m, 0.002);
  EXPECT_NEAR(camera.right_angle_sigma_rad, radians(0.5), 1e-15);
  EXPECT_EQ(camera.model.window, (Window{0.2, radians(-5.0), radians(3.0)}));
  EXPECT_EQ(camera.right_window.distance_m, 0.1);
  text.replace(text.find("tilt_deg: -5"), 12, "tilt_deg: 95");
  writeTextFile(file, text);
  EXPECT_THROW(readVehicle(file), Error);
}

// Beams of a Janus DVL: down, 30 degrees outwards, at their azimuths.
TEST(Vehicle, MayHaveSeveralOfAKind) {
  const std::string text = readTextFile(shipped());
  const auto read = [&](const std::string& more) {
    const std::filesystem::path file = test::scratchFolder() / "vehicle.yaml";
    writeTextFile(file, text + more);
    return readVehicle(file);
  };
  const std::string compass =
      "{rate_hz: 3, heading_sigma_deg: 1, pose: {x: 1, y: 0, z: 0, yaw_deg: 0, "
      "pitch_deg: 0, roll_deg: 0}}\n";
  const Vehicle vehicle = read("compass.aft: " + compass + "compass.2: " + compass);
  EXPECT_FALSE(vehicle.compass.has_value());  // the first one is none of them
  ASSERT_EQ(vehicle.others.size(), 2U);
  const Instance aft = *Instance::named("aft");
  ASSERT_TRUE(vehicle.sensors(aft).compass.has_value());
  EXPECT_EQ(vehicle.sensors(aft).compass->rate_hz, 3);
  EXPECT_FALSE(vehicle.sensors(aft).dvl.has_value());
  EXPECT_EQ(&vehicle.sensors({}), &static_cast<const SensorsOnBoard&>(vehicle));
  for (const char* unknown :
       {"lamps.2: []\n", "compas.2: {}\n", "compass.two words: {}\n", "compass.first: {}\n"})
    EXPECT_THROW(read(unknown), Error) << unknown;
}

TEST(Vehicle, BeamsPointDownAndOut) {
  DvlSheet dvl;
  const double s = std::sin(radians(30)), c = std::cos(radians(30));
  const Vector3d expected[4] = {{s, 0, -c}, {0, s, -c}, {-s, 0, -c}, {0, -s, -c}};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT((dvl.T_robot_beam(k).rotation.col(0) - expected[k]).norm(), 1e-15) << k;
  dvl.T_robot_dvl = {rotationFromYawPitchRoll(radians(90), 0, 0), {1, 2, 3}};
  EXPECT_LT((dvl.T_robot_beam(0).rotation.col(0) - expected[1]).norm(), 1e-15);
  EXPECT_EQ(dvl.T_robot_beam(0).position, Vector3d(1, 2, 3));
}

struct BadVehicle {
  const char* what;
  const char* good;   ///< text of the shipped file...
  const char* bad;    ///< ...and what stands there instead
  const char* where;  ///< key and line
  const char* why;    ///< the reason begins so
};
void PrintTo(const BadVehicle& bad, std::ostream* out) { *out << bad.what; }

class VehicleRefuses : public testing::TestWithParam<BadVehicle> {};

TEST_P(VehicleRefuses, WithFileKeyAndLine) {
  const BadVehicle& bad = GetParam();
  std::string text = readTextFile(shipped());
  text.erase(0, text.find("gravity"));  // lines then count from gravity_m_s2
  const auto at = text.find(bad.good);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(bad.good).size(), bad.bad);
  const auto file = test::scratchFolder() / "bad.yaml";
  writeTextFile(file, text);
  try {
    readVehicle(file);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.file, file.string());
    EXPECT_EQ(error.where, bad.where) << error.what();
    EXPECT_EQ(error.why.rfind(bad.why, 0), 0U) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, VehicleRefuses,
    testing::Values(
        BadVehicle{"UnknownKey", "  rate_hz: 100", "  colour: red\n  rate_hz: 100", "ins.colour (line 3)",
                   "unknown key"},
        BadVehicle{"UnknownSection", "ins:", "sonar: {rate_hz: 1}\nins:", "sonar (line 2)", "unknown key"},
        BadVehicle{"Misspelt", "water_density_kg_m3", "water_desnity_kg_m3", "depth (line 21)",
                   "missing key"},
        BadVehicle{"MissingUnit", "gyro_sigma_rad_s:", "gyro_sigma:", "ins.gyro_sigma (line 4)",
                   "lacks its unit"},
        BadVehicle{"WrongUnit", "yaw_deg: 45", "yaw_rad: 45", "dvl.pose (line 19)", "missing key `yaw_deg`"},
        BadVehicle{"DuplicateKey", "  rate_hz: 100", "  rate_hz: 100\n  rate_hz: 50", "ins.rate_hz (line 4)",
                   "duplicate key"},
        BadVehicle{"DuplicateSection", "depth:", "ins: {}\ndepth:", "ins (line 20)", "duplicate key"},
        BadVehicle{"TrailingLetter", "gravity_m_s2: 9.80665", "gravity_m_s2: 1.5x", "gravity_m_s2 (line 1)",
                   "must be a number, not `1.5x`"},
        BadVehicle{"Nan", "range_sigma_m: 0.015", "range_sigma_m: .nan", "dvl.range_sigma_m (line 16)",
                   "must be"},
        BadVehicle{"Infinity", "range_sigma_m: 0.015", "range_sigma_m: inf", "dvl.range_sigma_m (line 16)",
                   "must be finite"},
        BadVehicle{"NegativeSigma", "pressure_sigma_pa: 100", "pressure_sigma_pa: -100",
                   "depth.pressure_sigma_pa (line 22)", "must be greater than zero"},
        BadVehicle{"NegativeBiasSigma", "gyro_bias_sigma_rad_s: 0.00005", "gyro_bias_sigma_rad_s: -1",
                   "ins.gyro_bias_sigma_rad_s (line 6)", "must not be negative"},
        BadVehicle{"ZeroRate", "rate_hz: 5", "rate_hz: 0", "dvl.rate_hz (line 11)",
                   "must be greater than zero"},
        BadVehicle{"MissingKey", "  rate_hz: 100\n", "", "ins (line 3)", "missing key `rate_hz`"},
        BadVehicle{"MissingGravity", "gravity_m_s2: 9.80665\n", "", "line 1", "missing key `gravity_m_s2`"},
        BadVehicle{"UnclosedBracket", "[0, 90, 180, 270]", "[0, 90, 180, 270", "line 19", "not YAML"},
        BadVehicle{"ListForNumber", "beam_angle_deg: 30", "beam_angle_deg: [30]",
                   "dvl.beam_angle_deg (line 17)", "must be a number"},
        BadVehicle{"NumberForList", "[0, 90, 180, 270]", "90", "dvl.beam_azimuths_deg (line 18)",
                   "must be a list"},
        BadVehicle{"BeamAlongTheHorizon", "beam_angle_deg: 30", "beam_angle_deg: 90",
                   "dvl.beam_angle_deg (line 17)", "must be below 90"},
        BadVehicle{"SectionIsNoMap", "depth:", "usbl: 3\ndepth:", "usbl (line 20)", "must be a map"},
        BadVehicle{"Gain", "gain: fixed", "gain: some", "camera.gain (line 37)", "must be fixed or auto"},
        BadVehicle{"Distortion", "k3: 0.0}", "k4: 0.0}", "camera.distortion (line 35)", "missing key `k3`"},
        BadVehicle{"HalfAPixel", "width_px: 640", "width_px: 640.5", "camera.width_px (line 29)",
                   "must be a whole number"},
        BadVehicle{"LampWithoutName", "{name: port, ", "{", "lamps[0] (line 46)", "missing key `name`"}),
    [](const auto& each) { return each.param.what; });

}  // namespace
}  // namespace fathom
