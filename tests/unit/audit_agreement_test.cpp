// What streams' agreement tells of motions on which little is told, and of what is told apart only just.
// Faults of every kind on wide motions: recovery/audit_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "audit/attitude_conventions.h"
#include "audit/audit.h"
#include "audit/bias_fit.h"
#include "simulation/navigation_simulator.h"

namespace fathom {
namespace {

using PoseAt = Pose (*)(double t_s);

Pose atRest(double) { return {rotationFromYawPitchRoll(0.4, 0.05, -0.03), Vector3d(3, 2, -12)}; }
Pose gliding(double t_s) {
  const double phase = 2 * M_PI * t_s / 40;
  return {
      rotationFromYawPitchRoll(0.1 + 0.2 * std::sin(0.1 * t_s), -0.6 * std::cos(phase), 0.03 * std::sin(t_s)),
      Vector3d(0.8 * t_s, 0.05 * t_s, -30 + 6 * std::sin(phase))};
}
Pose upAndDown(double t_s) {
  return {rotationFromYawPitchRoll(0.3 * std::sin(0.1 * t_s), 0.02, 0.02),
          Vector3d(0.2 * t_s, 0, -5 + 3 * std::sin(0.2 * t_s))};
}
Pose inAllAxes(double t_s) {
  return {rotationFromYawPitchRoll(1.2 * std::sin(0.21 * t_s) + 0.3 * std::sin(0.6 * t_s),
                                   0.15 * std::sin(0.5 * t_s), 0.2 * std::sin(0.43 * t_s)),
          Vector3d(2 * std::sin(0.25 * t_s) + 0.5 * std::sin(0.7 * t_s), 1.5 * std::sin(0.31 * t_s + 1),
                   -4 + 1.2 * std::sin(0.17 * t_s) + 0.2 * std::sin(0.9 * t_s))};
}

Vehicle aVehicle(bool with_attitude) {
  Vehicle vehicle;
  InsSheet& ins = vehicle.ins.emplace();
  ins.rate_hz = 50;
  ins.accelerometer_sigma_m_s2 = 0.01;
  if (with_attitude) ins.attitude_sigma = 0.002;
  DvlSheet& dvl = vehicle.dvl.emplace();
  dvl.rate_hz = 5;
  dvl.velocity_sigma_xy_m_s = dvl.velocity_sigma_z_m_s = 0.01;
  dvl.T_robot_dvl = {rotationFromYawPitchRoll(radians(45), 0, 0), Vector3d(-0.2, 0.05, -0.2)};
  vehicle.depth.emplace().pressure_sigma_pa = 100;
  vehicle.depth->rate_hz = 5;
  return vehicle;
}

/// Of a minute in which each entry of a kind is spoilt.
template <class Entry, class Spoil>
std::vector<Finding> findingsOf(PoseAt pose, const Vehicle& vehicle, Spoil&& spoil) {
  constexpr double kDuration_s = 60;
  std::vector<double> times_s;
  std::vector<Pose> poses;
  for (double t = 0; t <= kDuration_s + 1; t += 0.1) times_s.push_back(t), poses.push_back(pose(t));
  SimulationOptions options;
  options.vehicle = vehicle;
  options.duration_s = kDuration_s;
  options.sea_floor_z_m = -70;
  options.beam_max_range_m = 100;
  std::vector<Sample> samples;
  simulateNavigation(options, Trajectory(times_s, poses), [&](const Sample& clean) {
    if (clean.label == labels::kTruth) return;
    Sample sample = clean;
    if (auto* entry = std::get_if<Entry>(&sample.reading)) {
      if constexpr (requires { spoil(sample, *entry); })
        spoil(sample, *entry);
      else
        spoil(*entry);
    }
    samples.push_back(sample);
  });
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.time < b.time; });
  Streams streams;
  for (const Sample& sample : samples) streams.add(sample);
  return audit(streams, vehicle);
}

std::string textOfAll(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) text += toText(f) + "\n";
  return text;
}

TEST(BiasFit, TakesOutWhatInstrumentsHave) {
  BiasFit<3> differences;
  for (int i = 0; i < 100; ++i)
    differences.add(Vector3d(1, 0, 0.1 * (i % 2 == 0 ? 1 : -1)), Matrix3d::Identity());
  const auto ordinary = differences.fit(Vector3d::Ones(), 1e-4, 50);
  EXPECT_NEAR(ordinary.bias.x(), 1, 1e-3);
  EXPECT_NEAR(ordinary.square, 0.01, 1e-3);
  EXPECT_NEAR(ordinary.with_biases, 1.01, 1e-12);
  const auto far_too_large = differences.fit(Vector3d::Constant(1e-3), 1e-4, 50);
  EXPECT_NEAR(far_too_large.square, 1.01, 0.01);
}

/// 1 deg/s and 0.3 m/s² are ordinary for micromechanical ones: once "sure: gyro-in-milliradians", as a gyro
/// that reads next to nothing has no bias.
TEST(Agreement, BiasesAreNoUnits) {
  for (const PoseAt motion : {atRest, gliding, upAndDown})
    for (const bool with_attitude : {false, true})
      for (const Vector3d& bias_deg_s : {Vector3d(1.5, 0, 0), Vector3d(-0.5, 1, 1)}) {
        const auto findings = findingsOf<InsSample>(motion, aVehicle(with_attitude), [&](InsSample& s) {
          *s.angular_velocity_ins += bias_deg_s * radians(1);
          *s.specific_force_ins += Vector3d(0.3, -0.3, 0.2);
        });
        EXPECT_TRUE(findings.empty()) << textOfAll(findings);
      }
}

TEST(Agreement, NamesTheDvlsUnitThatFits) {
  const std::vector<std::pair<std::string, double>> units{
      {"dvl-in-centimetres", 0.01}, {"dvl-in-millimetres", 0.001}, {"dvl-in-km-h", 1 / 3.6}};
  for (const auto& named : units)
    for (const PoseAt motion : {gliding, upAndDown, inAllAxes}) {
      const auto findings = findingsOf<DvlSample>(motion, aVehicle(false), [&](DvlSample& s) {
        if (s.velocity_dvl) *s.velocity_dvl /= named.second;
      });
      ASSERT_FALSE(findings.empty()) << named.first;
      // A foot a second and a km/h are ten per cent apart: both are named where scale errors might be as
      // much.
      const bool is_among = findings[0].what.find("--correct " + named.first) != std::string::npos;
      EXPECT_TRUE(findings[0].name == named.first || (is_among && findings[0].name == "dvl-in-feet"))
          << textOfAll(findings);
    }
}

TEST(Agreement, NamesTheSignOfPitchOrRoll) {
  const auto pitch = findingsOf<InsSample>(gliding, aVehicle(true), [](InsSample& s) {
    const Vector3d ypr = yawPitchRollFromRotation(*s.R_odom_ins);
    s.R_odom_ins = rotationFromYawPitchRoll(ypr[0], -ypr[1], ypr[2]);
  });
  ASSERT_FALSE(pitch.empty());
  EXPECT_EQ(pitch[0].name, "attitude-pitch-sign") << textOfAll(pitch);
  const auto roll = findingsOf<InsSample>(inAllAxes, aVehicle(true), [](InsSample& s) {
    const Vector3d ypr = yawPitchRollFromRotation(*s.R_odom_ins);
    s.R_odom_ins = rotationFromYawPitchRoll(ypr[0], ypr[1], -ypr[2]);
  });
  ASSERT_FALSE(roll.empty());
  EXPECT_EQ(roll[0].name, "attitude-roll-sign") << textOfAll(roll);
}

/// Far from the surface ten metres more or less look alike.
TEST(Agreement, SaysThatAGaugeIsNotToldFromAnAbsolutePressure) {
  const Vehicle vehicle = aVehicle(false);
  const auto text = [&](PoseAt motion, double air_pa) {
    return textOfAll(findingsOf<DepthSample>(
        motion, vehicle, [&](DepthSample& s) { s.pressure_pa = (s.pressure_pa - air_pa) / 100; }));
  };
  const double air_pa = vehicle.depth->atmospheric_pressure_pa;
  for (const double taken_out_pa : {0.0, air_pa}) {
    const std::string deep = text(gliding, taken_out_pa);
    EXPECT_NE(deep.find("--correct pressure-in-millibar makes"), std::string::npos) << deep;
    EXPECT_NE(deep.find("or of a gauge, which is not told: --correct pressure-in-millibar-gauge makes"),
              std::string::npos)
        << deep;
  }
  EXPECT_NE(text(upAndDown, air_pa).find("sure: pressure-in-millibar-gauge"), std::string::npos);
}

/// Once the DVL's, always. Of two clocks it is either one; which, only the pressure can tell.
TEST(Agreement, SaysOfBothClocks) {
  const auto textOfLateIns = [](const Vehicle& vehicle) {
    return textOfAll(findingsOf<InsSample>(
        inAllAxes, vehicle, [](Sample& sample, InsSample&) { sample.time = after(sample.time, 1); }));
  };
  Vehicle vehicle = aVehicle(true);
  EXPECT_NE(textOfLateIns(vehicle).find("clock-offset:INS:-1.0"), std::string::npos)
      << textOfLateIns(vehicle);
  vehicle.depth.reset();
  const std::string text = textOfLateIns(vehicle);
  EXPECT_NE(text.find("--correct clock-offset:DVL:1.0"), std::string::npos) << text;
  EXPECT_NE(text.find("--correct clock-offset:INS:-1.0"), std::string::npos) << text;
}

/// One wrong velocity of a hundred, on a robot that turns on the spot, is no clock; nor where the others have
/// no noise, so that most are just the middle one of five.
TEST(Agreement, AFewWrongVelocitiesAreNoClock) {
  const auto turning = [](double t_s) {
    return Pose{rotationFromYawPitchRoll(1.4 * std::sin(0.28 * t_s), 0.06 * std::sin(0.5 * t_s),
                                         0.08 * std::sin(0.6 * t_s)),
                Vector3d(3 + 0.08 * std::sin(0.4 * t_s), 2 + 0.06 * std::sin(0.3 * t_s),
                         -12 + 0.05 * std::sin(0.35 * t_s))};
  };
  for (const double sigma_m_s : {0.01, 1e-9})
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Vehicle vehicle = aVehicle(false);
      vehicle.dvl->velocity_sigma_xy_m_s = vehicle.dvl->velocity_sigma_z_m_s = sigma_m_s;
      Random random(seed);
      const std::string text = textOfAll(findingsOf<DvlSample>(turning, vehicle, [&](DvlSample& dvl) {
        const double size_m_s = random.uniform(0.1, 0.5), chance = random.uniform();
        const Vector3d way(random.normal(), random.normal(), random.normal());
        if (chance < 0.01) dvl.velocity_dvl.value() += size_m_s * way.normalized();
      }));
      EXPECT_EQ(text.find("clock-offset"), std::string::npos) << sigma_m_s << ", " << seed << ": " << text;
    }
}

}  // namespace
}  // namespace fathom
