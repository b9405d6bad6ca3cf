#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "core/files.h"
#include "effects/calibration.h"
#include "sensors/models.h"
#include "support/motions.h"
#include "support/shared_data.h"
#include "support/simulated.h"

// Properties that every registered effect must have, whichever effects there are.
namespace fathom {
namespace {

constexpr std::size_t kScalars = kEffectOffsets[kEffectCount];
using EffectJet = ceres::Jet<double, static_cast<int>(kScalars)>;

/// Parameters a few prior sigmas large, of all effects at once or of one.
EffectParameters<double> randomParameters(Random& random) {
  EffectParameters<double> parameters;
  std::size_t i = 0;
  for (const EffectInfo& effect : allEffects())
    for (const Parameter& p : effect.parameters)
      for (int k = 0; k < p.size; ++k) parameters.values[i++] = p.prior_sigma * random.normal();
  parameters.on.set();
  return parameters;
}

/// Everything the forward model predicts, as one vector.
template <class T>
std::vector<T> predictions(const KinematicState<T>& state, const EffectParameters<T>& effects) {
  const Vehicle vehicle = test::slantedVehicle();
  const World<T> world{vehicle.gravityOdom(), T(-9.0)};
  std::vector<T> all;
  const auto add = [&](const auto& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) all.push_back(m(i));
  };
  add(predictGyro(state, vehicle.ins->T_robot_ins, effects));
  add(predictSpecificForce(state, world, vehicle.ins->T_robot_ins, effects));
  add(predictAttitude(state, vehicle.ins->T_robot_ins, effects));
  add(predictDvlVelocity(state, vehicle.dvl->T_robot_dvl, effects));
  all.push_back(dvlValidityOffset(effects));
  for (std::size_t k = 0; k < 4; ++k)
    all.push_back(
        predictBeamRange(state, world, vehicle.dvl->T_robot_dvl, vehicle.dvl->T_robot_beam(k), effects));
  all.push_back(predictPressure(state, world, *vehicle.depth, vehicle.depth->T_robot_depth, effects));
  add(predictUsbl(state, vehicle.usbl->T_robot_usbl));
  return all;
}

template <class T>
KinematicState<T> cast(const KinematicState<double>& s) {
  return {s.position_odom.cast<T>(),      s.R_odom_robot.cast<T>(),
          s.velocity_robot.cast<T>(),     s.angular_velocity_robot.cast<T>(),
          s.acceleration_robot.cast<T>(), s.angular_acceleration_robot.cast<T>()};
}

TEST(EffectRegistry, NeutralParametersChangeNoPrediction) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const auto state = test::randomMotion(random);
    const auto nominal = predictions<double>(state, {});
    forEachEffect([&]<class Effect>() {
      EffectParameters<double> neutral;
      neutral.on.set(kEffectIndex<Effect>);
      EXPECT_EQ(predictions(state, neutral), nominal) << Effect::id;
    });
  }
}

TEST(EffectRegistry, NeutralParametersChangeNoSimulatedReading) {
  const Trajectory trajectory = test::sineTrajectory(10);
  SimulationOptions options;
  options.vehicle = test::slantedVehicle();
  options.sea_floor_z_m = -8;
  const auto nominal = test::simulated(options, trajectory);
  forEachEffect([&]<class Effect>() {
    options.effects = {};
    options.effects.on.set(kEffectIndex<Effect>);
    const auto neutral = test::simulated(options, trajectory);
    ASSERT_EQ(neutral.size(), nominal.size());
    for (const auto& [label, samples] : nominal)
      EXPECT_EQ(test::largestDifference(samples, neutral.at(label)), 0) << Effect::id << " " << label;
  });
}

TEST(EffectRegistry, EveryParameterChangesSomething) {
  Random random(2);
  const auto state = test::randomMotion(random);
  const auto nominal = predictions<double>(state, {});
  forEachEffect([&]<class Effect>() {
    for (std::size_t k = 0; k < parameterSize<Effect>(); ++k) {
      EffectParameters<double> one;
      std::array<double, parameterSize<Effect>()> increment{};
      increment[k] = 0.01;
      one.add<Effect>(increment);
      EXPECT_NE(predictions(state, one), nominal) << Effect::id << " " << k;
      one.on.reset();  // off: parameters do not matter
      EXPECT_EQ(predictions(state, one), nominal) << Effect::id << " " << k;
    }
  });
}

// Fourth-order differences with steps of h and 2 h prior sigmas: wrong by h^4/30 times the fifth derivative,
// which even for a beam close to the horizon is below 1e4 of its units; rounding of a reading over h adds
// 1e-13 of it.
TEST(EffectRegistry, JetDerivativesEqualNumericOnes) {
  Random random(3);
  std::vector<double> sigma;
  for (const EffectInfo& effect : allEffects())
    for (const Parameter& p : effect.parameters)
      sigma.insert(sigma.end(), static_cast<std::size_t>(p.size), p.prior_sigma);
  ASSERT_EQ(sigma.size(), kScalars);
  constexpr double h = 1e-3;
  for (int round = 0; round < 50; ++round) {
    const auto state = test::randomMotion(random);
    const auto parameters = randomParameters(random);
    EffectParameters<EffectJet> jets;
    jets.on = parameters.on;
    for (std::size_t i = 0; i < kScalars; ++i)
      jets.values[i] = EffectJet(parameters.values[i], static_cast<int>(i));
    const auto with_jets = predictions(cast<EffectJet>(state), jets);
    const auto plain = predictions(state, parameters);
    ASSERT_EQ(with_jets.size(), plain.size());
    for (std::size_t k = 0; k < plain.size(); ++k)
      EXPECT_NEAR(with_jets[k].a, plain[k], 1e-14 * (1 + std::abs(plain[k])));
    for (std::size_t i = 0; i < kScalars; ++i) {
      const auto moved = [&](double steps) {
        auto there = parameters;
        there.values[i] += steps * h * sigma[i];
        return predictions(state, there);
      };
      const auto p2 = moved(2), p1 = moved(1), m1 = moved(-1), m2 = moved(-2);
      for (std::size_t k = 0; k < plain.size(); ++k) {
        const double numeric = (8 * (p1[k] - m1[k]) - (p2[k] - m2[k])) / (12 * h);  // a prior sigma
        EXPECT_NEAR(with_jets[k].v[static_cast<Eigen::Index>(i)] * sigma[i], numeric,
                    1e-9 + 1e-12 * std::abs(plain[k]))
            << i << " " << k;
      }
    }
  }
}

TEST(EffectRegistry, CalibrationFileRoundTripIsExact) {
  Random random(4);
  const auto file = test::scratchFolder() / "calibration.yaml";
  for (int round = 0; round < 50; ++round) {
    auto parameters = randomParameters(random);
    for (std::size_t e = 0; e < kEffectCount; ++e)
      if (round > 0 && random.uniform() < 0.5) parameters.on.reset(e);
    writeTextFile(file, formatCalibration(parameters));
    const auto back = readCalibration(file);
    EXPECT_EQ(back.on, parameters.on);
    for (std::size_t e = 0; e < kEffectCount; ++e)
      for (std::size_t i = kEffectOffsets[e]; i < kEffectOffsets[e + 1]; ++i)
        EXPECT_EQ(back.values[i], parameters.on[e] ? parameters.values[i] : 0.0);
    EXPECT_EQ(formatCalibration(back), readTextFile(file));
  }
}

TEST(EffectRegistry, NothingOnRoundTripsToo) {
  const auto file = test::scratchFolder() / "calibration.yaml";
  writeTextFile(file, formatCalibration({}));
  EXPECT_TRUE(readCalibration(file).on.none());
}

Error errorOf(const std::string& text) {
  const auto file = test::scratchFolder() / "calibration.yaml";
  writeTextFile(file, text);
  try {
    readCalibration(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.file, file.string());
    return error;
  }
  ADD_FAILURE() << "accepted: " << text;
  return {"", "", ""};
}

/// An entry with every parameter zero but, where given, one spoilt.
std::string entry(const EffectInfo& effect, const std::string& spoilt = "", const std::string& value = "") {
  std::string text = "\n  - {id: " + std::string(effect.id);
  for (const Parameter& p : effect.parameters)
    text += ", " + std::string(p.name) + ": " + (p.name == spoilt ? value : p.size == 1 ? "0" : "[0, 0, 0]");
  return text + "}";
}

TEST(EffectRegistry, BadCalibrationIsRefused) {
  for (const EffectInfo& effect : allEffects()) {
    EXPECT_EQ(errorOf("effects:" + entry(effect) + entry(effect)).where, "effects[1].id (line 3)");
    EXPECT_EQ(errorOf("effects:\n  - {id: " + std::string(effect.id) + "}").where, "effects[0] (line 2)");
    EXPECT_EQ(errorOf("effects:\n  - {id: " + std::string(effect.id) + "s}").where, "effects[0].id (line 2)");
    for (const Parameter& p : effect.parameters) {
      const std::string name(p.name), where = "effects[0]." + name + " (line 2)";
      const std::string beyond = std::to_string(1.001 * p.limit), within = std::to_string(0.999 * p.limit);
      const auto list = [&](const std::string& last) {
        return p.size == 1 ? last : std::string("[0, 0, ").append(last).append("]");
      };
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list(beyond))).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list(std::to_string(-1.001 * p.limit)))).where,
                where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list(".nan"))).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list("1x"))).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, "[0, 0]")).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, p.size == 1 ? "[0, 0, 0]" : "0")).where, where);
      const auto file = test::scratchFolder() / "good.yaml";
      writeTextFile(file, "effects:" + entry(effect, name, list(within)));
      EXPECT_NO_THROW(readCalibration(file)) << effect.id;
    }
  }
  EXPECT_NE(errorOf("effects:\n  - {id: dvl-scales, scale_error: 0}").why.find("dvl-scale,"),
            std::string::npos);
  EXPECT_EQ(errorOf("effects:\n  - {id: dvl-scale, scale_error: 0, colour: 1}").where,
            "effects[0].colour (line 2)");
  EXPECT_EQ(errorOf("effect: []\n").why, "missing key `effects`");
}

TEST(EffectRegistry, IdsAreUniqueAndParametersSane) {
  std::set<std::string_view> ids;
  for (const EffectInfo& effect : allEffects()) {
    EXPECT_TRUE(ids.insert(effect.id).second) << effect.id;
    std::set<std::string_view> names;
    for (const Parameter& p : effect.parameters) {
      EXPECT_TRUE(names.insert(p.name).second) << effect.id << " " << p.name;
      EXPECT_TRUE(p.size == 1 || p.size == 3) << p.name;
      EXPECT_GT(p.prior_sigma, 0) << p.name;
      EXPECT_GT(p.limit, p.prior_sigma) << p.name;
      EXPECT_FALSE(p.unit.empty()) << p.name;
    }
  }
  EXPECT_EQ(ids.size(), kEffectCount);
}

std::string inTicks(std::string_view word) { return std::string("`").append(word).append("`"); }

TEST(EffectRegistry, IdsAndParametersAreTheCatalogues) {
  FATHOM_NEEDS_SHARED("diagnosis.md");
  const std::string catalogue = readTextFile(test::sharedData("diagnosis.md"));
  const auto table = catalogue.find("## The catalogue"), parameters = catalogue.find("## Parameters");
  ASSERT_NE(table, std::string::npos);
  ASSERT_NE(parameters, std::string::npos);
  for (const EffectInfo& effect : allEffects()) {
    EXPECT_NE(catalogue.substr(table, parameters - table).find(inTicks(effect.id)), std::string::npos)
        << effect.id;
    if (effect.id == "pressure-offset") continue;  // the catalogue names no parameter for it
    for (const Parameter& p : effect.parameters)
      EXPECT_NE(catalogue.find(inTicks(p.name), parameters), std::string::npos) << p.name;
  }
}

}  // namespace
}  // namespace fathom
