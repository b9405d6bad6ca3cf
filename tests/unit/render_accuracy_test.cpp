// The renderer beside independent computations: projected corners, rays cast at every triangle, areas.
#include <gtest/gtest.h>

#include <array>
#include <opencv2/core.hpp>

#include "core/linear_algebra.h"
#include "render/renderer.h"
#include "support/ray_caster.h"
#include "support/render_scenes.h"

namespace fathom::test {
namespace {

const Eigen::Vector3f kWhite = Eigen::Vector3f::Constant(0.85f), kBlack = Eigen::Vector3f::Constant(0.04f);

/// Strong barrel distortion: the image's corners see 6 degrees further than without.
CameraModel wideCamera() {
  CameraModel camera;
  camera.width_px = 400;
  camera.height_px = 300;
  camera.fx_px = camera.fy_px = 250;
  camera.cx_px = 205;
  camera.cy_px = 148;
  camera.k1 = -0.16;
  camera.k2 = 0.02;
  camera.p1 = 0.002;
  return camera;
}

/// In front of the camera, turned up to a radian, and somewhere in the image.
Pose randomPoseInView(Random& random, double distance_m) {
  const Matrix3d towards_camera = Vector3d(1, -1, -1).asDiagonal();
  const Vector3d turn = random.uniform(0.0, 0.9) * random.normal3().normalized();
  return {expSO3<double>(turn) * towards_camera,
          Vector3d(random.uniform(-0.3, 0.3), random.uniform(-0.25, 0.25), 1.0) * distance_m};
}

Surface posed(const Surface& surface, const Pose& pose) {
  Surface result;
  result.add(surface, pose);
  return result;
}

/// Where a bright rectangle's edge from corner p to corner q crosses the pixel columns (or, if the edge is
/// steep, rows) between: the sum over nine pixels across the edge is the length of the bright part.
std::vector<Vector2d> edgePoints(const cv::Mat& radiance, const Vector2d& p, const Vector2d& q,
                                 const Vector2d& middle) {
  const bool steep = std::abs(q.y() - p.y()) > std::abs(q.x() - p.x());
  const int along = steep ? 1 : 0, across = 1 - along;
  std::vector<Vector2d> points;
  const double first = std::min(p[along], q[along]) + 6, last = std::max(p[along], q[along]) - 6;
  for (int k = static_cast<int>(std::ceil(first)); k <= last; ++k) {
    const double guess = p[across] + (q[across] - p[across]) * (k - p[along]) / (q[along] - p[along]);
    const int centre = static_cast<int>(std::lround(guess));
    if (k < 0 || centre < 4 || k >= (steep ? radiance.rows : radiance.cols) ||
        centre + 4 >= (steep ? radiance.cols : radiance.rows))
      continue;
    double bright = 0;
    for (int i = centre - 4; i <= centre + 4; ++i)
      bright += static_cast<double>((steep ? radiance.at<cv::Vec3f>(k, i) : radiance.at<cv::Vec3f>(i, k))[0]);
    const bool bright_first = middle[across] < guess;
    Vector2d point;
    point[along] = k;
    point[across] = bright_first ? centre - 4.5 + bright : centre + 4.5 - bright;
    points.push_back(point);
  }
  return points;
}

/// Homogeneous line through points, least squares.
Vector3d lineThrough(const std::vector<Vector2d>& points) {
  Vector2d mean = Vector2d::Zero();
  for (const auto& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const auto& point : points) scatter += (point - mean) * (point - mean).transpose();
  const Vector2d normal = eigenOf(scatter).vectors.col(0);
  return {normal.x(), normal.y(), -normal.dot(mean)};
}

class RenderAccuracy : public testing::TestWithParam<CameraModel> {
 protected:
  const CameraModel camera = GetParam();
  Renderer renderer{camera};
  Random random{7};
};
INSTANTIATE_TEST_SUITE_P(Cameras, RenderAccuracy, testing::Values(rovCamera(), wideCamera()),
                         [](const auto& test) { return test.index == 0 ? "rov" : "wide"; });

// Lines fitted to the image's edges, freed of distortion, meet where the camera model sees the corners.
TEST_P(RenderAccuracy, CornersLieWhereTheCameraModelProjectsThem) {
  int corners = 0;
  double sum_squared = 0;
  for (int n = 0; n < 12; ++n) {
    const Pose T_camera_rectangle = randomPoseInView(random, 1.5);
    renderer.setScene(posed(rectangle(0.5, 0.4, Eigen::Vector3f::Ones()), T_camera_rectangle));
    const View view = renderer.render({}, {});
    const Vector2d middle = camera.project(T_camera_rectangle.position);
    std::array<Vector2d, 4> expected_px;
    for (std::size_t k = 0; k < 4; ++k) {
      const double x = k == 0 || k == 3 ? -0.25 : 0.25, y = k < 2 ? -0.2 : 0.2;
      expected_px[k] = camera.project(Vector3d(T_camera_rectangle * Vector3d(x, y, 0)));
    }
    std::array<Vector3d, 4> lines;
    bool all_seen = true;
    for (std::size_t k = 0; k < 4; ++k) {
      auto points = edgePoints(view.radiance, expected_px[k], expected_px[(k + 1) % 4], middle);
      all_seen = all_seen && points.size() >= 30;
      for (auto& point : points) point = camera.idealAt(point);
      if (all_seen) lines[k] = lineThrough(points);
    }
    if (!all_seen) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3d corner = lines[(k + 3) % 4].cross(lines[k]);
      const double error_px = (camera.project(corner) - expected_px[k]).norm();
      EXPECT_LT(error_px, 0.05) << "view " << n << ", corner " << k;
      sum_squared += error_px * error_px;
      ++corners;
    }
  }
  EXPECT_GE(corners, 24);
  EXPECT_LT(std::sqrt(sum_squared / corners), 0.02);
}

// The share of a pixel that a white rectangle covers, by 16 x 16 rays each. 25 samples on a sheared grid
// differ from that by a few of them in a pixel, but not on average.
TEST_P(RenderAccuracy, EdgesCoverPixelsByTheirArea) {
  const auto columns = static_cast<std::size_t>(camera.width_px) + 1;
  std::vector<Vector2d> ideal_at_corner;  // of the pixels
  for (int v = 0; v <= camera.height_px; ++v)
    for (int u = 0; u <= camera.width_px; ++u)
      ideal_at_corner.push_back(camera.idealAt(Vector2d(u - 0.5, v - 0.5)));
  for (int n = 0; n < 2; ++n) {
    const Pose T_camera_rectangle = randomPoseInView(random, 1.5);
    renderer.setScene(posed(rectangle(0.5, 0.4, Eigen::Vector3f::Ones()), T_camera_rectangle));
    const View view = renderer.render({}, {});
    const Pose T_rectangle_camera = T_camera_rectangle.inverse();
    const auto covers = [&](const Vector2d& ideal) {
      const Vector3d ray = T_rectangle_camera.rotation * ideal.homogeneous();
      const Vector3d hit = T_rectangle_camera.position - T_rectangle_camera.position.z() / ray.z() * ray;
      return std::abs(hit.x()) <= 0.25 && std::abs(hit.y()) <= 0.2;
    };
    int edge_pixels = 0;
    double sum = 0;
    for (int v = 0; v < camera.height_px; ++v)
      for (int u = 0; u < camera.width_px; ++u) {
        const float value = view.radiance.at<cv::Vec3f>(v, u)[0];
        int corners_covered = 0;
        const std::size_t first = static_cast<std::size_t>(v) * columns + static_cast<std::size_t>(u);
        for (const std::size_t corner : {first, first + 1, first + columns, first + columns + 1})
          corners_covered += covers(ideal_at_corner[corner]);
        if (corners_covered == 0 || corners_covered == 4) {
          EXPECT_GE(value, corners_covered == 4 ? 1.0f : 0.0f) << u << ' ' << v;
          EXPECT_LE(value, corners_covered == 4 ? 1.0f : 0.13f) << u << ' ' << v;  // its corner may reach in
          continue;
        }
        ++edge_pixels;
        int hits = 0;
        for (int i = 0; i < 16; ++i)
          for (int j = 0; j < 16; ++j)
            hits += covers(camera.idealAt(Vector2d(u + (i + 0.5) / 16 - 0.5, v + (j + 0.5) / 16 - 0.5)));
        EXPECT_NEAR(value, hits / 256.0, 0.13) << u << ' ' << v;
        sum += value - hits / 256.0;
      }
    EXPECT_GT(edge_pixels, 150);
    EXPECT_NEAR(sum / edge_pixels, 0, 0.005);  // so edges lie right to 0.005 px on average
  }
}

TEST_P(RenderAccuracy, RangeIsThatOfTheRayToThePlane) {
  for (int n = 0; n < 5; ++n) {
    const Pose T_camera_rectangle = randomPoseInView(random, random.uniform(0.5, 5.0));
    const Pose T_odom_camera{expSO3<double>(random.normal3()), 5.0 * random.normal3()};
    const Surface scene = posed(rectangle(2, 2, kWhite), T_odom_camera * T_camera_rectangle);
    renderer.setScene(scene);
    const View view = renderer.render(T_odom_camera, {});
    for (int v = 0; v < camera.height_px; v += 3)
      for (int u = 0; u < camera.width_px; u += 3) {
        const Hit hit = castRay(scene, camera, T_odom_camera, Vector2d(u, v));
        const float range_m = view.range_m.at<float>(v, u);
        if (!hit)
          EXPECT_EQ(range_m, std::numeric_limits<float>::infinity()) << u << ' ' << v;
        else
          EXPECT_NEAR(range_m, hit.range_m, 1e-5 * hit.range_m) << u << ' ' << v;
      }
  }
}

TEST_P(RenderAccuracy, WhiteAndBlackAreExactUnderAmbientLight) {
  for (const auto& albedo : {kWhite, kBlack}) {
    renderer.setScene(posed(rectangle(20, 20, albedo), {Matrix3d::Identity(), Vector3d(0, 0, 2)}));
    const View view = renderer.render({expSO3<double>(Vector3d(0.3, -0.2, 0.1)), Vector3d::Zero()}, {});
    double smallest = 0, largest = 0;
    cv::minMaxIdx(view.radiance.reshape(1), &smallest, &largest);
    EXPECT_NEAR(smallest, albedo[0], 1e-6);
    EXPECT_NEAR(largest, albedo[0], 1e-6);
  }
}

TEST_P(RenderAccuracy, SpotsLightAsTheCosineOverTheSquareOfTheDistance) {
  for (int n = 0; n < 3; ++n) {
    const Surface scene = posed(rectangle(4, 4, {0.7f, 0.5f, 0.3f}), randomPoseInView(random, 2.0));
    renderer.setScene(scene);
    Lighting lighting = lampsBeside({}, 0.15f, 1.5f);
    const View view = renderer.render({}, lighting);
    int lit = 0, unlit = 0;
    for (int v = 0; v < camera.height_px; v += 5)
      for (int u = 0; u < camera.width_px; u += 5) {
        const Vector3d ray = camera.rayAt(Vector2d(u, v));
        const Hit hit = castRay(scene, Vector3d::Zero(), ray);
        if (!hit || hit.range_m * ray.z() < 0.1) continue;
        // At a cone's rim, a hair decides.
        const auto at_rim = [&](double wider_rad) {
          Lighting other = lighting;
          for (Spot& spot : other.spots) spot.half_angle_rad += wider_rad;
          return lightOf(hit, scene, other, Vector3d::Zero(), ray);
        };
        if (at_rim(-1e-4) != at_rim(1e-4)) continue;
        const Vector3d expected = lightOf(hit, scene, lighting, Vector3d::Zero(), ray);
        (expected[0] > 0.15 * 0.7001 ? lit : unlit) += 1;
        const auto& value = view.radiance.at<cv::Vec3f>(v, u);
        if (hit.edge_margin < 0.01) continue;  // the pixel may be shared with what lies beside
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(value[c], expected[c], 1e-5 * expected[c] + 1e-6) << u << ' ' << v;
      }
    EXPECT_GT(lit, 300);
    EXPECT_GT(unlit, 20);
  }
}

// Panel, knobs with smooth sides, and sea floor with its albedo between the vertices: 7900 triangles.
TEST_P(RenderAccuracy, SceneIsTheOneThatRaysHit) {
  const Surface scene = panelOnSeaFloor();
  renderer.setScene(scene);
  int pixels = 0, wrong_range = 0, wrong_light = 0;
  for (int n = 0; n < 4; ++n) {
    const Pose T_odom_camera =
        lookingAt(kPanelPosition_odom +
                      Vector3d(random.uniform(-3, -1), random.uniform(-1, 1), random.uniform(-0.3, 0.5)),
                  kPanelPosition_odom + 0.2 * random.normal3());
    const Lighting lighting = lampsBeside(T_odom_camera, 0.3f, 1.0f);
    const View view = renderer.render(T_odom_camera, lighting);
    for (int k = 0; k < 300; ++k) {
      const int u = static_cast<int>(random.uniform(0, camera.width_px));
      const int v = static_cast<int>(random.uniform(0, camera.height_px));
      const Vector3d ray_odom = T_odom_camera.rotation * camera.rayAt(Vector2d(u, v));
      const Hit hit = castRay(scene, T_odom_camera.position, ray_odom);
      const float range_m = view.range_m.at<float>(v, u);
      ++pixels;
      if (!hit || std::isinf(range_m)) {
        wrong_range += bool(hit) == std::isinf(range_m);
        continue;
      }
      wrong_range += !(std::abs(range_m - hit.range_m) <= 1e-4 * hit.range_m);
      const Vector3d expected = lightOf(hit, scene, lighting, T_odom_camera.position, ray_odom);
      const auto& value = view.radiance.at<cv::Vec3f>(v, u);
      wrong_light += !(std::abs(value[0] - expected[0]) <= 2e-3 * expected[0]);
    }
  }
  // The knobs' sides, and markers far away, have triangles narrower than a pixel, which may be missed.
  EXPECT_LE(wrong_range, pixels / 150);
  // Pixels that markers' cells share, or a cone's rim, are mixtures where the ray sees one thing.
  EXPECT_LE(wrong_light, pixels / 6);
}

// Edges along the image's axes are the hard case of supersampling: S x S samples on a square grid know S
// places.
TEST(RenderEdges, LieRightAlongTheImagesAxesToo) {
  CameraModel camera;
  camera.width_px = 120;
  camera.height_px = 90;
  camera.fx_px = camera.fy_px = 100;
  camera.cx_px = 59.5;
  camera.cy_px = 44.5;
  for (const int supersampling : {2, 4, 8}) {
    Renderer renderer(camera, Renderer::Options{supersampling});
    Random random(3);
    for (int n = 0; n < 20; ++n) {
      const double width_px = random.uniform(20, 60), left_px = random.uniform(10, 40);
      Surface scene = rectangle(width_px / 100, 2, Eigen::Vector3f::Ones());
      for (auto& vertex : scene.vertices)
        vertex.position +=
            Eigen::Vector3f(static_cast<float>((left_px + width_px / 2 - camera.cx_px) / 100), 0, 1);
      renderer.setScene(scene);
      const View view = renderer.render({}, {});
      double left_half = 0, right_half = 0;  // of row 45
      const int middle = static_cast<int>(left_px + width_px / 2);
      for (int u = 0; u < 120; ++u)
        (u <= middle ? left_half : right_half) += static_cast<double>(view.radiance.at<cv::Vec3f>(45, u)[0]);
      const double tolerance_px = 0.5 / (supersampling * supersampling) + 1e-3;
      EXPECT_NEAR(middle + 0.5 - left_half, left_px, tolerance_px);
      EXPECT_NEAR(middle + 0.5 + right_half, left_px + width_px, tolerance_px);
    }
  }
}

// A square on its corner: what its edges smear is the pixel's own width, rising or falling. Samples whose
// offsets along the axes went together, as i + j side and j + i side do, gave one pair 1.4 to 2.8 times the
// other's.
TEST(RenderEdges, AreAsSharpRisingAsFalling) {
  CameraModel camera;
  camera.width_px = camera.height_px = 120;
  camera.fx_px = camera.fy_px = 100;
  camera.cx_px = camera.cy_px = 59.5;
  for (const int supersampling : {4, 5, 8}) {
    Renderer renderer(camera, Renderer::Options{supersampling});
    renderer.setScene(posed(rectangle(0.613, 0.613, Eigen::Vector3f::Ones()),
                            {expSO3<double>(Vector3d(0, 0, radians(45))), Vector3d(0, 0, 1)}));
    const View view = renderer.render({}, {});
    double rising = 0, falling = 0;
    for (int v = 0; v < 120; ++v)
      for (int u = 0; u < 120; ++u) {
        const auto covered = static_cast<double>(view.radiance.at<cv::Vec3f>(v, u)[0]);
        ((u < 60) == (v < 60) ? rising : falling) += covered * (1 - covered);
      }
    EXPECT_GT(rising, 5);
    // One edge crosses pixels in as many ways as it is long, some 43: each sum is right to a few percent.
    EXPECT_NEAR(rising / falling, 1, 0.05) << supersampling;
  }
}

TEST(RenderEdges, MarkerAMillimetreBeforeTheFaceHidesItFromAfar) {
  Renderer renderer(rovCamera());
  for (const double distance_m : {0.5, 2.0, 10.0, 30.0}) {
    Surface scene;
    const Matrix3d towards_camera = Vector3d(1, -1, -1).asDiagonal();
    scene.add(rectangle(distance_m, distance_m, kBlack), {towards_camera, Vector3d(0, 0, distance_m)});
    scene.add(rectangle(0.5 * distance_m, 0.5 * distance_m, kWhite),
              {towards_camera, Vector3d(0, 0, distance_m - 0.001)});
    renderer.setScene(scene);
    const View view = renderer.render({expSO3<double>(Vector3d(0.1, -0.1, 0.0)), Vector3d::Zero()}, {});
    int white = 0, mixed = 0;
    for (int v = 0; v < 480; ++v)
      for (int u = 0; u < 640; ++u) {
        const float value = view.radiance.at<cv::Vec3f>(v, u)[0];
        white += value > 0.8499f;
        mixed += value > 0.05f && value < 0.84f;
      }
    EXPECT_NEAR(white + 0.5 * mixed, 277.6 * 277.6, 0.03 * 277.6 * 277.6) << distance_m;
    EXPECT_LT(mixed, 4 * 2 * 290) << distance_m;  // along the four edges only
  }
}

}  // namespace
}  // namespace fathom::test
