#include "render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "support/render_scenes.h"

namespace fathom::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

CameraModel smallCamera() {
  CameraModel camera = rovCamera();
  camera.width_px = 160;
  camera.height_px = 120;
  camera.fx_px = camera.fy_px = 138.8;
  camera.cx_px = 80.3;
  camera.cy_px = 61.2;
  return camera;
}

Surface squareAt(const Vector3d& position_camera, const Eigen::Vector3f& albedo, double side_m = 0.2) {
  Surface surface;
  surface.add(rectangle(side_m, side_m, albedo), {Vector3d(1, -1, -1).asDiagonal(), position_camera});
  return surface;
}

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

bool sameBytes(const View& a, const View& b) {
  return sameBytes(a.radiance, b.radiance) && sameBytes(a.range_m, b.range_m);
}

View viewOfPanel(Renderer& renderer, int n) {
  const Pose T_odom_camera =
      lookingAt(kPanelPosition_odom + Vector3d(-1.8, -0.6 + 0.3 * n, 0.3), kPanelPosition_odom);
  return renderer.render(T_odom_camera, lampsBeside(T_odom_camera, 0.3f, 1.0f));
}

TEST(Renderer, ImageIsUpright) {  // camera frame: x right, y down, z forward
  Renderer renderer(smallCamera());
  Surface scene = squareAt({0.3, 0, 1}, {1, 0, 0});
  scene.add(squareAt({0, 0.3, 1}, {0, 1, 0}));
  scene.add(squareAt({-0.3, -0.3, 1}, {0, 0, 1}));
  renderer.setScene(scene);
  const View view = renderer.render({}, {});
  EXPECT_EQ(view.radiance.type(), CV_32FC3);
  EXPECT_EQ(view.range_m.type(), CV_32FC1);
  EXPECT_EQ(view.radiance.size(), cv::Size(160, 120));
  EXPECT_EQ(view.range_m.size(), cv::Size(160, 120));
  EXPECT_EQ(view.radiance.at<cv::Vec3f>(61, 122), cv::Vec3f(1, 0, 0));  // right
  EXPECT_EQ(view.radiance.at<cv::Vec3f>(103, 80), cv::Vec3f(0, 1, 0));  // below
  EXPECT_EQ(view.radiance.at<cv::Vec3f>(20, 39), cv::Vec3f(0, 0, 1));   // left, above
  EXPECT_EQ(view.radiance.at<cv::Vec3f>(61, 80), cv::Vec3f(0, 0, 0));
}

TEST(Renderer, NothingHasNoRadianceAndInfiniteRange) {
  Renderer renderer(smallCamera());
  const auto expectNothing = [&](const char* what) {
    const View view = renderer.render({}, {});
    EXPECT_EQ(cv::countNonZero(view.radiance.reshape(1)), 0) << what;
    EXPECT_EQ(cv::countNonZero(view.range_m == kInfinity), 160 * 120) << what;
  };
  expectNothing("no scene yet");
  renderer.setScene(squareAt({0, 0, -1}, {1, 1, 1}));
  expectNothing("behind the camera");
  renderer.setScene(squareAt({0, 0, 0.005}, {1, 1, 1}));
  expectNothing("nearer than 1 cm");
  renderer.setScene({});
  expectNothing("an empty scene");
}

TEST(Renderer, TrianglesReachingBehindTheCameraAreCutOff) {
  // A floor 1 m below the camera, 100 m to all sides: below the horizon there is floor, above there is
  // nothing.
  Renderer renderer(smallCamera());
  Surface floor;
  const Matrix3d up = (Matrix3d() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  floor.add(rectangle(200, 200, {0.5f, 0.5f, 0.5f}), {up, Vector3d(0, 1, 0)});
  renderer.setScene(floor);
  const View view = renderer.render({}, {});
  const CameraModel camera = smallCamera();
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u) {
      const Vector3d ray = camera.rayAt(Vector2d(u, v));
      const double range_m = 1.0 / ray.y();
      if (ray.y() < -0.005) {
        EXPECT_EQ(view.range_m.at<float>(v, u), kInfinity) << u << ' ' << v;
      } else if (ray.y() > 0.03) {
        EXPECT_NEAR(view.range_m.at<float>(v, u), range_m, 1e-4 * range_m) << u << ' ' << v;
        EXPECT_NEAR(view.radiance.at<cv::Vec3f>(v, u)[2], 0.5f, 1e-6f) << u << ' ' << v;
      }
    }
}

TEST(Renderer, EdgesAreMixtures) {
  Renderer renderer(smallCamera());
  renderer.setScene(squareAt({0, 0, 1}, {1, 1, 1}, 0.4));
  const View view = renderer.render({expSO3<double>(Vector3d(0, 0, 0.2)), Vector3d::Zero()}, {});
  int between = 0;
  for (const auto& rgb : cv::Mat_<cv::Vec3f>(view.radiance)) between += rgb[0] > 0.05f && rgb[0] < 0.95f;
  EXPECT_GT(between, 4 * 40);
  EXPECT_LT(between, 4 * 80);
}

TEST(Renderer, SceneCanBeReplaced) {
  Renderer renderer(smallCamera());
  renderer.setScene(squareAt({0, 0, 1}, {1, 1, 1}));
  View view = renderer.render({}, {});
  EXPECT_NEAR(view.range_m.at<float>(61, 80), 1.0f, 1e-5f);
  const std::uint8_t* memory = view.radiance.data;
  renderer.setScene(squareAt({0, 0, 2}, {0, 1, 0}));
  renderer.render({}, {}, view);
  EXPECT_EQ(view.radiance.data, memory);
  EXPECT_NEAR(view.range_m.at<float>(61, 80), 2.0f, 1e-5f);
  EXPECT_EQ(view.radiance.at<cv::Vec3f>(61, 80), cv::Vec3f(0, 1, 0));
}

TEST(Renderer, ASpotLightsFrontsOnly) {
  Renderer renderer(smallCamera());
  Lighting lighting;
  lighting.ambient.setConstant(0.25f);
  lighting.spots.push_back({{expSO3<double>(Vector3d(0, -std::numbers::pi / 2, 0)), Vector3d::Zero()}, 0.5});
  renderer.setScene(squareAt({0, 0, 2}, {1, 1, 1}));
  EXPECT_NEAR(renderer.render({}, lighting).radiance.at<cv::Vec3f>(61, 80)[0], 0.25 + 0.25, 1e-3);
  Surface turned;
  turned.add(rectangle(0.2, 0.2, {1, 1, 1}), {Matrix3d::Identity(), Vector3d(0, 0, 2)});
  renderer.setScene(turned);
  EXPECT_EQ(renderer.render({}, lighting).radiance.at<cv::Vec3f>(61, 80)[0], 0.25f);
}

TEST(Renderer, TheSameBytesInEveryContextAndThread) {
  Renderer first(smallCamera()), second(smallCamera());
  first.setScene(panelOnSeaFloor());
  second.setScene(panelOnSeaFloor());
  std::vector<View> expected;
  expected.reserve(4);
  for (int n = 0; n < 4; ++n) expected.push_back(viewOfPanel(first, n));
  EXPECT_FALSE(sameBytes(expected[0], expected[1]));
  for (int n = 0; n < 4; ++n)
    EXPECT_TRUE(sameBytes(expected[static_cast<std::size_t>(n)], viewOfPanel(second, n)));

  std::array<std::vector<View>, 2> views;
  const auto work = [](Renderer& renderer, std::vector<View>& own) {
    for (int n = 0; n < 4; ++n) own.push_back(viewOfPanel(renderer, n));
  };
  std::thread one(work, std::ref(first), std::ref(views[0])), two(work, std::ref(second), std::ref(views[1]));
  one.join();
  two.join();
  for (const auto& own : views)
    for (std::size_t n = 0; n < 4; ++n) EXPECT_TRUE(sameBytes(expected[n], own[n]));
}

TEST(Renderer, ThreadsCanMakeTheirOwn) {
  std::array<View, 2> views;
  const auto work = [](View& view) {
    Renderer renderer(smallCamera());
    renderer.setScene(panelOnSeaFloor());
    view = viewOfPanel(renderer, 2);
  };
  std::thread one(work, std::ref(views[0])), two(work, std::ref(views[1]));
  one.join();
  two.join();
  EXPECT_TRUE(sameBytes(views[0], views[1]));
  EXPECT_GT(cv::countNonZero(views[0].range_m < 10), 1000);
}

TEST(Renderer, CanBeMoved) {
  Renderer renderer(smallCamera());
  renderer.setScene(panelOnSeaFloor());
  const View view = viewOfPanel(renderer, 1);
  Renderer moved = std::move(renderer);
  EXPECT_TRUE(sameBytes(view, viewOfPanel(moved, 1)));
}

// Single pixels differ where a sample of the raster falls to the other side of an edge.
TEST(Renderer, BandByBandIsTheSameImage) {
  Renderer whole(rovCamera()), in_bands(rovCamera(), {.drawn_at_once = 50'000});
  for (Renderer* renderer : {&whole, &in_bands}) renderer->setScene(panelOnSeaFloor());
  const View at_once = viewOfPanel(whole, 1), by_bands = viewOfPanel(in_bands, 1);
  cv::Mat apart;
  cv::absdiff(at_once.radiance, by_bands.radiance, apart);
  EXPECT_LT(cv::countNonZero(apart.reshape(1) > 1e-5), 3 * 10);
  cv::absdiff(at_once.range_m, by_bands.range_m, apart);
  EXPECT_LT(cv::countNonZero(apart > 1e-5), 10);
}

TEST(Renderer, AnotherRendersTheSame) {
  Renderer renderer(smallCamera());
  Renderer another = renderer.another();
  EXPECT_EQ(cv::countNonZero(viewOfPanel(another, 1).radiance.reshape(1)), 0);  // it has no scene
  for (Renderer* each : {&renderer, &another}) each->setScene(panelOnSeaFloor());
  EXPECT_TRUE(sameBytes(viewOfPanel(renderer, 1), viewOfPanel(another, 1)));
}

TEST(Renderer, RejectsWhatItCannotRender) {
  const auto with = [](auto&& change) {
    CameraModel camera = smallCamera();
    change(camera);
    return camera;
  };
  EXPECT_THROW(Renderer(with([](auto& c) { c.width_px = 0; })), std::invalid_argument);
  EXPECT_THROW(Renderer(with([](auto& c) { c.height_px = -3; })), std::invalid_argument);
  EXPECT_THROW(Renderer(with([](auto& c) { c.fx_px = 0; })), std::invalid_argument);
  EXPECT_THROW(Renderer(with([](auto& c) { c.fy_px = std::nan(""); })), std::invalid_argument);
  EXPECT_THROW(Renderer(with([](auto& c) { c.k1 = -1.5; })), std::invalid_argument);  // folds over
  CameraModel too_wide{.width_px = 40000, .height_px = 1, .fx_px = 1e5, .fy_px = 1e5};
  EXPECT_THROW(Renderer{too_wide}, std::runtime_error);
  EXPECT_THROW(Renderer(smallCamera(), Renderer::Options{.supersampling = 0}), std::invalid_argument);
  EXPECT_THROW(Renderer(smallCamera(), Renderer::Options{.supersampling = 17}), std::invalid_argument);

  Renderer renderer(smallCamera());
  Surface surface = rectangle(1, 1, {1, 1, 1});
  surface.triangles.push_back({0, 1, 4});
  EXPECT_THROW(renderer.setScene(surface), std::invalid_argument);
  surface.triangles.pop_back();
  surface.vertices[2].position.x() = kInfinity;
  EXPECT_THROW(renderer.setScene(surface), std::invalid_argument);
}

}  // namespace
}  // namespace fathom::test
