// A DVL's velocity with a beam that is off, against the least squares of its beams' speeds.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>

#include "core/random.h"
#include "sensors/dvl.h"
#include "support/observed.h"

namespace fathom {
namespace {

/// What a DVL solves for, by an orthogonal decomposition, of speeds by trigonometry of its beams.
Vector3d solved(const DvlSheet& sheet, const Vector3d& velocity_dvl, const Eigen::Vector4d& share,
                const Eigen::Vector4d& bias_m_s) {
  Eigen::Matrix<double, 4, 3> along;
  for (int k = 0; k < 4; ++k) {
    const double azimuth = sheet.beam_azimuths_rad[static_cast<std::size_t>(k)];
    const double aside = std::sin(sheet.beam_angle_rad);
    along.row(k) << aside * std::cos(azimuth), aside * std::sin(azimuth), -std::cos(sheet.beam_angle_rad);
  }
  const Eigen::Vector4d speeds = (along * velocity_dvl).cwiseProduct(share) + bias_m_s;
  return along.colPivHouseholderQr().solve(speeds);
}

Vector3d read(const DvlSheet& sheet, const Vector3d& velocity_dvl, const EffectParameters<double>& effects) {
  KinematicState<double> state;
  state.velocity_robot = velocity_dvl;
  Inputs<double> in = test::inputs(state);
  in.effects = effects;
  return Dvl::velocity(in, {}, sheet.beams());
}

TEST(DvlBeams, ABiasedBeamIsSolvedForAsADvlDoes) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    DvlSheet sheet;
    sheet.beam_angle_rad = radians(random.uniform(15, 35));
    for (double& azimuth : sheet.beam_azimuths_rad) azimuth += radians(45);
    const Vector3d velocity = random.normal3(), bias_m_s = 0.01 * random.normal3();
    EffectParameters<double> effects;
    effects.add<BeamBias>({bias_m_s.x(), bias_m_s.y(), bias_m_s.z()});
    const Eigen::Vector4d of_all(bias_m_s.x(), bias_m_s.y(), bias_m_s.z(), 0);
    EXPECT_LT(
        (read(sheet, velocity, effects) - solved(sheet, velocity, Eigen::Vector4d::Ones(), of_all)).norm(),
        1e-12);
  }
}

/// As its description has it.
TEST(DvlBeams, AFourthBeamsBiasIsOneOfTheOthers) {
  const DvlSheet sheet;
  EffectParameters<double> effects;
  effects.add<BeamBias>({0.02, -0.02, 0.02});
  EXPECT_LT((read(sheet, Vector3d::Zero(), effects) -
             solved(sheet, Vector3d::Zero(), Eigen::Vector4d::Ones(), Eigen::Vector4d(0, 0, 0, 0.02)))
                .norm(),
            1e-12);
}

TEST(DvlBeams, TheBeamIsTold) {
  const auto beamOf = [](const auto&... p) {
    const std::array values{p...};
    return values.size() == 3 ? BeamBias::derive(values.data(), {})[0]
                              : BeamMissing::derive(values.data(), {})[0];
  };
  EXPECT_EQ(beamOf(0.001, 0.02, -0.001), 2);
  EXPECT_EQ(beamOf(0.02, 0.0, 0.001), 1);
  EXPECT_EQ(beamOf(0.021, -0.019, 0.02), 4);
  EXPECT_EQ(beamOf(0.0, 0.1, 1.0, 0.0), 3);
}

TEST(DvlBeams, AMissingBeamIsSolvedForAsADvlDoes) {
  Random random(2);
  const DvlSheet sheet;
  for (int i = 0; i < 100; ++i) {
    const Vector3d velocity = random.normal3();
    Eigen::Vector4d missing;
    for (int k = 0; k < 4; ++k) missing[k] = random.uniform(0, 1);
    EffectParameters<double> effects;
    effects.add<BeamMissing>({missing[0], missing[1], missing[2], missing[3]});
    EXPECT_LT((read(sheet, velocity, effects) -
               solved(sheet, velocity, Eigen::Vector4d::Ones() - missing, Eigen::Vector4d::Zero()))
                  .norm(),
              1e-12);
  }
}

/// A vehicle file may name two beams, with which no velocity can be solved for.
TEST(DvlBeams, WithLessThanThreeNothingIsOff) {
  DvlSheet sheet;
  sheet.beam_azimuths_rad.resize(2);
  EffectParameters<double> effects;
  effects.add<BeamBias>({0.02, 0, 0});
  effects.add<BeamMissing>({1, 0, 0, 0});
  EXPECT_EQ(read(sheet, Vector3d::UnitX(), effects), Vector3d::UnitX());
}

}  // namespace
}  // namespace fathom
