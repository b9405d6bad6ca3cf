#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "imaging/detected_corners.h"
#include "imaging/image_patch.h"
#include "imaging/image_texture.h"
#include "imaging/marine_snow.h"
#include "imaging/marker_blur.h"
#include "sensors/channel_model.h"
#include "support/motions.h"
#include "support/random_effects.h"
#include "support/shared_data.h"
#include "support/simulated.h"

// Properties that every registered effect must have, whichever effects there are.
namespace fathom {
namespace {

constexpr std::size_t kScalars = kEffectOffsets[kEffectCount];
using EffectJet = ceres::Jet<double, static_cast<int>(kScalars)>;
using test::kMarkersThere;
using test::kNow_s;
using test::randomEffects;
using test::switchOn;

/// Two markers, one of them in a corner of the image, of a panel aslant before the camera.
template <class T, class Add>
void addPixels(const KinematicState<double>& where, const KinematicState<T>& state,
               const EffectParameters<T>& effects, double t_s, const Add& add) {
  const Pose T_robot_camera{rotationFromYawPitchRoll(radians(-80), radians(4), radians(-95)), {0.3, 0.1, 0}};
  const Pose T_left_right{expSO3<double>(Vector3d(0.01, 0.02, -0.01)), {0.1, 0.01, 0}};
  const Pose T_camera_panel{rotationFromYawPitchRoll(0.1, 0.2, radians(170)), {0.1, -0.2, 1.3}};
  const CameraModel camera{.k1 = -0.04, .k2 = -0.02, .p1 = 1e-3, .p2 = -1e-3, .k3 = 1e-3};
  const Pose T_odom_panel = Pose{where.R_odom_robot, where.position_odom} * T_robot_camera * T_camera_panel;
  const auto panel = nominalPlacement<T>(T_odom_panel, t_s);
  for (const int id : kMarkersThere) {
    Marker marker{"tag36h11", id, 0.1, {}};
    marker.T_panel_marker = {rotationFromYawPitchRoll(0.03 * id, 0, 0), {0.05 * id - 0.2, 0.2, 0.01}};
    marker.panel_half_m = {0.7, 0.4};
    for (const Pose& eye : {Pose{}, T_left_right})
      for (const Vector2<T>& pixel :
           predictDetectedCorners(state, panel, marker, camera, T_robot_camera, {}, effects, t_s, eye))
        add(pixel);
  }
}

/// The same two of a panel that lies in water, aslant below a camera in air.
template <class T, class Add>
void addPixelsBelowWater(const KinematicState<double>& where, const KinematicState<T>& state,
                         const EffectParameters<T>& effects, double t_s, const Add& add) {
  const Pose T_odom_robot{where.R_odom_robot, where.position_odom};
  const Pose T_odom_camera{rotationFromYawPitchRoll(0.5, 0.1, radians(160)), where.position_odom};
  const Pose T_odom_panel{rotationFromYawPitchRoll(0.2, 0.05, 0.03),
                          where.position_odom + Vector3d(1, -0.6, -6)};  // deeper than the water may be
  CameraModel camera{.k1 = -0.04, .k2 = -0.02, .p1 = 1e-3, .p2 = -1e-3, .k3 = 1e-3};
  camera.above_water = true;
  for (const int id : kMarkersThere) {
    Marker marker{"tag36h11", id, 0.1, {}};
    // Below the surface, however little water there is.
    marker.T_panel_marker = {rotationFromYawPitchRoll(0.03 * id, 0, 0), {0.05 * id - 0.4, 0.1, -0.15}};
    marker.panel_half_m = {1.2, 0.8};
    for (const Vector2<T>& pixel :
         predictDetectedCorners(state, nominalPlacement<T>(T_odom_panel, t_s), marker, camera,
                                T_odom_robot.inverse() * T_odom_camera, {}, effects, t_s))
      add(pixel);
  }
}

/// Bright and dark on the panel before the camera, in the middle of the image and in a corner.
template <class T, class Add>
void addPatches(const KinematicState<double>& where, const KinematicState<T>& state,
                const EffectParameters<T>& effects, double t_s, const Add& add) {
  ImagePatch patch;
  patch.T_robot_camera = {rotationFromYawPitchRoll(radians(-80), radians(4), radians(-95)), {0.3, 0.1, 0}};
  const Pose T_camera_panel{rotationFromYawPitchRoll(0.1, 0.2, radians(170)), {0.1, -0.2, 1.3}};
  const Pose T_odom_panel =
      Pose{where.R_odom_robot, where.position_odom} * patch.T_robot_camera * T_camera_panel;
  patch.scene_odom = T_odom_panel.position;
  LampSheet lamp{.name = "port", .half_angle_rad = radians(40), .T_robot_lamp = patch.T_robot_camera};
  lamp.T_robot_lamp.rotation *= rotationFromYawPitchRoll(0, radians(-85), 0);  // its x along the camera's z
  lamp.T_robot_lamp.position += Vector3d(0, 0.3, 0.2);
  const std::vector<LampSheet> lamps{lamp, lamp};
  Vector9<T> water;
  water << T(0.4), T(0.2), T(0.1), T(0.05), T(0.15), T(0.2), T(0.6), T(0.7), T(0.65);
  for (const double albedo : {0.05, 0.8})
    for (const double radius : {0.1, 0.6}) {
      patch.albedo = Vector3d(albedo, 0.9 * albedo, 0.8 * albedo);
      patch.albedo_around << Vector3d(0.4, 0.3, 0.2), Vector3d(0.3, 0.3, 0.3), Vector3d(0.25, 0.3, 0.35);
      patch.image_radius = radius;
      patch.marker_id = kMarkersThere[0];
      patch.image_place = {0.5, 0.5};
      patch.image_mean = {0.2, 0.3, 0.25};
      patch.image_tangent = {0.6 * radius, -0.8 * radius};
      patch.point_panel = {radius, 0.2, 0.01};
      patch.at_panel_m = patch.point_panel.head<2>();
      patch.around_panel.fill(patch.point_panel + Vector3d(0.02, 0.01, 0));
      add(predictPatch(state, nominalPlacement<T>(T_odom_panel, t_s), patch, lamps, water, effects, t_s));
    }
}

/// How soft a marker on that panel is.
template <class T, class Add>
void addEdges(const KinematicState<double>& where, const KinematicState<T>& state,
              const EffectParameters<T>& effects, double t_s, const Add& add) {
  MarkerBlur marker;
  marker.T_robot_camera = {rotationFromYawPitchRoll(radians(-80), radians(4), radians(-95)), {0.3, 0.1, 0}};
  const Pose T_odom_panel = Pose{where.R_odom_robot, where.position_odom} * marker.T_robot_camera *
                            Pose{rotationFromYawPitchRoll(0.1, 0.2, radians(170)), {0.1, -0.2, 1.3}};
  marker.point_panel = {0.2, 0.1, 0};
  add(predictBlur(state, nominalPlacement<T>(T_odom_panel, t_s), marker, T(0.05), effects, t_s));
}

/// Specks before some square decimetres of that panel.
template <class T, class Add>
void addSpecks(const EffectParameters<T>& effects, double t_s, const Add& add) {
  SpeckVolumes volumes;
  volumes.visible_m3 = {0.005, 0.003, 0.0005};
  volumes.merging_m6 = {2e-6, 1e-6, 1e-7};
  volumes.merged_m6 = {0, 1e-6, 2e-7};
  add(predictSpecks(volumes, effects, t_s));
}

/// The noise of surfaces, dark and bright.
template <class T, class Add>
void addTexture(const EffectParameters<T>& effects, double t_s, const Add& add) {
  add(predictTexture({{0.4, 0.3, 0.15, 1e-4}, {0.6, 1.2, 0.5, 1e-3}}, effects, t_s));
}

/// Everything the forward model predicts of an entry stamped t_s, as one vector. The panel is before the
/// camera when the vehicle is at `where`.
template <class T>
std::vector<T> predictions(const KinematicState<double>& where, const KinematicState<T>& state,
                           const EffectParameters<T>& effects, double t_s = kNow_s) {
  const Vehicle vehicle = test::slantedVehicle();
  const World<T> world{vehicle.gravityOdom(), T(-9.0)};
  std::vector<T> all;
  const auto add = [&](const auto& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) all.push_back(m(i));
  };
  const auto validAt = [&](const T& offset_s) { return extrapolated(state, offset_s); };
  forEachInstrument([&]<class Instrument>() {
    [&]<class... Channels>(std::tuple<Channels...>*) {
      const auto addChannel = [&]<class C>() {
        Inputs<T> in{state, world, effects, t_s};
        in.state = validAt(in.template validityOffset<typename C::Instrument>());
        for (const Pose& mounting : Instrument::mountings(sheetOf<Instrument>(vehicle)))
          add(C::predict(in, sheetOf<C>(vehicle), Observation{{}, {}, mounting}));
      };
      (addChannel.template operator()<Channels>(), ...);
    }(static_cast<typename Instrument::Channels*>(nullptr));
  });
  const auto seen = validAt(validityOffset<Camera>(effects, t_s));
  addPixels(where, seen, effects, t_s, add);
  addPixelsBelowWater(where, seen, effects, t_s, add);
  addPatches(where, seen, effects, t_s, add);
  addEdges(where, seen, effects, t_s, add);
  addSpecks(effects, t_s, add);
  addTexture(effects, t_s, add);
  return all;
}
std::vector<double> predictions(const KinematicState<double>& state, const EffectParameters<double>& effects,
                                double t_s = kNow_s) {
  return predictions(state, state, effects, t_s);
}

/// Largest difference, relative where numbers are large.
double largestChange(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]) / (1 + std::abs(b[i])));
  return largest;
}
constexpr double kRounding = 1e-12;  // a pixel goes through some hundred operations
constexpr double kSeen = 1e-9;

template <class T>
KinematicState<T> cast(const KinematicState<double>& s) {
  return {s.position_odom.cast<T>(),      s.R_odom_robot.cast<T>(),
          s.velocity_robot.cast<T>(),     s.angular_velocity_robot.cast<T>(),
          s.acceleration_robot.cast<T>(), s.angular_acceleration_robot.cast<T>()};
}

TEST(EffectRegistry, NeutralParametersChangeNoPrediction) {
  Random random(1);
  for (int i = 0; i < 30; ++i) {
    const auto state = test::randomMotion(random);
    const auto nominal = predictions(state, {});
    for (const EffectInfo& effect : allEffects()) {
      EffectParameters<double> neutral;
      neutral.on.set(effect.index);
      EXPECT_LT(largestChange(predictions(state, neutral), nominal), kRounding) << effect.id;
    }
  }
}

TEST(EffectRegistry, NeutralParametersChangeNoSimulatedReading) {
  const Trajectory trajectory = test::sineTrajectory(10);
  SimulationOptions options;
  options.vehicle = test::slantedVehicle();
  options.sea_floor_z_m = -8;
  const auto nominal = test::simulated(options, trajectory);
  forEachEffect([&]<class Effect>() {
    options.effects = {};
    options.effects.on.set(kEffectIndex<Effect>);
    const auto neutral = test::simulated(options, trajectory);
    ASSERT_EQ(neutral.size(), nominal.size());
    for (const auto& [label, samples] : nominal)
      EXPECT_EQ(test::largestDifference(samples, neutral.at(label)), 0) << Effect::id << " " << label;
  });
}

TEST(EffectRegistry, EveryParameterChangesSomething) {
  Random random(2);
  const auto state = test::randomMotion(random);
  const auto nominal = predictions(state, {});
  for (const EffectInfo& effect : allEffects()) {
    EffectParameters<double> all;
    switchOn(effect, all);
    EXPECT_GT(largestChange(predictions(state, all), nominal), kSeen) << effect.id;
    std::size_t i = effect.first_scalar;
    for (const Parameter& p : effect.parameters)
      for (int k = 0; k < p.size; ++k, ++i) {
        auto without = all;
        without.values[i] = p.kind == ParameterKind::time ? kNow_s + 1 : 0;
        EXPECT_GT(largestChange(predictions(state, without), predictions(state, all)), kSeen)
            << effect.id << " " << p.name << " " << k;
      }
    all.on.reset();  // off: parameters do not matter
    EXPECT_EQ(predictions(state, all), nominal) << effect.id;
  }
}

TEST(EffectRegistry, AnIntervalsEffectActsWithinItOnly) {
  Random random(5);
  const auto state = test::randomMotion(random);
  const auto nominal = predictions(state, {});
  for (const EffectInfo& effect : allEffects()) {
    EffectParameters<double> parameters;
    switchOn(effect, parameters);
    parameters.active_s[effect.index] = {15, 25};
    for (const double t_s : {14.9, 25.1})
      EXPECT_EQ(predictions(state, parameters, t_s), predictions(state, {}, t_s)) << effect.id;
    EXPECT_GT(largestChange(predictions(state, parameters, 20), nominal), kSeen) << effect.id;
    EXPECT_TRUE(parameters.at<double>(14.9).on.none());
    EXPECT_EQ(predictions(state, parameters.at<double>(20)), predictions(state, parameters)) << effect.id;
  }
}

// Sixth-order differences with steps of h to 3 h prior sigmas: wrong by h^6/140 times the seventh derivative,
// 5e-18 of it; rounding of a reading over h adds 3e-14 of it, and of a softness, a square of hundreds of
// pixels a second, a thousand times that.
TEST(EffectRegistry, JetDerivativesEqualNumericOnes) {
  Random random(3);
  std::vector<double> sigma;
  for (const EffectInfo& effect : allEffects())
    for (const Parameter& p : effect.parameters)
      sigma.insert(sigma.end(), static_cast<std::size_t>(p.size),
                   p.kind == ParameterKind::peak_time ? 1.0 : p.prior_sigma);
  ASSERT_EQ(sigma.size(), kScalars);
  constexpr double h = 3e-3;
  for (int round = 0; round < 4; ++round) {
    const auto state = test::randomMotion(random);
    const auto parameters = randomEffects(random);
    auto jets = parameters.at<EffectJet>(kNow_s);
    for (std::size_t i = 0; i < kScalars; ++i)
      jets.values[i] = EffectJet(parameters.values[i], static_cast<int>(i));
    const auto with_jets = predictions(state, cast<EffectJet>(state), jets);
    const auto plain = predictions(state, parameters);
    ASSERT_EQ(with_jets.size(), plain.size());
    for (std::size_t k = 0; k < plain.size(); ++k)
      EXPECT_NEAR(with_jets[k].a, plain[k], kRounding * (1 + std::abs(plain[k])));
    for (std::size_t i = 0; i < kScalars; ++i) {
      const auto moved = [&](double steps) {
        auto there = parameters;
        there.values[i] += steps * h * sigma[i];
        return predictions(state, there);
      };
      const auto p3 = moved(3), p2 = moved(2), p1 = moved(1), m1 = moved(-1), m2 = moved(-2), m3 = moved(-3);
      for (std::size_t k = 0; k < plain.size(); ++k) {
        const double numeric =
            (45 * (p1[k] - m1[k]) - 9 * (p2[k] - m2[k]) + (p3[k] - m3[k])) / (60 * h);  // a prior sigma
        EXPECT_NEAR(with_jets[k].v[static_cast<Eigen::Index>(i)] * sigma[i], numeric,
                    1e-9 + 1e-12 * std::abs(plain[k]))
            << parameterOf(i).name << ", reading " << k;
      }
    }
  }
}

TEST(EffectRegistry, IdsAreUniqueAndEntriesWhole) {
  std::set<std::string_view> ids;
  for (const EffectInfo& effect : allEffects()) {
    EXPECT_TRUE(ids.insert(effect.id).second) << effect.id;
    EXPECT_FALSE(effect.text.title.empty() || effect.text.equation.empty() || effect.text.source.empty() ||
                 effect.text.told_apart.empty())
        << effect.id;
    EXPECT_FALSE(effect.confusedWith().empty()) << effect.id;
    for (const auto other : effect.confusedWith()) {
      EXPECT_NE(findEffect(other), nullptr) << effect.id << ": " << other;
      EXPECT_NE(other, effect.id);
    }
    std::set<std::string_view> names;
    for (const Parameter& p : effect.parameters) {
      EXPECT_TRUE(names.insert(p.name).second) << effect.id << " " << p.name;
      EXPECT_TRUE(p.size >= 1 && p.size <= 3) << p.name;
      EXPECT_EQ(p.prior_sigma > 0, isDifferentiated(p.kind)) << p.name;
      EXPECT_GT(p.limit, p.prior_sigma) << p.name;
      EXPECT_FALSE(p.unit.empty() || p.usual.empty()) << effect.id << " " << p.name;
    }
  }
  EXPECT_EQ(ids.size(), kEffectCount);
  EXPECT_EQ(findEffect("dvl-scales"), nullptr);
}

/// The words between backticks.
std::vector<std::string> ticked(const std::string& text) {
  std::vector<std::string> words;
  const std::regex tick("`([^`]+)`");
  for (std::sregex_iterator it(text.begin(), text.end(), tick), end; it != end; ++it)
    words.push_back((*it)[1]);
  return words;
}

TEST(EffectRegistry, IdsAndParametersAreTheCatalogues) {
  FATHOM_NEEDS_SHARED("diagnosis.md");
  std::istringstream catalogue(readTextFile(test::sharedData("diagnosis.md")));
  std::set<std::string_view> registered;
  for (const EffectInfo& effect : allEffects()) registered.insert(effect.id);
  std::set<std::string> listed;
  const std::regex row(R"(\| (.+) \| (.+) \|)");
  std::smatch match;
  for (std::string line; std::getline(catalogue, line);) {
    if (!std::regex_match(line, match, row)) continue;
    const std::string first = match[1], second = match[2];
    if (first == "navigation" || first == "marker geometry")
      for (const std::string& id : ticked(second)) listed.insert(id);
    std::set<std::string_view> known{"active_s"};  // of the row's effects
    for (const std::string& id : ticked(first))
      if (const EffectInfo* effect = findEffect(id)) {
        for (const Parameter& p : effect->parameters) known.insert(p.name);
        if (effect->derived != nullptr) known.insert(effect->derived->name);
      }
    if (known.size() == 1) continue;  // not a row of parameters, or of effects that are not there yet
    for (const std::string& name : ticked(second)) EXPECT_EQ(known.count(name), 1U) << first << " " << name;
  }
  EXPECT_FALSE(listed.empty());
  for (const std::string& id : listed) EXPECT_EQ(registered.count(id), 1U) << id;
}

}  // namespace
}  // namespace fathom
