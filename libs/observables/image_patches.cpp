#include "observables/image_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "core/parallel.h"
#include "observables/image_texture.h"
#include "observables/marker_edges.h"
#include "observables/open_water.h"
#include "observables/specks.h"

namespace fathom {
namespace {

constexpr double kBodyCell_m = 0.25;  // pieces that the panel's body is cut into
constexpr double kHandleMargin = 1.2;
constexpr std::size_t kFewestPieces = 30;

/// The places of a panel: two a marker, black and white, then the pieces of its body, each of one paint.
class Places {
 public:
  Places(const PanelMap& panel, int first) : panel_(panel), first_(first) {
    Vector3d high = Vector3d::Zero();
    for (const Marker& marker : panel.markers) {
      T_marker_panel_.push_back(marker.T_panel_marker.inverse());
      for (const Vector3d& corner : marker.corners_panel()) reach(corner, high);
    }
    for (const auto& vertex : panel.body.vertices) {
      reach(vertex.position.cast<double>(), high);
      const cv::Vec3f albedo(vertex.albedo[0], vertex.albedo[1], vertex.albedo[2]);
      if (std::find(paints_.begin(), paints_.end(), albedo) == paints_.end()) paints_.push_back(albedo);
    }
    for (int axis = 0; axis < 2; ++axis)
      cells_[axis] = static_cast<int>(std::floor((high[axis] - low_[axis]) / kBodyCell_m)) + 1;
  }

  int end() const { return firstOfBody() + cells_[0] * cells_[1] * static_cast<int>(paints_.size()); }

  static constexpr int kOfMarker = 2;  // black, white
  /// Of one of its places.
  ImagePatch::Surface surface(int place) const {
    if (place >= firstOfBody()) return ImagePatch::Surface::body;
    return (place - first_) % kOfMarker == 0 ? ImagePatch::Surface::black : ImagePatch::Surface::white;
  }

  /// Id of the marker that a place is of; -1: of none.
  int markerId(int place) const {
    return place >= firstOfBody() ? -1
                                  : panel_.markers[static_cast<std::size_t>((place - first_) / kOfMarker)].id;
  }

  /// Of a point of the panel; -1 where a handle may be, whose state is not known.
  int at(const Vector3d& point_panel, const cv::Vec3f& albedo) const {
    for (const Handle& handle : panel_.handles) {
      const double reach_m = kHandleMargin * std::max(handle.radius_m, handle.length_m);
      if ((point_panel - handle.position_panel).head<2>().norm() < reach_m) return -1;
    }
    for (std::size_t i = 0; i < panel_.markers.size(); ++i) {
      const Vector3d point = T_marker_panel_[i] * point_panel;
      if (point.head<2>().cwiseAbs().maxCoeff() > 0.5 * panel_.markers[i].size_m) continue;
      const bool white =
          (albedo[0] + albedo[1] + albedo[2]) / 3 > 0.5 * (panel_.white_albedo + panel_.black_albedo);
      return first_ + kOfMarker * static_cast<int>(i) + (white ? 1 : 0);
    }
    const auto cell = [&](int axis) {
      return std::clamp(static_cast<int>(std::floor((point_panel[axis] - low_[axis]) / kBodyCell_m)), 0,
                        cells_[axis] - 1);
    };
    return firstOfBody() + (cell(1) * cells_[0] + cell(0)) * static_cast<int>(paints_.size()) +
           paintOf(albedo);
  }

 private:
  int firstOfBody() const { return first_ + kOfMarker * static_cast<int>(panel_.markers.size()); }

  void reach(const Vector3d& point, Vector3d& high) {
    low_ = low_.cwiseMin(point);
    high = high.cwiseMax(point);
  }

  int paintOf(const cv::Vec3f& albedo) const {
    const auto nearest = std::min_element(
        paints_.begin(), paints_.end(),
        [&](const cv::Vec3f& a, const cv::Vec3f& b) { return cv::norm(a - albedo) < cv::norm(b - albedo); });
    return static_cast<int>(nearest - paints_.begin());
  }

  const PanelMap& panel_;
  int first_;
  std::vector<Pose> T_marker_panel_;
  Vector3d low_ = Vector3d::Zero();
  std::array<int, 2> cells_{};
  std::vector<cv::Vec3f> paints_;  ///< the body's albedos: a patch is of one
};

std::vector<Places> placesOf(const std::vector<PanelMap>& panels) {
  std::vector<Places> places;
  for (const PanelMap& panel : panels) places.emplace_back(panel, places.empty() ? 0 : places.back().end());
  return places;
}

Pose panelFromCamera(const PosedImage& posed, const std::vector<PanelMap>& panels) {
  return panels[posed.panel].T_odom_panel.inverse() * posed.T_odom_camera();
}

/// The place that each pixel shows; -1: of none.
cv::Mat placesIn(const PosedImage& image, const View& clean, const cv::Mat& rays,
                 const std::vector<PanelMap>& panels, const std::vector<Places>& places) {
  const Pose T_panel_camera = panelFromCamera(image, panels);
  const cv::Mat known = knownAround(clean, image.camera.lens);
  cv::Mat labels(clean.range_m.size(), CV_32SC1, cv::Scalar(-1));
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const float range_m = clean.range_m.at<float>(v, u);
      if (known.at<std::uint8_t>(v, u) == 0) continue;
      const cv::Vec3f ray = range_m * rays.at<cv::Vec3f>(v, u), albedo = clean.radiance.at<cv::Vec3f>(v, u);
      labels.at<int>(v, u) =
          places[image.panel].at(T_panel_camera * Vector3d(ray[0], ray[1], ray[2]), albedo);
    }
  return labels;
}

/// What stands for all of a patch: in the direction of its middle, where z and the image radius are their
/// means. (Those of the middle pixel are less: 0.03 DN of a piece of a panel near by.)
Vector3d pointOf(const Patch& patch, const CameraModel& camera) {
  const Vector2d middle = camera.idealAt(patch.pixel);
  const double stretch = middle.norm() > 1e-3 ? patch.image_radius / middle.norm() : 1;
  return patch.z_m * (stretch * middle).homogeneous();
}

ImagePatch patchOf(const Patch& plain, ImagePatch::Surface surface, const PosedImage& posed,
                   const std::vector<PanelMap>& panels, const CameraSheet& sheet, Time time_zero) {
  const CameraModel& camera = posed.camera.lens;
  ImagePatch patch;
  patch.t_s = secondsBetween(time_zero, posed.time);
  patch.image = posed.entry;
  patch.eye = posed.eye;
  patch.panel = posed.panel;
  patch.place = plain.label;
  patch.surface = surface;
  const Pose T_panel_camera = panelFromCamera(posed, panels);
  patch.point_panel = T_panel_camera * pointOf(plain, camera);
  patch.around_panel = placesAround(plain, camera, T_panel_camera);
  if (surface != ImagePatch::Surface::water) patch.at_panel_m = middleOnPanel_m(patch.around_panel);
  patch.scene_odom = panels.front().T_odom_panel.position;
  patch.albedo = plain.albedo;
  patch.albedo_around = plain.albedo_around;
  patch.pixel = plain.pixel;
  patch.pixel_spread = plain.pixel_covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::Array2d size_px(camera.width_px, camera.height_px);
  patch.image_place = (plain.pixel.array() + 0.5) / size_px;
  patch.image_spread = patch.pixel_spread.array() / size_px;
  patch.image_radius = plain.image_radius;
  patch.image_tangent = plain.image_tangent;
  patch.response_gamma = sheet.response_gamma;
  patch.image_mean = plain.image_mean;
  patch.radiance = plain.radiance;
  patch.sigma = plain.sigma;
  patch.T_robot_camera = posed.T_robot_camera;
  return patch;
}

SpeckCount specksIn(const CleanPair& pair, const cv::Mat& rays, const cv::Mat& labels,
                    const PatchOptions& options, const CameraSheet& sheet, const CameraModel& lens) {
  cv::Mat cosines;
  cv::extractChannel(rays, cosines, 2);
  return countSpecks({radianceOf(pair.recorded, sheet), flatInterior(pair.clean, pair.panel_mask, options),
                      labels, pair.clean.range_m.mul(cosines)},
                     sheet, lens);
}

/// Specks scatter by Poisson's law about the mean that all images' density gives; and one may always be
/// false.
std::vector<ImageSpecks> withSigmas(const std::vector<PosedImage>& posed,
                                    const std::vector<std::optional<SpeckCount>>& counts,
                                    const Environment& environment, Time time_zero) {
  constexpr double kFalse = 1;
  std::vector<SpeckVolumes> volumes(posed.size());
  parallelFor(posed.size(), [&](std::size_t i) {
    if (counts[i]) volumes[i] = volumesOf(counts[i]->cells, environment);
  });
  std::vector<ImageSpecks> specks;
  double counted = 0, visible_m3 = 0;
  for (std::size_t i = 0; i < posed.size(); ++i) {
    if (!counts[i]) continue;
    specks.push_back({secondsBetween(time_zero, posed[i].time), posed[i].entry, posed[i].eye,
                      counts[i]->specks, BySpeckClass::Ones(), volumes[i]});
    counted += specks.back().counted.sum();
    visible_m3 += specks.back().volumes.visible_m3.sum();
  }
  const double density = counted / std::max(1e-9, visible_m3);
  for (ImageSpecks& seen : specks) seen.sigma = (kFalse + expectedSpecks(seen.volumes, density)).sqrt();
  return specks;
}

std::optional<ImageTexture> textureIn(const CleanPair& pair, const PosedImage& posed, const cv::Mat& labels,
                                      const PatchOptions& options, const CameraSheet& sheet, Time time_zero) {
  auto texture =
      measureTexture(pair.recorded, flatInterior(pair.clean, pair.panel_mask, options), labels, sheet);
  if (!texture) return std::nullopt;
  texture->t_s = secondsBetween(time_zero, posed.time);
  texture->image = posed.entry;
  texture->eye = posed.eye;
  return texture;
}

/// Near the rim of an image, and from afar, less of a place is seen.
void setSeenShares(std::vector<ImagePatch>& patches, const std::vector<double>& areas) {
  std::map<int, double> most;  // by place
  for (std::size_t i = 0; i < patches.size(); ++i)
    most[patches[i].place] = std::max(most[patches[i].place], areas[i]);
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (areas[i] > 0) patches[i].seen_share = areas[i] / most[patches[i].place];
}

}  // namespace

ImagePatches imagePatches(const std::vector<PosedImage>& posed, const CleanPairMaker& maker, Time time_zero,
                          const StartWater& startWater, bool open_water) {
  const std::vector<PanelMap>& panels = maker.world().panels;
  const std::vector<Places> places = placesOf(panels);
  const auto labelsOf = [&](const PosedImage& image, const View& clean) {
    return placesIn(image, clean, maker.studio().rays(image.camera.lens), panels, places);
  };
  std::vector<std::size_t> all(posed.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::vector<MarkerBlur>> blurs(posed.size());
  std::vector<std::optional<SpeckCount>> specks(posed.size());
  std::vector<std::optional<ImageTexture>> textures(posed.size());
  std::vector<std::vector<Patch>> beside(posed.size());
  const auto look = [&](std::size_t i, const CleanPair& pair, const cv::Mat& labels,
                        const PatchOptions& options) {
    blurs[i] = markerEdges(posed[i], pair, panels, maker.camera(), time_zero);
    const cv::Mat rays = maker.studio().rays(posed[i].camera.lens);
    CameraSheet sheet = maker.camera();
    sheet.bits = 8;
    sheet.model = posed[i].camera.lens;
    specks[i] = specksIn(pair, rays, labels, options, sheet, posed[i].camera.lens);
    textures[i] = textureIn(pair, posed[i], labels, options, sheet, time_zero);
    if (open_water)
      beside[i] = openWaterOf(pair, rays, posed[i].T_odom_camera().rotation, sheet, options.margin_px);
  };
  const SynchronizedImages synchronized = synchronize(posed, all, maker, labelsOf, look);

  ImagePatches result;
  for (const auto& of_image : blurs)
    result.blurs.insert(result.blurs.end(), of_image.begin(), of_image.end());
  for (const auto& of_image : textures)
    if (of_image) result.textures.push_back(*of_image);
  setChessboard(result.textures);
  result.rejected = synchronized.rejected;
  std::vector<double> areas;
  const auto add = [&](const Patch& patch, ImagePatch::Surface surface, const PosedImage& seen) {
    if (patch.sigma.array().isInf().all()) return;
    result.patches.push_back(patchOf(patch, surface, seen, panels, maker.camera(), time_zero));
    // A pixel is as much of a plane as the cube of its z over the plane's distance.
    const double distance_m = panelFromCamera(seen, panels).position.z();
    areas.push_back(
        surface == ImagePatch::Surface::water ? 0 : patch.pixels * std::pow(patch.z_m, 3) / distance_m);
  };
  for (const Patch& patch : synchronized.patches) {
    const PosedImage& seen = posed[synchronized.images[patch.image]];
    const std::size_t before = result.patches.size();
    add(patch, places[seen.panel].surface(patch.label), seen);
    if (result.patches.size() > before)
      result.patches.back().marker_id = places[seen.panel].markerId(patch.label);
  }
  const auto start = result.patches.size() < kFewestPieces ? std::nullopt : startWater(synchronized);
  if (!start) {
    result.patches.clear();
    areas.clear();
  } else {
    result.start = *start;
    result.specks = withSigmas(posed, specks, result.start, time_zero);
    for (std::size_t i = 0; i < posed.size(); ++i)
      for (Patch patch : beside[i]) {
        patch.label += places.back().end();
        add(patch, ImagePatch::Surface::water, posed[i]);
      }
  }
  setSeenShares(result.patches, areas);
  return result;
}

}  // namespace fathom
