#include <gtest/gtest.h>

#include "core/error.h"
#include "estimation/collect_batch.h"
#include "estimation/filter_start.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

using test::at;

Vehicle withAttitude() {
  Vehicle vehicle = readVehicle(test::kRov);
  vehicle.ins->attitude_sigma = 0.01;
  return vehicle;
}

// Two nodes make the mean of a quadratic exact, whatever the samples' times.
TEST(BatchData, NodesAverageAQuadraticAsTheSamplesDo) {
  Random random(1);
  const auto quadratic = [](double t) { return Vector3d(1 + 2 * t - 3 * t * t, t, t * t); };
  std::vector<Sample> samples;
  for (double t = 0.0; t < 1.0; t += random.uniform(0.005, 0.03)) {
    InsSample ins;
    const double stamp_s = secondsBetween(at(0), at(t));
    ins.angular_velocity_ins = quadratic(stamp_s);
    ins.specific_force_ins = quadratic(stamp_s);
    ins.R_odom_ins = expSO3<double>(Vector3d(0, 0, 0.3 * stamp_s));
    samples.push_back({at(t), labels::kIns, ins});
  }
  test::ListSource source(samples);
  const BatchData data = collectBatch(source, {}, withAttitude(), {});
  ASSERT_EQ(data.of<Gyro>().size(), 5u);
  int total = 0;
  for (const BatchReading& bin : data.of<Gyro>()) {
    const Vector3d by_nodes = 0.5 * (quadratic(bin.node_s[0]) + quadratic(bin.node_s[1]));
    EXPECT_LT((bin.seen.value - by_nodes).norm(), 1e-12);
    EXPECT_GE(bin.node_s[0], std::floor(bin.t_s() / 0.2) * 0.2);
    total += bin.samples;
  }
  EXPECT_EQ(total, std::ssize(samples));
  for (const BatchReading& bin :
       data.of<Attitude>()) {  // a steady turn: the mean rotation is that at the mean time
    const Matrix3d mean = bin.seen.about * expSO3<double>(Vector3d(bin.seen.value));
    EXPECT_LT(angleBetween(mean, expSO3<double>(Vector3d(0, 0, 0.3 * bin.t_s()))), 1e-7);
  }
}

TEST(BatchData, LeavesOutAndCountsWhatIsNone) {
  InsSample wrong;
  wrong.angular_velocity_ins = Vector3d(1, 2, std::nan(""));
  DvlSample good, lost, mad;
  good.velocity_dvl = Vector3d(1, 0, 0);
  mad.velocity_dvl = Vector3d(1000, 0, 0);
  test::ListSource source({{at(0), labels::kIns, wrong},
                           {at(0.1), labels::kDvl, good},
                           {at(0.2), labels::kDvl, lost},
                           {at(0.3), labels::kDvl, mad},
                           {at(0.1), labels::kDvl, good}});
  const BatchData data = collectBatch(source, {}, readVehicle(test::kRov), {});
  EXPECT_TRUE(data.of<Gyro>().empty());
  ASSERT_EQ(data.of<Dvl>().size(), 2u);
  EXPECT_NEAR(data.of<Dvl>()[0].t_s(), 0.1, 1e-9);
  EXPECT_EQ(data.left_out.at("not-a-number"), 1u);
  EXPECT_EQ(data.left_out.at("impossible"), 1u);
  EXPECT_EQ(data.left_out.at("DVL without bottom lock"), 1u);
}

TEST(BatchData, TakesMarkersThatAMapHas) {
  test::BatchRun run(3.0);
  std::vector<Sample> samples = run.samples();
  Detections detections = run.detections();
  const std::size_t seen = detections.markerCount();
  auto& first = detections.by_file.begin()->second;
  first[0].id = 999;
  first[1].corners_px[2].x() = std::nan("");
  first[2].covariance_px2.setZero();
  test::ListSource source(samples);
  const BatchData data = collectBatch(source, detections, run.vehicle, {run.panel});
  EXPECT_EQ(data.markers.size(), seen - 3);
  EXPECT_EQ(data.left_out.at("marker that no map has"), 1u);
  EXPECT_EQ(data.left_out.at("marker with corners or a covariance that are none"), 2u);
  EXPECT_EQ(data.markers.back().image, 3u);
  EXPECT_NEAR(data.last_s, 3.0, 1e-6);

  test::ListSource nothing({{at(0), labels::kDepth, DepthSample{{}, 1e5, {}}}});
  EXPECT_THROW(collectBatch(nothing, {}, run.vehicle, {run.panel}), Error);
}

/// Twenty points that two parallel eyes see, one that is two different things, and one at infinity.
TEST(BatchData, LeavesOutTiePointsThatAreNone) {
  const CameraModel camera{640, 480, 500, 500, 319.5, 239.5, 0, 0, 0, 0, 0};
  StereoSample pair;
  pair.T_left_right.position = Vector3d(0.2, 0, 0);
  pair.left_intrinsics = pair.right_intrinsics = recordedCamera(camera);
  pair.left_file = "left.png";
  pair.right_file = "right.png";
  BatchDataOptions options;
  std::vector<TiePoint>& points = options.tie_points["left.png"];
  const Vector2d middle(319.5, 239.5);
  points.push_back({0, {middle, middle}, {1, 1}});
  EXPECT_THROW(
      {
        test::ListSource source({{at(0), labels::kStereo, pair}});
        collectBatch(source, {}, readVehicle(test::kRov), {}, options);
      },
      Error);
  Random random(1);
  for (int id = 1; id <= 21; ++id) {
    const Vector3d point(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(1, 2));
    const double off_px = id == 21 ? 200 : 0.3 * random.normal();
    points.push_back(
        {id,
         {camera.project<double>(point),
          camera.project<double>(Vector3d(point - pair.T_left_right.position)) + Vector2d(0, off_px)},
         {1, 1}});
  }
  test::ListSource source({{at(0), labels::kStereo, pair}});
  const BatchData data = collectBatch(source, {}, readVehicle(test::kRov), {}, options);
  ASSERT_EQ(data.tie_points.size(), 20u);
  EXPECT_EQ(data.tie_points.front().point.id, 1);
  EXPECT_EQ(data.tie_points.back().point.id, 20);
  EXPECT_EQ(data.left_out.at("tie points of two different things"), 2u);
}

}  // namespace
}  // namespace fathom
