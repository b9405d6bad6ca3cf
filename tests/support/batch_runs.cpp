#include "support/batch_runs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "effects/drawn.h"

namespace fathom::test {

Pose beforePanel(double t) {
  return {rotationFromYawPitchRoll(0.25 * std::sin(0.43 * t), 0.1 * std::sin(0.61 * t),
                                   0.12 * std::sin(0.83 * t + 0.4)),
          Vector3d(3.0 + 0.8 * std::sin(0.29 * t), 0.9 * std::sin(0.37 * t + 1.0),
                   -4.0 + 0.5 * std::sin(0.47 * t))};
}

Trajectory pathBeforePanel(double duration_s) {
  const auto times_s = timesBetween(0, duration_s, 0.1);
  std::vector<Pose> poses(times_s.size());
  std::transform(times_s.begin(), times_s.end(), poses.begin(), beforePanel);
  return {times_s, poses};
}

BatchRun::BatchRun(double seconds, Trajectory path) : duration_s(seconds), path_(std::move(path)) {
  vehicle = readVehicle(kRov);
  panel = gridPanel(4, 3);
  panel.name = "grid";
  panel.T_odom_panel = {rotationFromYawPitchRoll(radians(-90), 0, radians(90)), {6.0, 0.0, -4.0}};
}

SimulationOptions BatchRun::options() const {
  SimulationOptions simulation;
  simulation.vehicle = vehicle;
  simulation.effects = effects;
  simulation.sea_floor_z_m = -9.0;
  simulation.seed = seed;
  simulation.noise = noise;
  simulation.begin_s = kBegin_s;
  simulation.duration_s = duration_s;
  simulation.images = true;
  return simulation;
}

std::vector<Sample> BatchRun::samples() const {
  std::vector<Sample> samples;
  simulateNavigation(options(), path_, [&](const Sample& sample) { samples.push_back(sample); });
  return samples;
}

// Of sigma 1, not correlated. The tails are a corner's, not a coordinate's.
Vector8d BatchRun::cornerErrors(Random& random) const {
  Vector8d error;
  for (double& e : error) e = noise ? random.normal() : 0.0;
  if (corner_tail_dof <= 0) return error;
  for (Eigen::Index k = 0; k < 8; k += 2) {
    double chi_square = 0;
    for (int i = 0; i < static_cast<int>(corner_tail_dof); ++i) chi_square += std::pow(random.normal(), 2);
    error.segment<2>(k) *= std::sqrt((corner_tail_dof - 2.0) / chi_square);
  }
  return error;
}

Detections BatchRun::detections() const {
  Detections detections;
  if (!vehicle.camera) return detections;
  const SimulationOptions simulation = options();
  const CameraSheet& sheet = *vehicle.camera;
  Random random = Random::stream(seed, 77), shaking = Random::stream(seed, 78);
  const std::vector<Marker>& markers = true_panel ? true_panel->markers : panel.markers;
  const Matrix8d C = cornerCovariance(corner_sigma_px);
  const Matrix8d root = C.llt().matrixL();
  for (std::size_t image = 0;; ++image) {
    const double t_s = secondsBetween(simulation.start, imageTime(simulation, image));
    if (t_s > duration_s) return detections;
    const auto state = stateAtImage(t_s);
    auto& found = detections.by_file["/images/" + imageFiles(sheet, {}, image)[0]];
    Pose T_robot_camera = sheet.T_robot_camera;
    T_robot_camera.rotation *= expSO3<double>(camera_shake_rad * shaking.normal3());
    for (const Marker& marker : markers) {
      const Pose T_camera_panel =
          (Pose{state.R_odom_robot, state.position_odom} * T_robot_camera).inverse() * panel.T_odom_panel;
      const double z_m = (T_camera_panel * marker.T_panel_marker.position).z();
      const Environment water = pixels ? environmentOf(coastalWater()) : Environment{};
      const auto corners = predictDetectedCorners(
          state, nominalPlacement<double>(panel.T_odom_panel, t_s), marker, sheet.model, T_robot_camera,
          edgeLight(panel, water, z_m, sheet.response_gamma), effects, t_s);
      const Vector8d error = root * cornerErrors(random);
      const bool visible = std::all_of(corners.begin(), corners.end(),
                                       [&](const Vector2d& c) { return sheet.model.contains(c); });
      if (!visible) continue;
      Detection detection;
      detection.family = marker.family;
      detection.id = marker.id;
      detection.covariance_px2 = C;
      for (std::size_t k = 0; k < 4; ++k)
        detection.corners_px[k] = corners[k] + error.segment<2>(static_cast<Eigen::Index>(2 * k));
      found.push_back(detection);
    }
  }
}

Vector9d coastalWater() {
  Vector9d water;
  water << 0.38, 0.2, 0.18, 0.04, 0.19, 0.21, 0.79, 0.86, 0.84;
  return water;
}

namespace {

constexpr double kLightSigma = 0.0003;  // of 100 pixels

// Of an image that sees now more of the panel, now more of the water.
Vector3d meanOfImage(double t_s) {
  return (1 + 0.4 * std::sin(2 * std::numbers::pi * t_s / 10)) * Vector3d(0.1, 0.2, 0.25);
}

}  // namespace

std::vector<ImagePatch> BatchRun::patches() const {
  std::vector<ImagePatch> all = patchesOfMarkers();
  const std::vector<ImagePatch> water = patchesOfWater();
  all.insert(all.end(), water.begin(), water.end());
  return all;
}

std::vector<ImagePatch> BatchRun::emptyPatches() const {
  const SimulationOptions simulation = options();
  std::vector<ImagePatch> patches;
  for (std::size_t image = 0;; ++image) {
    ImagePatch patch;
    patch.t_s = secondsBetween(simulation.start, imageTime(simulation, image));
    if (patch.t_s > duration_s) return patches;
    patch.image = image;
    patch.image_mean = meanOfImage(patch.t_s);
    patch.T_robot_camera = vehicle.camera->T_robot_camera;
    patch.sigma.setConstant(kLightSigma);
    patches.push_back(patch);
  }
}

KinematicState<double> BatchRun::stateAtImage(double t_s) const {
  return path_.at(options().begin_s + t_s + validityOffset<Camera>(effects, t_s));
}

Vector3d BatchRun::readingOf(const ImagePatch& patch, Random& random) const {
  const Vector3d light =
      predictPatch(stateAtImage(patch.t_s), nominalPlacement<double>(panel.T_odom_panel, patch.t_s), patch,
                   vehicle.lamps, coastalWater(), drawnFor(effects, seed, patch.t_s), patch.t_s);
  return noise ? Vector3d(light + kLightSigma * random.normal3()) : light;
}

// Of the markers that are detected: two patches each.
std::vector<ImagePatch> BatchRun::patchesOfMarkers() const {
  const CameraSheet& sheet = *vehicle.camera;
  Random random = Random::stream(seed, 79);
  std::vector<ImagePatch> patches;
  for (ImagePatch patch : emptyPatches()) {
    const auto state = stateAtImage(patch.t_s);
    const Pose T_camera_panel =
        (Pose{state.R_odom_robot, state.position_odom} * sheet.T_robot_camera).inverse() * panel.T_odom_panel;
    for (const Marker& marker : panel.markers) {
      patch.point_panel = marker.T_panel_marker.position;
      patch.at_panel_m = patch.point_panel.head<2>();
      patch.around_panel.fill(patch.point_panel);
      const Vector3d point = T_camera_panel * patch.point_panel;
      if (point.z() < 0.1 || !sheet.model.contains(sheet.model.project<double>(point))) continue;
      patch.pixel = sheet.model.project<double>(point);
      patch.image_place = patch.pixel.array() / Vector2d(sheet.model.width_px, sheet.model.height_px).array();
      patch.image_tangent = point.head<2>() / point.z();
      patch.marker_id = marker.id;
      patch.image_radius = patch.image_tangent.norm();
      for (const bool white : {false, true}) {
        patch.surface = white ? ImagePatch::Surface::white : ImagePatch::Surface::black;
        patch.place = 2 * marker.id + (white ? 1 : 0);
        patch.albedo.setConstant(white ? panel.white_albedo : panel.black_albedo);
        // Nearer ones are larger, so that less comes from beside them.
        const double share = 0.1 * point.z(), other = white ? panel.black_albedo : panel.white_albedo;
        const auto mixed = [&](double so_much) {
          return Vector3d((1 - so_much) * patch.albedo + Vector3d::Constant(so_much * other));
        };
        patch.albedo_around << mixed(share), mixed(1.5 * share), mixed(2 * share);
        patch.radiance = readingOf(patch, random);
        patches.push_back(patch);
      }
    }
  }
  return patches;
}

// Two patches above the panel, in all images.
std::vector<ImagePatch> BatchRun::patchesOfWater() const {
  const CameraSheet& sheet = *vehicle.camera;
  Random random = Random::stream(seed, 82);
  std::vector<ImagePatch> patches;
  for (ImagePatch patch : emptyPatches()) {
    patch.surface = ImagePatch::Surface::water;
    const auto state = stateAtImage(patch.t_s);
    const Pose T_panel_camera =
        panel.T_odom_panel.inverse() * Pose{state.R_odom_robot, state.position_odom} * sheet.T_robot_camera;
    for (const double share : {0.25, 0.75}) {
      patch.place = share < 0.5 ? -2 : -1;
      patch.image_place = {share, 0.1};
      patch.pixel = {share * sheet.model.width_px, 0.1 * sheet.model.height_px};
      const Vector2d direction = sheet.model.idealAt(patch.pixel);
      patch.image_tangent = direction;
      patch.image_radius = direction.norm();
      patch.point_panel = T_panel_camera * Vector3d(kOpenWater_m * direction.homogeneous());
      patch.around_panel.fill(patch.point_panel);
      patch.radiance = readingOf(patch, random);
      patches.push_back(patch);
    }
  }
  return patches;
}

// Of the same markers.
std::vector<MarkerBlur> BatchRun::blurs() const {
  constexpr double kSigma_px2 = 0.15, kLens_px2 = 0.06;
  Random random = Random::stream(seed, 80);
  std::vector<MarkerBlur> blurs;
  for (const ImagePatch& patch : patchesOfMarkers()) {
    if (patch.place % 2 != 0) continue;
    MarkerBlur blur;
    blur.t_s = patch.t_s;
    blur.image = patch.image;
    blur.place = patch.place / 2;
    blur.point_panel = patch.point_panel;
    blur.pixel = patch.pixel;
    blur.camera = vehicle.camera->model;
    blur.T_robot_camera = patch.T_robot_camera;
    blur.covariance_px4 = kSigma_px2 * kSigma_px2 * Matrix3d::Identity();
    const auto state = stateAtImage(patch.t_s);
    blur.variance_px2 = predictBlur(state, nominalPlacement<double>(panel.T_odom_panel, patch.t_s), blur,
                                    kLens_px2, effects, patch.t_s);
    if (noise) blur.variance_px2 += kSigma_px2 * random.normal3();
    blurs.push_back(blur);
  }
  return blurs;
}

// In each of the images that show markers, before some square decimetres of panel.
std::vector<ImageSpecks> BatchRun::specks() const {
  Random random = Random::stream(seed, 81);
  std::vector<ImageSpecks> specks;
  for (const ImagePatch& patch : patchesOfMarkers()) {
    if (!specks.empty() && specks.back().image == patch.image) continue;
    ImageSpecks seen{.t_s = patch.t_s, .image = patch.image};
    seen.volumes.visible_m3 = {0.03, 0.02, 0.002};
    const BySpeckClass expected = predictSpecks(seen.volumes, effects, patch.t_s);
    seen.sigma = (1 + expected).sqrt();
    const Vector3d error = noise ? random.normal3() : Vector3d(Vector3d::Zero());
    seen.counted = expected + seen.sigma * error.array();
    specks.push_back(seen);
  }
  return specks;
}

// Of some ten thousand pixels of them, dark and bright.
std::vector<ImageTexture> BatchRun::textures() const {
  Random random = Random::stream(seed, 82);
  std::vector<ImageTexture> textures;
  for (const ImagePatch& patch : patchesOfMarkers()) {
    if (!textures.empty() && textures.back().image == patch.image) continue;
    ImageTexture seen{.t_s = patch.t_s, .image = patch.image};
    seen.sigma = {0.015, 0.03};
    seen.noise = {{0.4, 0.25, 0.11, 1e-4}, {0.6, 0.7, 0.3, 1e-3}};
    const Vector3d error = noise ? random.normal3() : Vector3d(Vector3d::Zero());
    seen.log_ratio =
        predictTexture(seen.noise, effects, patch.t_s) + seen.sigma.cwiseProduct(error.head<2>());
    textures.push_back(seen);
  }
  return textures;
}

BatchInput BatchRun::input(const std::vector<Sample>& all,
                           const EffectParameters<double>& calibration) const {
  BatchInput input =
      batchInput([&]() -> std::unique_ptr<SampleSource> { return std::make_unique<ListSource>(all); },
                 detections(), vehicle, {panel}, calibration);
  if (!pixels) return input;
  input.data.patches = patches();
  input.data.blurs = blurs();
  input.data.specks = specks();
  input.data.textures = textures();
  input.data.water = environmentOf(1.02 * coastalWater());  // the fit starts a little off
  return input;
}

}  // namespace fathom::test
