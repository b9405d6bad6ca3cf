// The camera's forward model against independent traces of the light.
#include "imaging/camera_geometry.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "imaging/two_views.h"
#include "support/traced_light.h"

namespace fathom {
namespace {

using test::LightRay;
using test::refracted;
using test::traced;

constexpr double kPortDirection = 1e-11;  // of unit vectors: what rounding leaves

FlatPort<double> randomPort(Random& random) {
  return {true,
          random.uniform(0.0, 0.1),
          random.uniform(0.0, 0.02),
          radians(random.uniform(-5, 5)),
          radians(random.uniform(-5, 5)),
          random.uniform() < 0.5 ? random.uniform(-0.02, 0.02) : 0.34,
          0};
}

/// 1000 ports, as `make` draws them, each looked through along a line of sight that is traced.
template <class MakePort, class Check>
void forTracedSights(std::uint64_t seed, const MakePort& make, const Check& check) {
  Random random(seed);
  for (int i = 0; i < 1000; ++i) {
    const auto port = make(random);
    const Vector3d sight = Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5), 1).normalized();
    check(port, sight, traced(port, sight), random);
  }
}

template <class MakePort>
void expectSeenWhereTracedLightGoes(std::uint64_t seed, const MakePort& make) {
  forTracedSights(seed, make,
                  [](const auto& port, const Vector3d& sight, const LightRay& ray, Random& random) {
                    const Vector3d point = ray.origin + random.uniform(0.05, 5.0) * ray.direction;
                    EXPECT_LT((apparentDirection(port, point).normalized() - sight).norm(), kPortDirection);
                  });
}

template <class MakePort>
void expectLightBehindIsTheTracedOne(std::uint64_t seed, const MakePort& make) {
  forTracedSights(seed, make, [](const auto& port, const Vector3d& sight, const LightRay& expected, Random&) {
    const SightLine<double> line = lightBehind(port, Vector3d(2 * sight));  // any length
    EXPECT_LT((line.origin - expected.origin).norm(), kPortDirection);
    EXPECT_LT((line.direction - expected.direction).norm(), kPortDirection);
  });
}

TEST(FlatPort, SeesWhereTheTracedLightGoes) { expectSeenWhereTracedLightGoes(1, randomPort); }

TEST(FlatPort, TheLightOfWhatIsSeenPassesThroughThePoint) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const FlatPort<double> port = randomPort(random);
    const double z = random.uniform(0.3, 5.0);
    const Vector3d point(z * random.uniform(-0.5, 0.5), z * random.uniform(-0.4, 0.4), z);
    const LightRay ray = traced(port, apparentDirection(port, point));
    EXPECT_LT(ray.direction.cross(point - ray.origin).norm(), 5 * kPortDirection);
  }
}

TEST(FlatPort, WithoutThicknessIsNoPort) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const FlatPort<double> port{true, 0, 0, radians(random.uniform(-5, 5)), radians(random.uniform(-5, 5)),
                                0,    0};
    const Vector3d point(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1);
    EXPECT_LT((apparentDirection(port, point).normalized() - point.normalized()).norm(), kPortDirection);
  }
}

TEST(FlatPort, LightBehindItIsTheTracedOne) { expectLightBehindIsTheTracedOne(6, randomPort); }

TEST(FlatPort, LightBehindItComesFromThePoint) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    FlatPort<double> port = randomPort(random);
    port.window_m = random.uniform(0.0, 0.3);
    port.slab_m = random.uniform() < 0.5 ? 0 : random.uniform(0.0, 0.1);
    const double z = random.uniform(0.6, 5.0);
    const Vector3d point(z * random.uniform(-0.4, 0.4), z * random.uniform(-0.4, 0.4), z);
    const SightLine<double> line = lightBehind(port, apparentDirection(port, point));
    EXPECT_LT(line.direction.cross(point - line.origin).norm(), 5 * kPortDirection);
    EXPECT_NEAR(line.direction.norm(), 1, 1e-12);
  }
}

/// Calibrated under water through the port, at a range: what is there is seen right ahead, and what is
/// elsewhere on the same traced light is seen there too.
TEST(FlatPort, CalibratedThroughItIsRightAtThatRange) {
  Random random(10);
  for (int i = 0; i < 1000; ++i) {
    FlatPort<double> port = randomPort(random);
    port.index_error = 0;
    const Vector3d in_lens(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1);
    const LightRay ray = traced(port, in_lens);
    const double range_m = random.uniform(0.7, 4.0);
    const Vector3d normal = expSO3<double>(Vector3d(port.tilt_x_rad, port.tilt_y_rad, 0)).col(2);
    const Vector3d calibrated =
        ray.origin + (range_m - ray.origin.dot(normal)) / ray.direction.dot(normal) * ray.direction;
    port.calibration_per_m = 1 / range_m;
    const Vector3d seen =
        apparentDirection(port, Vector3d(ray.origin + random.uniform(0.05, 5.0) * ray.direction))
            .normalized();
    EXPECT_LT((seen - calibrated.normalized()).norm(), kPortDirection);
    const SightLine<double> line = lightBehind(port, calibrated);
    EXPECT_LT((line.origin - ray.origin).norm(), kPortDirection);
    EXPECT_LT((line.direction - ray.direction).norm(), kPortDirection);
  }
}

/// An aquarium's window some way off bends nothing as long as there is air behind it.
TEST(FlatPort, AWindowByItselfIsNoPort) {
  FlatPort<double> port{true, 0, 0, radians(4), radians(-7), 0, 0};
  port.window_m = 0.2;
  const Vector3d point(0.2, -0.1, 0.7);
  EXPECT_LT((apparentDirection(port, point).normalized() - point.normalized()).norm(), kPortDirection);
}

/// Air, then water behind a window 0.2 m off: traced.
TEST(FlatPort, AWindowBeforeWaterIsReachedThroughAir) {
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    FlatPort<double> port{true, 0, 0, radians(random.uniform(-9, 9)), radians(random.uniform(-9, 9)),
                          0.34, 0};
    port.window_m = 0.2;
    const Vector3d normal = expSO3<double>(Vector3d(port.tilt_x_rad, port.tilt_y_rad, 0)) * Vector3d::UnitZ();
    const Vector3d sight = Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1).normalized();
    const Vector3d point =
        0.2 / sight.dot(normal) * sight + random.uniform(0.05, 1.0) * refracted(sight, normal, 1.0, 1.34);
    EXPECT_LT((apparentDirection(port, point).normalized() - sight).norm(), kPortDirection);
  }
}

TEST(CameraGeometry, LineOfSightLeadsToWhatIsSeen) {
  Random random(9);
  CameraModel camera{1440, 1080, 900, 905, 719.5, 539.5, -0.1, 0.03, 0.001, -0.001, 0};
  camera.window = {0.1, radians(3), radians(-2)};
  EffectParameters<double> effects;
  for (const bool bent : {false, true}) {
    if (bent) {
      effects.on.set(kEffectIndex<FlatPortRefraction>);
      effects.of<FlatPortRefraction>()[1] = 0.01;
      effects.of<FlatPortRefraction>()[4] = 0.34;
    }
    for (int i = 0; i < 100; ++i) {
      const double z = random.uniform(0.4, 3.0);
      const Vector3d point(z * random.uniform(-0.4, 0.4), z * random.uniform(-0.3, 0.3), z);
      const auto projector = cameraProjector(camera, effects, 0);
      const SightLine<double> line = projector.lineOfSight(projector.project(point));
      EXPECT_LT(line.direction.cross(point - line.origin).norm(), 1e-9) << bent;
    }
  }
}

/// Two cameras at right angles, and what they see of a point, off by some pixels.
struct Crossing {
  SeenByBoth seen;
  Pose T_left_right{rotationFromYawPitchRoll(radians(5), radians(-80), radians(3)), {0.5, 0.02, 0.4}};
  Vector3d point;

  explicit Crossing(Random& random) {
    const CameraModel camera{1440, 1080, 900, 905, 719.5, 539.5, 0, 0, 0, 0, 0};
    seen.cameras = {camera, camera};
    seen.sigma_px = {0.7, 1.6};
    point = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.3, 0.6)};
    seen.pixels = {camera.project<double>(point), camera.project<double>(T_left_right.inverse() * point)};
  }
  double contradiction() const {
    return fathom::contradiction<double>(seen, T_left_right.rotation, T_left_right.position, {}, 0,
                                         contradictionSense(seen, T_left_right));
  }
  /// Sum of squares in units of sigma, of the point moved.
  double cost(const Vector3d& moved) const {
    const Vector2d left = seen.cameras[0].project<double>(moved) - seen.pixels[0],
                   right = seen.cameras[1].project<double>(T_left_right.inverse() * moved) - seen.pixels[1];
    return left.squaredNorm() / std::pow(seen.sigma_px[0], 2) +
           right.squaredNorm() / std::pow(seen.sigma_px[1], 2);
  }
};

TEST(Contradiction, IsNoneWhereBothSeeOnePoint) {
  Random random(10);
  for (int i = 0; i < 50; ++i) EXPECT_NEAR(Crossing(random).contradiction(), 0, 1e-8);
}

/// Its square is what no point makes smaller: found again by a search that knows no derivatives.
TEST(Contradiction, IsWhatNoPointExplains) {
  Random random(11);
  for (int i = 0; i < 20; ++i) {
    Crossing crossing(random);
    for (Vector2d& pixel : crossing.seen.pixels) pixel += 2.0 * Vector2d(random.normal(), random.normal());
    Vector3d best = crossing.point;
    for (double step = 0.01; step > 1e-9;) {
      const Vector3d before = best;
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
          const Vector3d moved = best + sign * step * Vector3d::Unit(axis);
          if (crossing.cost(moved) < crossing.cost(best)) best = moved;
        }
      if (before == best) step /= 2;
    }
    // Four pixels at a point a third of a metre away: curved by 1e-2 of them.
    const double square = std::pow(crossing.contradiction(), 2);
    EXPECT_NEAR(square, crossing.cost(best), 1e-3 + 1e-2 * square);
  }
}

/// A camera in air that looks through a tank: traced through air, water and air again.
TEST(FlatPort, ThroughASlabOfWaterBetweenAir) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const double slab_m = random.uniform(0.0, 0.4), before_m = random.uniform(0.1, 0.5);
    const FlatPort<double> port{
        true, 0, 0, radians(random.uniform(-15, 15)), radians(random.uniform(-15, 15)), 0, slab_m};
    const Vector3d normal = expSO3<double>(Vector3d(port.tilt_x_rad, port.tilt_y_rad, 0)) * Vector3d::UnitZ();
    const Vector3d sight = Vector3d(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 1).normalized();
    const Vector3d water = refracted(sight, normal, 1.0, 1.34);
    const Vector3d point = before_m / sight.dot(normal) * sight + slab_m / water.dot(normal) * water +
                           random.uniform(0.1, 1.0) * sight;
    EXPECT_LT((apparentDirection(port, point).normalized() - sight).norm(), kPortDirection);
  }
}

/// On the normal itself and beyond the critical angle nothing may break.
TEST(FlatPort, HoldsOnItsNormalAndBeyondWhatCanBeSeen) {
  const FlatPort<double> port{true, 0.05, 0.01, 0, 0, 0.34, 0};
  EXPECT_LT((apparentDirection(port, Vector3d(0, 0, 2)).normalized() - Vector3d::UnitZ()).norm(), 1e-15);
  const Vector3d beyond = apparentDirection(port, Vector3d(9, 0, 1)).normalized();
  EXPECT_TRUE(beyond.allFinite());
  EXPECT_GT(beyond.z(), 0);
  EXPECT_GT(beyond.x(), 0.99);
  const FlatPort<double> calibrated_in_water{true, 0, 0, 0, 0, 0, 0};
  for (const double tangent : {1.1, 1.2, 3.0}) {
    const SightLine<double> line = lightBehind(calibrated_in_water, Vector3d(tangent, 0, 1));
    EXPECT_TRUE(line.origin.allFinite() && line.direction.allFinite()) << tangent;
  }
}

/// The figure of the literature: a port 20 mm before a camera calibrated under water acts like the camera
/// moved back by (n - 1) d near the axis, 6.8 mm.
TEST(FlatPort, NearTheAxisIsACameraFartherBack) {
  const FlatPort<double> port{true, 0.02, 0, 0, 0, 0, 0};
  const double z = 1.0, x = 1e-3;
  const Vector3d seen = apparentDirection(port, Vector3d(x, 0, z));
  // Seen from (0, 0, -shift): x / (z + shift).
  EXPECT_NEAR(x / (seen.x() / seen.z()) - z, 0.34 * 0.02, 1e-6);
}

DomePort<double> randomDome(Random& random) {
  return {true, 0.01 * random.normal3(), random.uniform(-0.5, 0.5), random.uniform(0.002, 0.01)};
}

TEST(DomePort, LightBehindItIsTheTracedOne) { expectLightBehindIsTheTracedOne(11, randomDome); }

TEST(DomePort, SeesWhereTheTracedLightGoes) { expectSeenWhereTracedLightGoes(12, randomDome); }

TEST(DomePort, AboutTheCameraItIsNone) {
  const DomePort<double> dome{true, Vector3d::Zero(), 0.2, 0.005};
  const Vector3d point(0.3, -0.4, 1.2);
  EXPECT_LT((apparentDirection(dome, point).normalized() - point.normalized()).norm(), kPortDirection);
}

/// Near the axis, a dome without thickness is one spherical surface: light that meets it in air at a height y
/// and an angle u goes on in water at (u + 0.34 y / R) / 1.34 (Gauss).
TEST(DomePort, NearTheAxisIsASphericalSurface) {
  const double radius_m = 0.075, behind_m = 0.01, z_m = 1.5, x_m = 1e-3;
  const DomePort<double> dome{true, Vector3d(0, 0, -behind_m), 0, 0};
  const double camera_to_surface_m = radius_m - behind_m, water_m = z_m - camera_to_surface_m;
  const double x_by_angle =
      camera_to_surface_m + water_m * (1 + 0.34 * camera_to_surface_m / radius_m) / 1.34;
  const Vector3d seen = apparentDirection(dome, Vector3d(x_m, 0, z_m));
  EXPECT_NEAR(seen.x() / seen.z(), x_m / x_by_angle, 1e-8);
}

/// A fit may ask for what no camera fits into, or for a ball of glass.
TEST(DomePort, HoldsWhereThereIsNoRoomForTheCamera) {
  for (const DomePort<double>& dome : {DomePort<double>{true, Vector3d(0, 0, 0.5), 0, 0.01},
                                       DomePort<double>{true, Vector3d(0, 0, 0.001), 0, 1}}) {
    const Vector3d seen = apparentDirection(dome, Vector3d(0.3, 0.2, 1));
    EXPECT_TRUE(seen.allFinite());
    EXPECT_LT((seen - Vector3d(0.3, 0.2, 1)).norm(), 1);
  }
  // Far to the side, where light of no direction arrives from.
  const DomePort<double> back{true, {0.0015, 0.001, -0.033}, 0, 0.3};
  for (const double x : {0.6, 0.9, 1.2, 5.0})
    for (const double z : {0.35, 0.5, 1.0})
      EXPECT_TRUE(apparentDirection(back, Vector3d(x, 0.05, z)).allFinite());
}

/// A camera whose rows are read one after the other, by bisection on the row over its exact motion.
TEST(RollingShutter, EachCornerIsSeenWhenItsRowIsRead) {
  Random random(4);
  const CameraModel camera{.k1 = -0.04};
  for (int i = 0; i < 200; ++i) {
    auto projector = CameraProjector<double>::nominal(camera);
    projector.shutter = {true, random.uniform(-0.05, 0.05)};
    projector.velocity_camera = 0.5 * random.normal3();
    projector.angular_velocity_camera = 0.3 * random.normal3();
    const Vector3d point(random.uniform(-0.4, 0.4), random.uniform(-0.3, 0.3), 1.0);
    const auto pixelAfter = [&](double seconds) {
      const Matrix3d turned = expSO3<double>(projector.angular_velocity_camera * seconds);
      const Vector3d there = turned.transpose() * (point - projector.velocity_camera * seconds);
      return camera.project(there);
    };
    double low = -2000, high = 2000;  // rows
    for (int k = 0; k < 100; ++k) {
      const double row = (low + high) / 2;
      (pixelAfter(projector.shutter.readout_s * row / 480).y() > row ? low : high) = row;
    }
    const Vector2d expected = pixelAfter(projector.shutter.readout_s * low / 480);
    EXPECT_LT((projector.project(point) - expected).norm(), 1e-9);
  }
}

TEST(CameraProjector, WithoutEffectsIsTheCameraModel) {
  Random random(5);
  const CameraModel camera{.k1 = -0.04, .k2 = 0.01, .p1 = 1e-3, .p2 = -2e-3, .k3 = 3e-3};
  const auto projector = cameraProjector<double>(camera, {}, 0);
  for (int i = 0; i < 100; ++i) {
    const Vector3d point(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.5, 2));
    EXPECT_LT((projector.project(point) - camera.project(point)).norm(), 1e-11);
  }
}

/// d pixel / d point by a Jet of the point alone, parameters being plain numbers: what a pose solver needs.
TEST(CameraProjector, PassesJetsOfThePointThroughPortAndRows) {
  using Jet = ceres::Jet<double, 3>;
  Random random(6);
  auto projector = CameraProjector<double>::nominal({.k1 = -0.04});
  projector.port = {true, 0.05, 0.01, 0.02, -0.01, 0.1};
  projector.dome = {true, {0.01, -0.005, 0.02}, 0.1, 0.005};
  projector.shutter = {true, 0.03};
  projector.velocity_camera = {0.5, -0.4, 0.3};
  projector.angular_velocity_camera = {0.2, 0.3, -0.5};
  for (int i = 0; i < 50; ++i) {
    const Vector3d point(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(0.5, 2));
    const auto pixel =
        projector.project(Vector3<Jet>(Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2)));
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = 1e-5 * Vector3d::Unit(k);
      const Vector3d ahead = point + step, behind = point - step;
      const Vector2d slope = (projector.project(ahead) - projector.project(behind)) / 2e-5;
      // Central differences: h² f'''/6, slopes being 500 px/m at 1 m, and rounding of 1e-12 px over h.
      EXPECT_NEAR(pixel.x().v[k], slope.x(), 1e-5);
      EXPECT_NEAR(pixel.y().v[k], slope.y(), 1e-5);
    }
  }
}

TEST(KinematicState, ExtrapolatedMovesAtConstantAcceleration) {
  KinematicState<double> state;
  state.R_odom_robot = expSO3<double>(Vector3d(0.3, -0.2, 1.0));
  state.position_odom = {1, 2, 3};
  state.velocity_robot = {0.5, 0.1, -0.2};
  state.acceleration_robot = {0.1, -0.3, 0.2};
  state.angular_velocity_robot = {0, 0, 0.4};
  state.angular_acceleration_robot = {0, 0, 0.1};
  const auto later = extrapolated(state, 2.0);
  EXPECT_LT((later.position_odom -
             (state.position_odom + state.R_odom_robot * Vector3d(1.0 + 0.2, 0.2 - 0.6, -0.4 + 0.4)))
                .norm(),
            1e-14);
  EXPECT_LT((state.R_odom_robot.transpose() * later.R_odom_robot - expSO3<double>(Vector3d(0, 0, 0.8 + 0.2)))
                .norm(),
            1e-14);
  // The same velocity in odom's axes, a second way.
  EXPECT_LT(
      (later.R_odom_robot * later.velocity_robot - state.R_odom_robot * Vector3d(0.7, -0.5, 0.2)).norm(),
      1e-14);
}

}  // namespace
}  // namespace fathom
