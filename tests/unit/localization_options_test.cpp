// Keys of a localization config: what they set, and what is refused.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "localization/options.h"
#include "support/panels.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

LocalizationOptions readOptionsText(const std::string& text) {
  const auto folder = test::scratchFolder();
  std::filesystem::remove(folder / "task.yaml");
  test::writeNew(folder / "task.yaml", text);
  return readLocalizationOptions(folder / "task.yaml");
}

TEST(LocalizationOptions, LandmarksAndLost) {
  const LocalizationOptions defaults = readOptionsText("task: TL4\n");
  EXPECT_EQ(defaults.landmarks.form, LandmarkOptions::Form::joint);
  EXPECT_NEAR(defaults.landmarks.position_sigma_m * defaults.landmarks.position_sigma_m, 1e-3, 2e-6);
  const LocalizationOptions options = readOptionsText(
      "landmarks: {pose: mean, position_sigma_m: 0.2, angle_sigma_deg: 4}\n"
      "lost: {position_sigma_m: 2, angle_sigma_deg: 30, contradiction_s: 5, blind_s: 20}\n");
  EXPECT_EQ(options.landmarks.form, LandmarkOptions::Form::mean);
  EXPECT_EQ(options.landmarks.position_sigma_m, 0.2);
  EXPECT_NEAR(options.landmarks.angle_sigma_rad, radians(4), 1e-12);
  EXPECT_EQ(options.lost.position_sigma_m, 2.0);
  EXPECT_NEAR(options.lost.angle_sigma_rad, radians(30), 1e-12);
  EXPECT_EQ(options.lost.contradiction_s, 5.0);
  EXPECT_EQ(options.lost.blind_s, 20.0);
}

TEST(LocalizationOptions, NoiseMayDifferByRegimeAndFromTheVehicleFile) {
  const std::string text =
      "process_noise:\n  angular_velocity_rad2_s3: 0.002\n  transit: {above_m_s: 0.5, acceleration_m2_s5: "
      "0.3}\n"
      "  turning: {above_deg_s: 8, angular_velocity_rad2_s3: [0.1, 0.2, 0.3]}\n"
      "sigma_times: {gyro: 0.5, dvl: 3}\n"
      "biases: {gyro_sigma_deg_s: 0.1, accelerometer_sigma_m_s2: 0.02, time_constant_s: 300}\n";
  const LocalizationOptions options = readOptionsText(text);
  const DrivingNoise &transit = options.driven.at(Regime::transit),
                     &turning = options.driven.at(Regime::turning);
  EXPECT_EQ(transit.angular_velocity.x(), 0.002);
  EXPECT_EQ(transit.acceleration.y(), 0.3);
  EXPECT_EQ(turning.angular_velocity.z(), 0.3);
  EXPECT_EQ(options.sigma_times.at(kChannel<Dvl>), 3.0);
  EXPECT_NEAR(options.biases->gyro_sigma_rad_s, radians(0.1), 1e-15);
  KinematicState<double> motion;
  EXPECT_EQ(options.regimes.of(motion), Regime::station_keeping);
  motion.velocity_robot.x() = 0.6;
  EXPECT_EQ(options.regimes.of(motion), Regime::transit);
  motion.angular_velocity_robot.z() = radians(9);
  EXPECT_EQ(options.regimes.of(motion), Regime::turning);
  const std::string formatted = formatLocalizationOptions(options);
  EXPECT_EQ(formatLocalizationOptions(readOptionsText(formatted)), formatted);
}

TEST(LocalizationOptions, WrongValuesAreNamed) {
  for (const char* text :
       {"landmarks: {pose: median}", "landmarks: {position_sigma_m: 0}", "lost: {blind_s: -1}",
        "sigma_times: {sonar: 2}", "sigma_times: {dvl: 0}", "process_noise: {transit: {above_m_s: 0}}",
        "biases: {time_constant_s: 10}", "fuse: []", "landmarks: {sigma: 1}", "lost: 3"})
    EXPECT_THROW(readOptionsText(text), Error) << text;
}

}  // namespace
}  // namespace fathom
