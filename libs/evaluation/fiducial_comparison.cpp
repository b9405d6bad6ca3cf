#include "evaluation/fiducial_comparison.h"

#include <tbb/enumerable_thread_specific.h>

#include <opencv2/imgproc.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "core/for_each.h"
#include "core/parallel.h"
#include "core/text.h"
#include "core/version.h"
#include "effects/calibration.h"
#include "evaluation/chunk_store.h"
#include "evaluation/family_swap.h"
#include "evaluation/timed_detection.h"
#include "image_files/one_opencv_thread.h"
#include "imaging/eight_bits.h"
#include "imaging/fingerprints.h"
#include "imaging/true_panel.h"

namespace fathom {
namespace {

constexpr double kLargestRoll_rad = radians(30), kLargestAim_m = 0.15;

std::size_t viewNumber(const FiducialGrid& grid, const GridImage& image) {
  return (image.range * grid.tilts_rad.size() + image.tilt) * static_cast<std::size_t>(grid.repeats) +
         image.repeat;
}

/// The inverse, water and blur left 0.
GridImage imageOf(const FiducialGrid& grid, std::size_t family, std::size_t view_number) {
  const auto repeats = static_cast<std::size_t>(grid.repeats);
  const std::size_t station = view_number / repeats;
  return {family, station / grid.tilts_rad.size(), station % grid.tilts_rad.size(), view_number % repeats};
}

/// Beyond the numbers that views are drawn from. Every family meets the same noise.
std::uint64_t noiseStream(const FiducialGrid& grid, const GridImage& image) {
  const std::size_t number =
      (viewNumber(grid, image) * grid.waters.size() + image.water) * grid.blurs_px.size() + image.blur;
  return std::uint64_t{1} << 32U | number;
}

/// The same vehicle in the camera's frame, so that a view's pose is the robot's.
Vehicle inCameraFrame(Vehicle vehicle) {
  const Pose T_camera_robot = vehicle.camera->T_robot_camera.inverse();
  vehicle.camera->T_robot_camera = {};
  for (LampSheet& lamp : vehicle.lamps) lamp.T_robot_lamp = T_camera_robot * lamp.T_robot_lamp;
  return vehicle;
}

/// Marker effects are of the map's own ids, which another family does not have.
PanelMap withMarkersWhereTheyAre(PanelMap printed, const PanelMap& map, const FiducialGrid& grid) {
  const PanelMap there = truePanel(map, grid.effects, grid.t_s);
  for (std::size_t i = 0; i < printed.markers.size(); ++i) {
    printed.markers[i].size_m = there.markers[i].size_m;
    printed.markers[i].T_panel_marker = there.markers[i].T_panel_marker;
  }
  return printed;
}

EffectParameters<double> withoutMarkers(EffectParameters<double> effects) {
  effects.on.reset(kEffectIndex<MarkerMoved>);
  effects.on.reset(kEffectIndex<MarkerSize>);
  return effects;
}

PanelMap withoutMarkers(PanelMap map) {
  map.markers.clear();
  return map;
}

/// One family on the panel, seen in every way of the grid. For many threads at once.
class FamilyStudio {
 public:
  FamilyStudio(const FiducialGrid& grid, const PanelMap& map, const Vehicle& vehicle, std::size_t family)
      : grid_(grid),
        sheet_(*vehicle.camera),
        family_(family),
        map_(withFamily(map, grid.families[family])),
        true_map_(std::make_shared<PanelMap>(withMarkersWhereTheyAre(map_, map, grid))),
        views_(*true_map_, inCameraFrame(vehicle), {}, withoutMarkers(grid.effects)),
        bare_views_(withoutMarkers(*true_map_), inCameraFrame(vehicle), {}, withoutMarkers(grid.effects)),
        readers_(readersOf(grid.backends, grid.preprocessings)),
        detectors_([this] { return makeDetectors(); }) {}
  FamilyStudio(const FamilyStudio&) = delete;
  FamilyStudio& operator=(const FamilyStudio&) = delete;

  /// All that is made of one view.
  std::vector<FiducialResult> read(std::size_t view_number) const {
    GridImage image = imageOf(grid_, family_, view_number);
    const Pose T_camera_panel = viewOf(grid_, image).T_panel_camera().inverse();
    const CameraShot shot = shotOf(image);
    const View clean = views_.studio().renderAlbedo(shot);
    const auto places = placesIn(image);
    std::vector<FiducialResult> results;
    for (image.water = 0; image.water < grid_.waters.size(); ++image.water) {
      const cv::Mat light = lightThrough(image.water, shot, clean);
      for (image.blur = 0; image.blur < grid_.blurs_px.size(); ++image.blur) {
        const cv::Mat picture = expose(light, shot, image);
        for (std::size_t reader = 0; reader < readers_.size(); ++reader) {
          const TimedDetection timed = detectTimed(*detectors_.local()[reader], picture);
          FiducialResult result{image, reader, {}, timed.cpu_s};
          result.score = scoreDetections(timed.detections, places, grid_.match_px);
          scorePose(timed.detections, map_, sheet_.model, T_camera_panel, result.score);
          results.push_back(result);
        }
      }
    }
    return results;
  }

  FiducialPicture picture(const GridImage& image) const {
    const CameraShot shot = shotOf(image);
    const View clean = views_.studio().renderAlbedo(shot);
    FiducialPicture picture;
    picture.map = true_map_;
    const cv::Mat exposed = expose(lightThrough(image.water, shot, clean), shot, image);
    picture.image_bgr = inEightBits(exposed);
    picture.places = placesIn(image);
    for (const auto& detector : detectors_.local()) picture.detections.push_back(detector->detect(exposed));
    return picture;
  }

 private:
  using Detectors = std::vector<std::unique_ptr<Detector>>;

  Detectors makeDetectors() const {
    Detectors detectors;
    for (const FiducialReader& reader : readers_)
      detectors.push_back(makeDetector(reader, {grid_.families[family_]}, map_.look(), sheet_.model));
    return detectors;
  }

  CameraShot shotOf(const GridImage& image) const { return views_.shot(viewOf(grid_, image), grid_.seed); }

  /// What hides a marker is looked for on the panel without markers, so that it is the same for all families.
  std::vector<MarkerPlace> placesIn(const GridImage& image) const {
    const CameraView view = viewOf(grid_, image);
    const CameraShot shot = bare_views_.shot(view);
    const View bare = bare_views_.studio().renderAlbedo(shot);
    return placesOf(*true_map_, shot.camera.lens, shot.camera.projector, view.T_panel_camera().inverse(),
                    bare.range_m);
  }

  cv::Mat lightThrough(std::size_t water, const CameraShot& shot, const View& clean) const {
    const NamedWater& named = grid_.waters[water];
    return views_.studio().lightIn({named.water, named.ambient, {}}, shot, clean);
  }

  cv::Mat expose(const cv::Mat& light, const CameraShot& shot, const GridImage& image) const {
    cv::Mat blurred;  // not in place: other blurs are of the same light
    if (const double sigma_px = grid_.blurs_px[image.blur]; sigma_px > 0)
      cv::GaussianBlur(light, blurred, {}, sigma_px, sigma_px, cv::BORDER_REFLECT);
    else
      blurred = light;
    Random noise = Random::stream(grid_.seed, noiseStream(grid_, image));
    return views_.studio().exposeLight(shot, blurred, &noise);
  }

  const FiducialGrid& grid_;
  const CameraSheet& sheet_;
  std::size_t family_;
  PanelMap map_;                              ///< as printed: what poses are solved from
  std::shared_ptr<const PanelMap> true_map_;  ///< what is seen
  ViewStudio views_, bare_views_;
  std::vector<FiducialReader> readers_;
  mutable tbb::enumerable_thread_specific<Detectors> detectors_;
};

// ---- keeping results

std::string format(const std::vector<FiducialResult>& results) {
  std::string text;
  for (const FiducialResult& r : results)
    text += print("%d %d %d %d %.17g %d %.17g %.17g %.17g\n", r.score.visible, r.score.found, r.score.wrong,
                  r.score.unknown, r.score.squares_px2, r.score.posed ? 1 : 0, r.score.position_error_m,
                  r.score.angle_error_rad, r.detect_s);
  return text;
}

/// Nothing where these are no results of this grid.
std::optional<std::vector<FiducialResult>> parse(const std::string& text, const FiducialGrid& grid,
                                                 GridImage image) {
  const std::size_t readers = grid.backends.size() * grid.preprocessings.size();
  std::istringstream words(text);
  std::vector<FiducialResult> results;
  for (image.water = 0; image.water < grid.waters.size(); ++image.water)
    for (image.blur = 0; image.blur < grid.blurs_px.size(); ++image.blur)
      for (std::size_t reader = 0; reader < readers; ++reader) {
        FiducialResult& r = results.emplace_back(FiducialResult{image, reader, {}, 0});
        words >> r.score.visible >> r.score.found >> r.score.wrong >> r.score.unknown >>
            r.score.squares_px2 >> r.score.posed >> r.score.position_error_m >> r.score.angle_error_rad >>
            r.detect_s;
      }
  if (!words) return std::nullopt;
  return results;
}

/// Nothing where all is as drawn.
std::string effectsText(const FiducialGrid& grid, const std::vector<LampSheet>& lamps) {
  if (grid.effects.on.none()) return "";
  return print("time %.17g s\n", grid.t_s) + "lamps " + fingerprintOf(lamps) + "\n" +
         formatCalibration(grid.effects);
}

std::string inputsOf(const FiducialGrid& grid, const PanelMap& map, const Vehicle& vehicle) {
  std::string text = "What these results were made from; a run with other inputs removes them.\nversion " +
                     std::string(programVersion()) + "\ncamera " + fingerprintOf(*vehicle.camera) +
                     "\npanel " + fingerprintOf(map) + "\n";
  for (const auto& family : grid.families) text += "family " + family + "\n";
  for (const auto& reader : readersOf(grid.backends, grid.preprocessings))
    text += "reader " + reader.name() + "\n";
  for (const double range_m : grid.ranges_m) text += print("range %.17g m\n", range_m);
  for (const double tilt_rad : grid.tilts_rad) text += print("tilt %.17g rad\n", tilt_rad);
  for (const NamedWater& water : grid.waters) {
    text += "water " + water.name;
    for (const Vector3d& colour : {water.water.attenuation_per_m, water.water.veil, water.ambient})
      text += print(" %.17g %.17g %.17g", colour[0], colour[1], colour[2]);
    text += "\n";
  }
  for (const double blur_px : grid.blurs_px) text += print("blur %.17g px\n", blur_px);
  return text +
         print("repeats %d\nmatch %.17g px\nseed %llu\n", grid.repeats, grid.match_px,
               static_cast<unsigned long long>(grid.seed)) +
         effectsText(grid, vehicle.lamps);
}

void check(const FiducialGrid& grid, const Vehicle& vehicle) {
  if (!vehicle.camera) throw std::invalid_argument("compareFiducials needs a camera");
  if (grid.backends.empty() || grid.preprocessings.empty() || grid.imageCount() == 0)
    throw std::invalid_argument("compareFiducials: a list of the grid is empty");
  if (const auto why = complaintAbout(grid.families, grid.backends); !why.empty())
    throw std::invalid_argument("compareFiducials: families: " + why);
}

}  // namespace

CameraView viewOf(const FiducialGrid& grid, const GridImage& image) {
  ViewRanges exactly;
  exactly.nearest_m = exactly.farthest_m = grid.ranges_m[image.range];
  exactly.smallest_tilt_rad = exactly.largest_tilt_rad = grid.tilts_rad[image.tilt];
  exactly.largest_roll_rad = kLargestRoll_rad;
  exactly.largest_aim_m = std::min(kLargestAim_m, 0.25 * exactly.nearest_m);
  CameraView view = drawView(exactly, grid.seed, viewNumber(grid, image));
  view.t_s = grid.t_s;
  return view;
}

std::vector<FiducialResult> compareFiducials(const FiducialGrid& grid, const PanelMap& map,
                                             const Vehicle& vehicle, const std::filesystem::path& folder) {
  check(grid, vehicle);
  const OneOpenCvThread one_thread;  // images, not parts of one, go to threads
  const std::size_t views = grid.viewCount(), chunks = grid.families.size() * views;
  for (const auto& family : grid.families) withFamily(map, family);  // complains before the work begins
  const ChunkStore store(folder, inputsOf(grid, map, vehicle));

  SharedProgress progress("reading " + std::to_string(grid.imageCount()) + " images", chunks);
  std::vector<std::vector<FiducialResult>> by_chunk(chunks);
  for (std::size_t family = 0; family < grid.families.size(); ++family) {
    const FamilyStudio studio(grid, map, vehicle, family);
    const auto make = [&](std::size_t view) {
      const std::size_t chunk = family * views + view;
      std::optional<std::vector<FiducialResult>> kept;
      if (const auto text = store.read(chunk)) kept = parse(*text, grid, imageOf(grid, family, view));
      if (kept) {
        by_chunk[chunk] = std::move(*kept);
      } else {
        by_chunk[chunk] = studio.read(view);
        store.write(chunk, format(by_chunk[chunk]));
      }
    };
    forEachIndex(views, progress, make);
  }
  std::vector<FiducialResult> results;
  for (const auto& chunk : by_chunk) results.insert(results.end(), chunk.begin(), chunk.end());
  return results;
}

std::vector<FiducialPicture> fiducialPictures(const FiducialGrid& grid, const PanelMap& map,
                                              const Vehicle& vehicle, const std::vector<GridImage>& images) {
  check(grid, vehicle);
  const OneOpenCvThread one_thread;
  std::vector<FiducialPicture> pictures(images.size());
  for (std::size_t family = 0; family < grid.families.size(); ++family) {
    const FamilyStudio studio(grid, map, vehicle, family);
    parallelFor(images.size(), [&](std::size_t i) {
      if (images[i].family == family) pictures[i] = studio.picture(images[i]);
    });
  }
  return pictures;
}

}  // namespace fathom
