// Detection rates that the comparison of markers predicts under known effects are those of a recording that
// has them; without the effects they are not.
#include <gtest/gtest.h>

#include "evaluation/fiducial_results.h"
#include "evaluation/recorded_fiducials.h"
#include "support/shared_data.h"
#include "support/water_recordings.h"

namespace fathom {
namespace {

const FiducialReader kReader{Backend::aruco, Preprocess::none};
constexpr double kNow_s = 10;

/// A cloud of sediment that lasts longer than the recording.
EffectParameters<double> cloud() {
  EffectParameters<double> effects;
  effects.add<TurbidityPlume>({0.8, kNow_s, 4.0});
  return effects;
}

struct Rate {
  double found, visible;

  double share() const { return found / visible; }
};

/// How far two rates are apart, in standard deviations of a binomial law.
double sigmasApart(const Rate& a, const Rate& b) {
  const double mean = (a.found + b.found) / (a.visible + b.visible);
  return std::abs(a.share() - b.share()) / std::sqrt(mean * (1 - mean) * (1 / a.visible + 1 / b.visible));
}

struct Measured {
  Rate rate;
  std::vector<double> ranges_m;  ///< of the images
};

Measured measured(const RecordingFiles& recording, const std::filesystem::path& folder) {
  RecordedFiducialsOptions options;
  const auto map = std::make_shared<PanelMap>(readPanelMap(test::kDexrovMap));
  options.map = map;
  options.families = test::silDetection().families;
  options.readers = {kReader};
  RawlogReader reader(recording.rawlog);
  const auto images = recordedImages(reader);
  Measured result{};
  for (const RecordedImage& image : images)
    result.ranges_m.push_back(
        (map->T_odom_panel.inverse() * *image.T_odom_robot * image.T_robot_camera).position.norm());
  for (const RecordedResult& image : readRecordedFiducials(images, options, folder)) {
    result.rate.found += image.readings.at(0).score.found;
    result.rate.visible += image.readings.at(0).score.visible;
  }
  return result;
}

/// At these ranges, head on as the recording is.
Rate predicted(const std::vector<double>& ranges_m, const EffectParameters<double>& effects,
               const std::filesystem::path& folder) {
  const Environment water = readEnvironment(test::kSilWater);
  FiducialGrid grid;
  grid.families = test::silDetection().families;
  grid.backends = {kReader.backend};
  grid.ranges_m = ranges_m;
  grid.tilts_rad = {radians(3)};
  grid.waters = {{"moderate", water.water, water.ambient}};
  grid.blurs_px = {0};
  grid.repeats = 3;
  grid.effects = effects;
  grid.t_s = kNow_s;
  Rate rate{};
  const PanelMap map = readPanelMap(test::kDexrovMap);
  for (const FiducialResult& result :
       compareFiducials(grid, map, test::smallCameraOptions().vehicle, folder)) {
    rate.found += result.score.found;
    rate.visible += result.score.visible;
  }
  return rate;
}

TEST(FiducialCalibration, PredictsTheRatesInACloud) {
  const auto folder = test::scratchFolder();
  const auto recording = test::simulateApproach(folder, test::kSilWater.filename().string(), 1, 24, cloud());
  const Measured seen = measured(recording, folder / "measured");
  const Rate with = predicted(seen.ranges_m, cloud(), folder / "with"),
             without = predicted(seen.ranges_m, {}, folder / "without");
  EXPECT_LT(sigmasApart(with, seen.rate), 3) << with.share() << " and " << seen.rate.share();
  EXPECT_GT(sigmasApart(without, seen.rate), 6) << without.share() << " and " << seen.rate.share();
}

// A lens that is not as stated: markers count where it has them.
TEST(FiducialCalibration, FindsMarkersWhereThePortHasThem) {
  const auto folder = test::scratchFolder();
  EffectParameters<double> port;
  port.add<FlatPortRefraction>({0.05, 0.01, 2});
  const Rate with = predicted({1.5, 2}, port, folder / "with"),
             without = predicted({1.5, 2}, {}, folder / "without");
  EXPECT_GT(with.share(), 0.95) << without.share();
  EXPECT_GT(without.share(), 0.95);
}

}  // namespace
}  // namespace fathom
