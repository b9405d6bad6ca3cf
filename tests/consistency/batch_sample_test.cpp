#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/linear_algebra.h"
#include "effects/catalogue.h"
#include "estimation/batch_estimate.h"
#include "panel/panel_maps.h"
#include "recording/tum.h"
#include "support/sanitized.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

/// A sample recording with its markers, estimated; its images are searched once for all tests of it.
struct SampleRun {
  BatchInput input;
  std::vector<StampedPose> truth;

  explicit SampleRun(const std::string& name, const EffectParameters<double>& calibration = {}) {
    const auto folder = test::sharedData("data/sample/" + name);
    const auto open = [&]() -> std::unique_ptr<SampleSource> {
      return std::make_unique<RecordingSource>(folder / "recording.rawlog");
    };
    const Vehicle vehicle = readVehicle(folder / "vehicle.yaml");
    const auto panels = readPanelMaps(folder / "panel/panel.yaml");
    DetectionSettings settings = settingsFor(panels, Backend::apriltag);
    settings.expected_markers = 4;
    const auto entries = imageEntries(*open(), {});
    const auto keep = std::filesystem::temp_directory_path() / "fathom-tests" / ("detections_" + name);
    std::filesystem::create_directories(keep.parent_path());
    const Detections detections = detectImages(imagesOf(entries), settings, keep);
    input = batchInput(open, detections, vehicle, panels, calibration);
    truth = readTum(folder / "truth.tum");
  }

  /// Mean NEES over poses 5 s apart, and the position's rms, m.
  std::pair<double, double> errors(const BatchEstimate& estimate) const {
    double nees = 0, square_m2 = 0;
    int count = 0;
    for (std::size_t i = 25; i < estimate.path.size(); i += 50, ++count) {
      const PathPose& pose = estimate.path[i];
      const auto true_pose = std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) {
        return distance(a, pose.t_s) < distance(b, pose.t_s);
      });
      const Vector6d error = poseDifference(pose.T_odom_robot.pose, true_pose->T_odom_robot);
      nees += normalizedSquare(pose.T_odom_robot.covariance, error);
      square_m2 += error.head<3>().squaredNorm();
    }
    return {nees / count, std::sqrt(square_m2 / count)};
  }
  double distance(const StampedPose& pose, double t_s) const {
    return std::abs(secondsBetween(input.data.time_zero, pose.time) - t_s);
  }
};

// Another's simulation, without anything left out: the noise must be what the data sheets and the corners'
// covariances say, and the path be where it says it is.
TEST(BatchSample, ResidualsOfACleanRecordingAreItsNoise) {
  FATHOM_NEEDS_SHARED("data/sample/none/recording.rawlog");
  const SampleRun run("none");
  BatchOptions options;
  BatchEstimate estimate = estimateBatch(run.input.data, run.input.start, options);
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  // Its corners are noisier than the fit of their edges says.
  estimate = adaptNoise(run.input.data, estimate, options);
  EXPECT_LT(options.problem.noise_scale[indexOf(kChannel<Markers>)], 2.5);
  for (const auto& [channel, residual] : estimate.residuals) {
    const double ratio = residual.rms / residual.expected_rms;
    RecordProperty(nameOf(channel), std::to_string(ratio));
    if (channel == kChannel<Prior>) continue;
    EXPECT_NEAR(ratio, 1.0, 0.1) << nameOf(channel);
  }
  const auto [nees, rms_m] = run.errors(estimate);
  RecordProperty("nees", std::to_string(nees));
  RecordProperty("rms_m", std::to_string(rms_m));
  EXPECT_LT(rms_m, 0.01);
  EXPECT_LT(nees, 6.0 + 4.5 * std::sqrt(12.0 / 35.0));
}

TEST(BatchSample, FindsTheMarkerThatWasMoved) {
  if (test::kSanitized)
    GTEST_SKIP() << "minutes under sanitizers: the clean recording takes the same way there";
  FATHOM_NEEDS_SHARED("data/sample/marker_moved/recording.rawlog");
  const auto truth = nlohmann::json::parse(
      readTextFile(test::sharedData("data/sample/marker_moved/truth.json")))["effects"][0]["parameters"];
  BatchOptions options;
  options.calibration.on.set(kEffectIndex<MarkerMoved>);
  options.calibration.of<MarkerMoved>()[0] = truth["marker_id"].get<double>();
  options.problem.estimate = options.calibration.on;
  const SampleRun run("marker_moved");
  BatchEstimate estimate = estimateBatch(run.input.data, run.input.start, options);
  ASSERT_TRUE(estimate.succeeded) << estimate.failure;
  estimate = adaptNoise(run.input.data, estimate, options);
  ASSERT_EQ(estimate.effects.size(), 4u);
  const auto& e = estimate.effects;
  // A marker's corners err alike from image to image, which sigma does not know: 4 of it for three values.
  EXPECT_NEAR(e[0].value, truth["offset_m"][0].get<double>(), 4 * e[0].sigma);
  EXPECT_NEAR(e[1].value, truth["offset_m"][1].get<double>(), 4 * e[1].sigma);
  EXPECT_NEAR(e[3].value, truth["rotation_deg"].get<double>(), 4 * e[3].sigma);
  EXPECT_LT(e[0].sigma, 0.001);
}

}  // namespace
}  // namespace fathom
