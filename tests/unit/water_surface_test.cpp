// A camera in air above water, against Fermat's principle: of all ways over the surface, light takes the one
// that takes least time.
#include "imaging/water_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"
#include "imaging/true_camera.h"
#include "simulation/apparent_scene.h"

namespace fathom {
namespace {

using Vector3l = Eigen::Matrix<long double, 3, 1>;

/// Where light from a point crosses a plane on its way to a camera beyond it: by a search over the plane that
/// knows neither angles nor derivatives. In numbers of 64 bits, for near its least the time tells a place
/// only to the root of what they are rounded to, 3e-10.
Vector3d crossingInLeastTime(const Vector3d& camera, const Vector3d& point, const Vector3d& on_plane,
                             const Vector3d& normal, double index) {
  const Vector3l right = normal.unitOrthogonal().cast<long double>(),
                 up = normal.cast<long double>().cross(right);
  const auto at = [&](long double x, long double y) {
    return Vector3l(on_plane.cast<long double>() + x * right + y * up);
  };
  const auto time = [&](long double x, long double y) {
    const Vector3l crossing = at(x, y);
    return (camera.cast<long double>() - crossing).norm() +
           index * (crossing - point.cast<long double>()).norm();
  };
  long double x = 0, y = 0, best = time(x, y);
  for (long double step = 1; step > 1e-12L;) {
    bool moved = false;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const long double there = time(x + dx * step, y + dy * step);
      if (!(there < best)) continue;
      best = there;
      x += dx * step;
      y += dy * step;
      moved = true;
    }
    if (!moved) step /= 2;
  }
  return at(x, y).cast<double>();
}

/// A camera above a pool, a panel that lies in it, and one marker on that.
struct Pool {
  double water_m = 0.5, tilt_x_rad = 0, tilt_y_rad = 0, index = 1.34;
  KinematicState<double> robot;
  Pose T_robot_camera;
  CameraModel camera{.fx_px = 555, .fy_px = 555, .k1 = -0.04, .k2 = 0.01, .p1 = 1e-3, .above_water = true};
  Pose T_odom_panel;
  Marker marker{"tag36h11", 3, 0.2, {}};

  /// The camera at random, up to 60 degrees off the vertical, and the marker about the middle of its image.
  explicit Pool(Random& random) {
    water_m = random.uniform(0.1, 1.5);
    tilt_x_rad = radians(random.uniform(-3, 3));
    tilt_y_rad = radians(random.uniform(-3, 3));
    index = random.uniform(1.33, 1.345);
    T_odom_panel = {
        rotationFromYawPitchRoll(random.uniform(-3, 3), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)),
        {2, -1, -3}};
    T_robot_camera = {expSO3<double>(random.normal3()), 0.3 * random.normal3()};
    const Matrix3d R_down = Vector3d(1, -1, -1).asDiagonal();
    const Pose T_odom_camera{
        expSO3<double>({0, 0, random.uniform(-3, 3)}) * R_down *
            expSO3<double>(Vector3d(radians(random.uniform(-60, 60)), radians(random.uniform(-20, 20)), 0)),
        Vector3d(2 + random.uniform(-1, 1), -1 + random.uniform(-1, 1),
                 -3 + water_m + random.uniform(0.3, 2.5))};
    const Pose T_odom_robot = T_odom_camera * T_robot_camera.inverse();
    robot.position_odom = T_odom_robot.position;
    robot.R_odom_robot = T_odom_robot.rotation;
    // At its depth below the camera, straight ahead.
    const Vector3d ahead = T_odom_camera.rotation.col(2);
    const double depth_m = random.uniform(0.05, 0.9) * water_m;
    const Vector3d seen =
        T_odom_camera.position + (-3 + water_m - depth_m - T_odom_camera.position.z()) / ahead.z() * ahead;
    marker.T_panel_marker = T_odom_panel.inverse() * Pose{expSO3<double>(0.1 * random.normal3()), seen};
  }

  EffectParameters<double> effects() const {
    EffectParameters<double> effects;
    effects.add<FlatWaterSurface>(
        {water_m, degrees(tilt_x_rad), degrees(tilt_y_rad), std::log(index / kWaterIndex)});
    return effects;
  }
  Vector3d normal() const { return expSO3<double>(Vector3d(tilt_x_rad, tilt_y_rad, 0)) * Vector3d::UnitZ(); }
  Vector3d onSurface() const { return T_odom_panel.position + water_m * Vector3d::UnitZ(); }
  double heightOver(const Vector3d& point_odom) const { return normal().dot(point_odom - onSurface()); }
  Pose T_odom_camera() const { return Pose{robot.R_odom_robot, robot.position_odom} * T_robot_camera; }
  std::vector<Vector3d> corners_odom() const {
    std::vector<Vector3d> corners;
    for (const Vector3d& corner : marker.corners_panel()) corners.push_back(T_odom_panel * corner);
    return corners;
  }
  std::array<Vector2d, 4> predicted(const EffectParameters<double>& effects) const {
    return predictCorners<double>(robot, nominalPlacement<double>(T_odom_panel, 0), marker, camera,
                                  T_robot_camera, effects, 0);
  }
  CameraProjector<double> projector() const {
    return trueCamera(camera, T_robot_camera, robot, effects(), 0, {}, T_odom_panel.position).projector;
  }
  /// Below the surface and in sight.
  bool isSeen(const Vector3d& point_odom) const {
    const Vector3d point_camera = T_odom_camera().inverse() * point_odom;
    return heightOver(point_odom) < -1e-3 && point_camera.z() > 0.1 &&
           point_camera.head<2>().norm() < point_camera.z();
  }
};

/// 1e-6 px are 2e-9 of the distance; the search is good to 3e-10 of it.
TEST(WaterSurface, LightTakesTheWayOfLeastTime) {
  Random random(1);
  int seen = 0;
  double bent_px = 0;
  for (int i = 0; i < 200; ++i) {
    const Pool pool(random);
    const auto pixels = pool.predicted(pool.effects()), straight = pool.predicted({});
    const auto corners = pool.corners_odom();
    const Pose T_odom_camera = pool.T_odom_camera();
    for (std::size_t k = 0; k < 4; ++k) {
      if (!pool.isSeen(corners[k])) continue;
      const Vector3d crossing = crossingInLeastTime(T_odom_camera.position, corners[k], pool.onSurface(),
                                                    pool.normal(), pool.index);
      const Vector2d expected = pool.camera.project<double>(T_odom_camera.inverse() * crossing);
      EXPECT_LT((pixels[k] - expected).norm(), 2e-6) << i;
      bent_px = std::max(bent_px, (pixels[k] - straight[k]).norm());
      ++seen;
    }
  }
  EXPECT_GT(seen, 400);
  EXPECT_GT(bent_px, 30);
}

/// A second panel is in the same water: over where the map has the first one's origin.
TEST(WaterSurface, IsOneForAllPanels) {
  Random random(2);
  const Pool pool(random);
  const Pose T_panel_other{expSO3<double>(Vector3d(0.3, -0.2, 0.5)), {0.3, 0.2, -0.4}};
  Marker of_other = pool.marker;
  of_other.T_panel_marker = T_panel_other.inverse() * pool.marker.T_panel_marker;
  const auto expected = pool.predicted(pool.effects());
  const auto pixels = predictCorners<double>(
      pool.robot, nominalPlacement<double>(pool.T_odom_panel * T_panel_other, 0, pool.T_odom_panel.position),
      of_other, pool.camera, pool.T_robot_camera, pool.effects(), 0);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((pixels[k] - expected[k]).norm(), 1e-9);
}

/// A panel that is pushed takes no water along.
TEST(WaterSurface, StaysWhereAPanelIsPushed) {
  Random random(3);
  const Pool pool(random);
  EffectParameters<double> pushed = pool.effects();
  pushed.add<PanelMoved>({-1, 0.02, -0.01, 0.03, 0, 0, 0});
  Pool there = pool;
  there.marker.T_panel_marker.position += Vector3d(0.02, -0.01, 0.03);
  const auto pixels = pool.predicted(pushed), expected = there.predicted(pool.effects());
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((pixels[k] - expected[k]).norm(), 1e-9);
}

TEST(WaterSurface, ChangesNothingWhereThereIsNoneToLookThrough) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    Pool pool(random);
    const auto straight = pool.predicted({});
    const auto expectStraight = [&](const Pool& one, const char* why) {
      const auto pixels = one.predicted(one.effects());
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT((pixels[k] - straight[k]).norm(), 1e-9 * (1 + straight[k].norm())) << why;
    };
    Pool none = pool;
    none.water_m = 0;
    expectStraight(none, "no water");
    Pool other = pool;
    other.camera.above_water = false;
    expectStraight(other, "a camera of which nobody says that it is above water");
    Pool flooded = pool;
    flooded.water_m = 6;
    expectStraight(flooded, "a camera below the surface");
    Pool ashore = pool;
    ashore.T_odom_panel.position.z() -= 5;  // and the surface with it
    ashore.marker.T_panel_marker =
        ashore.T_odom_panel.inverse() * pool.T_odom_panel * pool.marker.T_panel_marker;
    expectStraight(ashore, "what is above the surface");
  }
}

/// From no water on it comes smoothly, though the marker may be metres below the panel's origin: over a
/// millimetre it moves by a fiftieth of what it does over the first 0.05 m, at most thrice that.
TEST(WaterSurface, ComesFromNothing) {
  Random random(5);
  double longest_px = 0;
  for (int i = 0; i < 50; ++i) {
    Pool pool(random);
    pool.water_m = 0;
    const Pose T_odom_marker = pool.T_odom_panel * pool.marker.T_panel_marker;
    pool.T_odom_panel.position.z() = pool.T_odom_camera().position.z() - 0.3;
    pool.marker.T_panel_marker = pool.T_odom_panel.inverse() * T_odom_marker;
    auto before = pool.predicted(pool.effects());
    const auto nothing = before;
    std::array<double, 4> step_px{};
    for (int mm = 1; mm <= 50; ++mm) {
      pool.water_m = 1e-3 * mm;
      const auto after = pool.predicted(pool.effects());
      for (std::size_t k = 0; k < 4; ++k) step_px[k] = std::max(step_px[k], (after[k] - before[k]).norm());
      before = after;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (!pool.isSeen(pool.corners_odom()[k])) continue;
      const double all_px = (before[k] - nothing[k]).norm();
      EXPECT_LT(step_px[k], 3.0 / 50 * all_px + 0.1) << i;
      longest_px = std::max(longest_px, all_px);
    }
  }
  EXPECT_GT(longest_px, 10);
}

/// The other way: what is seen at a pixel lies on its line of sight.
TEST(WaterSurface, LineOfSightLeadsToWhatIsSeen) {
  Random random(6);
  int seen = 0;
  for (int i = 0; i < 100; ++i) {
    const Pool pool(random);
    const CameraProjector<double> projector = pool.projector();
    const Pose T_odom_camera = pool.T_odom_camera();
    for (const Vector3d& corner : pool.corners_odom()) {
      if (!pool.isSeen(corner)) continue;
      const Vector3d point = T_odom_camera.inverse() * corner;
      const SightLine<double> line = projector.lineOfSight(projector.project(point));
      EXPECT_LT(line.direction.cross(point - line.origin).norm(), 1e-9);
      EXPECT_NEAR(pool.heightOver(T_odom_camera * line.origin), 0, 1e-9);  // from the surface on
      EXPECT_GT(line.direction.dot(point - line.origin), 0);
      ++seen;
    }
  }
  EXPECT_GT(seen, 200);
}

/// A flat port in air before the camera, as a fit may try: the light that it lets through crosses the surface
/// where it would, had the camera looked that way.
TEST(WaterSurface, LineOfSightGoesThroughPortAndSurface) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    const Pool pool(random);
    CameraProjector<double> projector = pool.projector();
    projector.port = {true, 0.0, 0.0, 0.02, -0.01, 0.1};
    const Vector2d pixel(random.uniform(0, 639), random.uniform(0, 479));
    const SightLine<double> behind_port =
        lightBehind(projector.port, Vector3d(projector.lensModel(pool.camera).idealAt(pixel).homogeneous()));
    CameraProjector<double> without = projector;
    without.port = {};
    const Vector2d there = without.lensModel(pool.camera).project<double>(behind_port.direction);
    if (!(behind_port.direction.dot(projector.surface.down_camera) > 0.05)) continue;
    const SightLine<double> expected = without.lineOfSight(there), line = projector.lineOfSight(pixel);
    EXPECT_LT((line.origin - expected.origin).norm(), 1e-8);
    EXPECT_LT((line.direction - expected.direction).norm(), 1e-9);
  }
}

/// Straight down nothing bends, and beside that water is as thick as depth over index (Gauss).
TEST(WaterSurface, StraightDownItIsAsDeepAsItsDepthOverItsIndex) {
  const double air_m = 0.8, water_m = 0.6, x_m = 1e-4;
  const WaterSurface<double> water{true, water_m};
  const SurfaceBelow<double> below =
      seenFrom<double>(water, Matrix3d(Vector3d(1, -1, -1).asDiagonal()), {0, 0, air_m + water_m});
  const Vector3d nadir = apparentPoint(below, Vector3d(0, 0, air_m + water_m));
  EXPECT_LT(nadir.head<2>().norm(), 1e-15);
  const Vector3d aside = apparentPoint(below, Vector3d(x_m, 0, air_m + water_m));
  EXPECT_NEAR(aside.x() / aside.z(), x_m / (air_m + water_m / kWaterIndex), 1e-9 * x_m);
  // The same slope by a Jet, on the normal itself.
  using Jet = ceres::Jet<double, 2>;
  const Vector3<Jet> jet =
      apparentPoint(below.cast<Jet>(), Vector3<Jet>(Jet(0, 0), Jet(0, 1), Jet(air_m + water_m)));
  EXPECT_NEAR((jet.x() / jet.z()).v[0], 1 / (air_m + water_m / kWaterIndex), 1e-12);
  EXPECT_NEAR((jet.y() / jet.z()).v[1], 1 / (air_m + water_m / kWaterIndex), 1e-12);
}

/// All that a fit differentiates by, at once: robot's pose, panel's pose, and the effect's own four.
using FitJet = ceres::Jet<double, 16>;
constexpr int kOwn = 12;

template <class T>
std::array<Vector2<T>, 4> pixelsAt(const Pool& pool, const std::array<T, 16>& by) {
  const auto moved = [&](std::size_t first) { return Vector3<T>(by[first], by[first + 1], by[first + 2]); };
  KinematicState<T> robot;
  robot.position_odom = pool.robot.position_odom.cast<T>() + moved(0);
  robot.R_odom_robot = pool.robot.R_odom_robot.cast<T>() * expSO3<T>(moved(3));
  robot.velocity_robot = Vector3d(0.3, -0.2, 0.1).cast<T>();
  robot.angular_velocity_robot = Vector3d(0.1, 0.2, -0.3).cast<T>();
  auto panel = nominalPlacement<T>(pool.T_odom_panel, 0);
  panel.position_odom += moved(6);
  panel.R_odom_panel = panel.R_odom_panel * expSO3<T>(moved(9));
  auto effects = pool.effects().at<T>(0);
  for (std::size_t i = 0; i < 4; ++i) effects.template of<FlatWaterSurface>()[i] += by[kOwn + i];
  effects.template add<RollingShutter>({T(0.03)});
  return predictCorners<T>(robot, panel, pool.marker, pool.camera, pool.T_robot_camera, effects, 0);
}

/// Central differences over 1e-5 of metres and radians are off by its square times a third derivative of some
/// 1e4 px, and by rounding of 1e-11 px over 1e-5.
TEST(WaterSurface, DerivativesAreThoseOfDifferences) {
  Random random(8);
  int seen = 0;
  for (int i = 0; i < 40; ++i) {
    const Pool pool(random);
    std::array<FitJet, 16> jets;
    for (int j = 0; j < 16; ++j) jets[static_cast<std::size_t>(j)] = FitJet(0, j);
    const auto pixels = pixelsAt<FitJet>(pool, jets);
    for (int j = 0; j < 16; ++j) {
      constexpr double kStep = 1e-5;
      std::array<double, 16> ahead{}, behind{};
      ahead[static_cast<std::size_t>(j)] = kStep;
      behind[static_cast<std::size_t>(j)] = -kStep;
      const auto a = pixelsAt<double>(pool, ahead), b = pixelsAt<double>(pool, behind);
      for (std::size_t k = 0; k < 4; ++k) {
        if (!pool.isSeen(pool.corners_odom()[k])) continue;
        for (Eigen::Index axis = 0; axis < 2; ++axis)
          EXPECT_NEAR(pixels[k][axis].v[j], (a[k][axis] - b[k][axis]) / (2 * kStep), 2e-5) << j;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 1000);
}

/// At neutral, from where fits begin, by a difference to one side (less than no water there is not).
TEST(WaterSurface, ItsDerivativeIsThereBeforeItIs) {
  Random random(9);
  for (int i = 0; i < 40; ++i) {
    Pool pool(random);
    pool.water_m = 0;
    std::array<FitJet, 16> jets;
    jets[kOwn] = FitJet(0, kOwn);
    const auto pixels = pixelsAt<FitJet>(pool, jets);
    constexpr double kStep = 1e-6;  // second derivatives of some 1e5 px: what comes at 0.05 m begins here
    std::array<double, 16> ahead{};
    ahead[kOwn] = kStep;
    const auto a = pixelsAt<double>(pool, ahead), b = pixelsAt<double>(pool, {});
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3d point_camera = pool.T_odom_camera().inverse() * pool.corners_odom()[k];
      if (!(point_camera.z() > 0.1 && point_camera.head<2>().norm() < point_camera.z())) continue;
      for (Eigen::Index axis = 0; axis < 2; ++axis)
        EXPECT_NEAR(pixels[k][axis].v[kOwn], (a[k][axis] - b[k][axis]) / kStep,
                    0.01 * std::abs(pixels[k][axis].v[kOwn]) + 1)
            << i;
    }
  }
}

/// Row by row, by bisection on the row over the exact motion of robot and water.
TEST(WaterSurface, EachCornerIsSeenWhenItsRowIsRead) {
  Random random(10);
  int seen = 0;
  for (int i = 0; i < 50; ++i) {
    Pool pool(random);
    pool.robot.velocity_robot = 0.5 * random.normal3();
    pool.robot.angular_velocity_robot = 0.3 * random.normal3();
    const double readout_s = random.uniform(-0.05, 0.05);
    EffectParameters<double> rolling = pool.effects();
    rolling.add<RollingShutter>({readout_s});
    const auto pixels = pool.predicted(rolling);
    for (std::size_t k = 0; k < 4; ++k) {
      if (!pool.isSeen(pool.corners_odom()[k]) || !pool.camera.contains(pixels[k])) continue;
      const auto pixelAfter = [&](double seconds) {
        // As a camera moves in its own frame, at constant velocity and rate of turn.
        const auto mount = cameraMounting<double>(pool.T_robot_camera, {}, 0);
        const auto moving = movingWith(pool.robot, mount, CameraProjector<double>{});
        Pool later = pool;
        const Pose T_camera_later{expSO3<double>(moving.angular_velocity_camera * seconds),
                                  moving.velocity_camera * seconds};
        const Pose T_odom_robot = pool.T_odom_camera() * T_camera_later * pool.T_robot_camera.inverse();
        later.robot = {};
        later.robot.position_odom = T_odom_robot.position;
        later.robot.R_odom_robot = T_odom_robot.rotation;
        return later.predicted(pool.effects())[k];
      };
      double low = -500, high = 1000;  // rows
      for (int halving = 0; halving < 60; ++halving) {
        const double row = (low + high) / 2;
        (pixelAfter(readout_s * row / pool.camera.height_px).y() > row ? low : high) = row;
      }
      EXPECT_LT((pixels[k] - pixelAfter(readout_s * low / pool.camera.height_px)).norm(), 1e-7);
      ++seen;
    }
  }
  EXPECT_GT(seen, 50);
}

/// What is rendered is bent alike: small triangles' corners are put where the projector sees them.
TEST(WaterSurface, RenderedScenesAreBentAlike) {
  Random random(11);
  int bent = 0;
  for (int i = 0; i < 20; ++i) {
    const Pool pool(random);
    const auto corners = pool.corners_odom();
    Surface scene;
    for (const Vector3d& corner : corners)
      scene.vertices.push_back({Vector3d(corners[0] + 0.05 * (corner - corners[0])).cast<float>(),
                                Eigen::Vector3f::UnitZ(), Eigen::Vector3f::Ones()});
    scene.triangles = {{0, 1, 2}};
    const Pose T_odom_camera = pool.T_odom_camera();
    const CameraProjector<double> projector = pool.projector();
    const Surface apparent = apparentScene(scene, T_odom_camera, projector);
    if (apparent.triangles.size() != 1) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d there = scene.vertices[k].position.cast<double>();
      if (!pool.isSeen(there)) continue;
      const Vector3d seen = T_odom_camera.inverse() * apparent.vertices[k].position.cast<double>();
      const Vector2d expected = projector.ideal(Vector3d(T_odom_camera.inverse() * there));
      EXPECT_LT((seen.head<2>() / seen.z() - expected).norm(), 1e-5);  // vertices are of single precision
      ++bent;
    }
  }
  EXPECT_GT(bent, 20);
}

TEST(WaterSurface, ACameraWithoutAPanelSeesNone) {
  Random random(12);
  const Pool pool(random);
  EXPECT_TRUE(trueCamera(pool.camera, pool.T_robot_camera, pool.robot, pool.effects(), 0, {},
                         pool.T_odom_panel.position)
                  .bends());
  EXPECT_FALSE(trueCamera(pool.camera, pool.T_robot_camera, pool.robot, pool.effects(), 0).bends());
}

}  // namespace
}  // namespace fathom
