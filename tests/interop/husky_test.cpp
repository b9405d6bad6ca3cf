// A real ROS bag, imported and fused, ends where robot_localization's own regression test says it ends.
#include <gtest/gtest.h>

#include "core/files.h"
#include "localization/localizer.h"
#include "recording/import_bag.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

namespace fs = std::filesystem;

// Expected (-40.0454, -76.9988, -2.6974) within 1.0452 m: values and tolerance of that project, see
// ../shared/data/README.md. A regression value, not surveyed truth.
TEST(Husky, EndsWhereThePeerDoes) {
  FATHOM_NEEDS_SHARED("data/robot_localization/test1.bag");
  const fs::path config = fs::path(FATHOM_SOURCE_DIR) / "config";
  const auto imported = importBag(test::sharedData("data/robot_localization/test1.bag"),
                                  readTopicMap(config / "husky_topics.yaml"));
  const fs::path vehicle = test::scratchFolder() / "vehicle.yaml";
  writeTextFile(vehicle, imported.vehicle_yaml);
  LocalizationSetup setup;
  setup.vehicle = readVehicle(vehicle);
  setup.options = readLocalizationOptions(config / "husky.yaml");
  setup.time_zero = imported.start;
  Vector3d last = Vector3d::Zero();
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& e) { last = e.state.motion.position_odom; };
  std::size_t k = 0;
  const auto next = [&]() -> std::optional<Sample> {
    if (k == imported.samples.size()) return std::nullopt;
    return imported.samples[k++];
  };
  const LocalizationSummary summary = localize(setup, next, sink);
  ASSERT_TRUE(summary.started);
  EXPECT_LT((last - Vector3d(-40.0454, -76.9988, -2.6974)).norm(), 1.0452) << last.transpose();
}

}  // namespace
}  // namespace fathom
