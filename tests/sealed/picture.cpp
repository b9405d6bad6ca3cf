#include "picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "panel_design.h"

namespace fathom::sealed {
namespace {

constexpr float kEndless_m = 1000;
// Of the rim around a point from where white grows over it, and what makes it reach as far as a circle in
// the mean over an edge's directions: (pi / n) / sin(pi / n).
constexpr int kGrowthDirections = 8;
constexpr double kGrowthRounded = 1.0262;
constexpr unsigned kSamples = 64, kTurnedRound = 0b010101;  // of a pixel with an edge in it

/// Where in the pixel, and when in the exposure.
struct PixelSample {
  Vector2d offset_px;
  double time_share;  ///< of the exposure, -0.5 to 0.5
};

/// Hammersley's points, every other digit of the second coordinate turned round, and moments apart from
/// either: each by itself is even, and no two go together (correlations below 0.004), else edges would be
/// smeared aslant, moved with the robot, or blurred by less than the shutter's time.
std::vector<PixelSample> samplesOfPixel() {
  const auto place = [](unsigned cell) { return (cell % kSamples + 0.5) / kSamples - 0.5; };
  std::vector<PixelSample> samples;
  for (unsigned i = 0; i < kSamples; ++i) {
    unsigned mirrored = 0;
    for (unsigned digit = 1; digit < kSamples; digit *= 2)
      mirrored = 2 * mirrored + ((i ^ kTurnedRound) & digit ? 1 : 0);
    samples.push_back({{place(i), place(mirrored)}, place(5 * i + 12)});
  }
  return samples;
}

/// What one line of sight brings.
struct Light {
  std::array<Array3d, kBends + 1> scene;
  Array3d veil = Array3d::Zero();

  Light() { scene.fill(Array3d::Zero()); }
  void add(const Light& other, double share) {
    for (std::size_t i = 0; i < scene.size(); ++i) scene[i] += share * other.scene[i];
    veil += share * other.veil;
  }
};

cv::Vec3f pixelOf(const Array3d& light) {
  return {static_cast<float>(light.x()), static_cast<float>(light.y()), static_cast<float>(light.z())};
}

class Tracer {
 public:
  explicit Tracer(const View& view)
      : view_(view),
        edge_growth_px_(view.sealed.number("edge-bias", "offset_px", view.stamp_s) +
                        ordinaryEdgeGrowth_px(view.sealed)) {}

  Picture trace();

 private:
  Pose T_panel_camera(double t_s) const {
    return view_.panel.T_odom_panel(view_.stamp_s).inverse() *
           view_.viewpoint.T_odom_camera(t_s, view_.stamp_s);
  }
  double rowTime_s(int row) const { return view_.viewpoint.rowTime_s(row, view_.stamp_s); }
  Light lightAlong(const Vector2d& pixel, const Pose& T_panel_camera, Sighted& seen) const;
  Light lightWithGrownEdges(const Vector2d& pixel, const Pose& T_panel_camera) const;
  Light lightOf(const Sighted& seen, const Pose& T_panel_camera, const Ray& ray, const Vector2d& pixel) const;
  Light openWater(const Vector2d& pixel) const;
  void traceMiddles();
  void refineEdges();
  double movement_px() const;
  cv::Mat1b edges(double movement_px) const;
  void put(int row, int column, const Light& light);

  const View& view_;
  double edge_growth_px_;
  Picture picture_;
  cv::Mat1i surface_;
};

Light Tracer::openWater(const Vector2d& pixel) const {
  Light light;
  light.veil = view_.water.veil + view_.lamps.glow(pixel, kEndless_m);
  return light;
}

/// Light that the water bends leaves the beam, but not the image: so many bends come by Poisson's law (single
/// and multiple forward scattering, e.g. Wells 1973).
Light Tracer::lightOf(const Sighted& seen, const Pose& T_panel_camera, const Ray& ray,
                      const Vector2d& pixel) const {
  const WaterLight& water = view_.water;
  const Vector3d point_camera = ray.origin + seen.along * ray.direction;
  const double range_m = point_camera.norm(), path_m = water.path_m(point_camera.z(), range_m);
  const Vector3d normal_camera = T_panel_camera.rotation.transpose() * seen.normal_panel;
  const Array3d irradiance =
      water.daylight * seen.illumination + view_.lamps.irradianceOn(point_camera, normal_camera);
  const double cloud_depth = water.cloud.opticalDepth(ray.origin, point_camera);

  Light light;
  light.scene[0] = seen.albedo * irradiance * water.transmission(path_m) * std::exp(-cloud_depth);
  light.veil = water.veilBefore(path_m, cloud_depth) + view_.lamps.glow(pixel, range_m);
  if (water.scattered_fraction > 0) {
    const Array3d bends = water.scattered_fraction * water.attenuation_per_m * path_m;
    light.scene[1] = light.scene[0] * bends;
    light.scene[2] = light.scene[0] * bends * bends / 2;
    light.scene[3] = light.scene[0] * (bends.exp() - 1 - bends - bends * bends / 2);
  }
  return light;
}

Light Tracer::lightAlong(const Vector2d& pixel, const Pose& T_panel_camera, Sighted& seen) const {
  const Ray ray = view_.sight.at(pixel);
  seen = view_.painted.along(T_panel_camera * ray.origin, T_panel_camera.rotation * ray.direction);
  return seen.surface == 0 ? openWater(pixel) : lightOf(seen, T_panel_camera, ray, pixel);
}

/// Markers' white has grown over their black: it is white where white is within so many pixels. Where the
/// growth is negative, black has grown.
Light Tracer::lightWithGrownEdges(const Vector2d& pixel, const Pose& T_panel_camera) const {
  using Print = Sighted::Print;
  Sighted seen;
  const Light middle = lightAlong(pixel, T_panel_camera, seen);
  const Print growing = edge_growth_px_ > 0 ? Print::white : Print::black;
  if (edge_growth_px_ == 0 || seen.surface == 0 || seen.print == growing) return middle;
  if (growing == Print::white && seen.print == Print::none) return middle;
  for (int i = 0; i < kGrowthDirections; ++i) {
    const double towards_rad = 2 * std::numbers::pi * i / kGrowthDirections;
    const Ray ray = view_.sight.at(pixel + std::abs(edge_growth_px_) * kGrowthRounded *
                                               Vector2d(std::cos(towards_rad), std::sin(towards_rad)));
    const Sighted near =
        view_.painted.beside(seen, T_panel_camera * ray.origin, T_panel_camera.rotation * ray.direction);
    if (near.print == growing) return lightOf(near, T_panel_camera, ray, pixel);
  }
  return middle;
}

void Tracer::put(int row, int column, const Light& light) {
  for (std::size_t i = 0; i < picture_.scene.size(); ++i)
    picture_.scene[i](row, column) = pixelOf(light.scene[i]);
  picture_.veil(row, column) = pixelOf(light.veil);
}

void Tracer::traceMiddles() {
  for (int row = 0; row < surface_.rows; ++row) {
    const Pose pose = T_panel_camera(rowTime_s(row));
    for (int column = 0; column < surface_.cols; ++column) {
      Sighted seen;
      put(row, column, lightAlong({column, row}, pose, seen));
      surface_(row, column) = seen.surface;
      picture_.depth_m(row, column) = seen.surface == 0 ? kEndless_m : static_cast<float>(seen.along);
    }
  }
}

/// How far the panel's image moves while the shutter is open, at most.
double Tracer::movement_px() const {
  const TrueCamera camera(view_.camera, view_.sealed, view_.stamp_s);
  const double middle_s = rowTime_s(view_.camera.height_px / 2);
  const Pose begin = T_panel_camera(middle_s - view_.exposure_s / 2).inverse();
  const Pose end = T_panel_camera(middle_s + view_.exposure_s / 2).inverse();
  double most_px = 0;
  for (const double x : {-kHalfWidth_m, 0.0, kHalfWidth_m})
    for (const double y : {-kHalfHeight_m, 0.0, kHalfHeight_m}) {
      const auto from = camera.pixelOf(begin * Vector3d(x, y, 0)),
                 to = camera.pixelOf(end * Vector3d(x, y, 0));
      if (from && to) most_px = std::max(most_px, (*to - *from).norm());
    }
  return most_px;
}

/// Pixels next to one that sees another surface, and those that such an edge sweeps over. A straight edge
/// through a pixel always parts its middle from a neighbour's.
cv::Mat1b Tracer::edges(double movement_px) const {
  cv::Mat1f surface, lowest, highest;
  surface_.convertTo(surface, CV_32F);  // erode() and dilate() take no int
  const int reach = 1 + static_cast<int>(std::ceil(movement_px / 2));
  const cv::Mat around = cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U);
  cv::erode(surface, lowest, around);
  cv::dilate(surface, highest, around);
  return lowest != highest;
}

void Tracer::refineEdges() {
  const double moved_px = movement_px();
  const auto samples = samplesOfPixel();
  const cv::Mat1b edge = edges(moved_px + 2 * std::abs(edge_growth_px_));
  for (int row = 0; row < edge.rows; ++row) {
    std::vector<Pose> poses;
    for (const auto& sample : samples)
      poses.push_back(T_panel_camera(rowTime_s(row) + sample.time_share * view_.exposure_s));
    for (int column = 0; column < edge.cols; ++column) {
      if (edge(row, column) == 0) continue;
      Light mean;
      for (std::size_t i = 0; i < samples.size(); ++i)
        mean.add(lightWithGrownEdges(Vector2d(column, row) + samples[i].offset_px, poses[i]), 1.0 / kSamples);
      put(row, column, mean);
    }
  }
}

Picture Tracer::trace() {
  const cv::Size size(view_.camera.width_px, view_.camera.height_px);
  const std::size_t orders = view_.water.scattered_fraction > 0 ? kBends + 1 : 1;
  for (std::size_t i = 0; i < orders; ++i) picture_.scene.emplace_back(size);
  picture_.veil.create(size);
  picture_.depth_m.create(size);
  surface_.create(size);
  traceMiddles();
  refineEdges();
  return picture_;
}

}  // namespace

Picture takePicture(const View& view) { return Tracer(view).trace(); }

}  // namespace fathom::sealed
