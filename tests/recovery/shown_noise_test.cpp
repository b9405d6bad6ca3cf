// The noise that a recording shows beyond what is stated, told apart by where each kind of it shows.
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <string>

#include "diagnosis/budget_file.h"
#include "diagnosis/nominal.h"
#include "support/diagnosis_runs.h"

namespace fathom {
namespace {

NoiseModel noiseOf(const BatchInput& input) {
  const NominalFit nominal = nominalFit(input.data, input.start, {}, fieldBudget(), 1);
  EXPECT_TRUE(nominal.failure.empty()) << nominal.failure;
  return nominal.fit.model->noise();
}
NoiseModel noiseOf(const test::DiagnosisRun& run) { return noiseOf(run.input()); }

/// What a component of the budget turned out to be.
double shown(const NoiseModel& noise, const std::string& component) {
  for (std::size_t k = 0; k < noise.budget.components.size(); ++k)
    if (noise.budget.components[k].name == component) return noise.sigmaOf(k);
  throw std::out_of_range(component);
}
double declared(const std::string& component) {
  return shown({.budget = fieldBudget().of(CameraPipeline::linear)}, component);
}

/// What of a patch's light comes from its surface: with a share t that arrives, it reads J t + b (1 - t).
Vector3d reflected(const ImagePatch& patch) {
  const Vector9d water = test::coastalWater();
  const Vector3d veil = water.segment<3>(3), there = patch.albedo.cwiseProduct(water.tail<3>());
  return there.cwiseProduct((patch.radiance - veil).cwiseQuotient(there - veil));
}

TEST(ShownNoise, NoneBeyondWhatIsStated) {
  const NoiseModel noise = noiseOf(test::plainNull(test::lightDive(), 1));
  EXPECT_EQ(noise.light_scatter, 0);
  EXPECT_EQ(noise.parts, 0);
  // Of some hundred values each that are all zero.
  for (const char* component : {"print-placement", "print-albedo"})
    EXPECT_LT(shown(noise, component), declared(component) / 3) << component;
  // Heights are not seen better than to some 0.2 mm here, however flat one expects a panel to be.
  EXPECT_LT(shown(noise, "panel-flatness"), 0.001 / 3);
}

TEST(ShownNoise, OfLightThatScattersWithItsStrength) {
  constexpr double kShare = 0.003;
  test::DiagnosisRun run = test::plainNull(test::lightDive(), 2);
  run.change_light = [kShare](std::vector<ImagePatch>& patches) {
    Random noise(1);
    for (ImagePatch& patch : patches) patch.radiance += kShare * noise.normal3().cwiseProduct(patch.radiance);
  };
  const NoiseModel noise = noiseOf(run);
  // Some two thousand readings: a sigma is known to 2 %, and less where what is stated weighs as much.
  EXPECT_NEAR(noise.light_scatter, kShare, 0.1 * kShare);
  EXPECT_LT(shown(noise, "print-albedo"), declared("print-albedo") / 3);
  EXPECT_NEAR(noise.of(kChannel<Pixels>).scale, 1, 0.1);
}

// What is stated counts what lasts, such as rounding: where it is not used up nothing is made less of it.
TEST(ShownNoise, NoPartThatGoesWithLightWhereThereIsLessThanStated) {
  test::DiagnosisRun run = test::plainNull(test::lightDive(), 2);
  run.change_light = [](std::vector<ImagePatch>& patches) {
    Random noise(1);
    for (ImagePatch& patch : patches) {
      patch.radiance += 0.001 * noise.normal3().cwiseProduct(patch.radiance);
      patch.sigma *= 2;
    }
  };
  const NoiseModel noise = noiseOf(run);
  EXPECT_LT(noise.of(kChannel<Pixels>).scale, 0.9);
  EXPECT_EQ(noise.light_scatter, 0);
}

TEST(ShownNoise, OfPrintThatIsUneven) {
  constexpr double kShare = 0.01;
  test::DiagnosisRun run = test::plainNull(test::lightDive(), 3);
  run.change_light = [kShare](std::vector<ImagePatch>& patches) {
    Random random(2);
    std::map<int, Vector3d> prints;
    for (ImagePatch& patch : patches) {
      const auto [print, is_new] = prints.try_emplace(patch.place);
      if (is_new) print->second = kShare * random.normal3();
      patch.radiance += print->second.cwiseProduct(reflected(patch));
    }
  };
  const NoiseModel noise = noiseOf(run);
  // Of some hundred places and colours, a sixth of which the water and the field of light make up for: 10 %
  // are one sigma.
  EXPECT_NEAR(shown(noise, "print-albedo"), kShare, 0.3 * kShare);
  EXPECT_NEAR(noise.of(kChannel<Pixels>).scale, 1, 0.1);
}

// Each for good: taken for noise, most of it would be what one image has in common with the next, and what a
// row of markers has of it many sigmas.
TEST(ShownNoise, OfEdgesThatAreSofterMarkerByMarker) {
  constexpr double kScatter_px2 = 0.25;
  BatchInput input = test::plainNull(test::lightDive(), 5).input();
  Random random(4);
  std::map<int, double> softer;
  for (MarkerBlur& blur : input.data.blurs) {
    const auto [own, is_new] = softer.try_emplace(blur.place);
    if (is_new) own->second = kScatter_px2 * random.normal();
    blur.variance_px2 += own->second * Vector3d(1, 0, 1);
  }
  const NoiseModel noise = noiseOf(input);
  // Of two dozen values.
  EXPECT_NEAR(shown(noise, "edge-softness"), kScatter_px2, 0.5 * kScatter_px2);
  EXPECT_NEAR(noise.of(kChannel<Edges>).scale, 1, 0.1);
  EXPECT_NEAR(noise.of(kChannel<Edges>).correlation, 0, 0.1);
}

// What is printed unevenly within a place shows where images show another part of it each.
TEST(ShownNoise, OfPlacesThatAreSeenInPart) {
  constexpr double kShare = 0.002;
  test::DiagnosisRun run = test::plainNull(test::lightDive(), 4);
  run.change_light = [](std::vector<ImagePatch>& patches) {
    Random random(3);
    for (ImagePatch& patch : patches) {
      patch.seen_share = random.uniform(0.2, 1);
      const double print = kShare * std::sqrt(1 / patch.seen_share - 1) * random.normal();
      patch.radiance += print * reflected(patch);
    }
  };
  const NoiseModel noise = noiseOf(run);
  // Some eight hundred prints, half of whose variance counts: a sigma is known to 5 %.
  EXPECT_NEAR(noise.parts, kShare, 0.15 * kShare);
  EXPECT_NEAR(noise.of(kChannel<Pixels>).scale, 1, 0.1);
}

TEST(ShownNoise, OfMarkersThatAreNotInOnePlane) {
  test::BatchRun rippled = test::lightDive();
  rippled.pixels = false;
  test::DiagnosisRun run = test::plainNull(rippled, 4);
  Random random(3);
  PanelMap panel = rippled.panel;
  double square = 0;
  for (Marker& marker : panel.markers) {
    const double off_m = 0.001 * random.normal();
    marker.T_panel_marker.position.z() += off_m;
    square += off_m * off_m / static_cast<double>(panel.markers.size());
  }
  run.run.true_panel = panel;
  const NoiseModel noise = noiseOf(run);
  // Up to the three that are the panel's own pose, and what a fold, a twist and a bend of it make up for.
  // Each marker by itself, or with its neighbours: so few tell little of which.
  EXPECT_NEAR(std::hypot(shown(noise, "panel-flatness"), shown(noise, "marker-height")), std::sqrt(square),
              0.5 * std::sqrt(square));
  EXPECT_LT(shown(noise, "print-placement"), declared("print-placement"));
}

}  // namespace
}  // namespace fathom
