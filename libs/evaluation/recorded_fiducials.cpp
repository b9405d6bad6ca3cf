#include "evaluation/recorded_fiducials.h"

#include <tbb/enumerable_thread_specific.h>

#include <map>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/for_each.h"
#include "core/text.h"
#include "core/version.h"
#include "evaluation/chunk_store.h"
#include "evaluation/timed_detection.h"
#include "fiducials/single_marker_pose.h"
#include "image_files/image_file.h"
#include "image_files/one_opencv_thread.h"
#include "imaging/eight_bits.h"
#include "imaging/fingerprints.h"
#include "render/renderer.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

// ---- what a recording has

void addImages(const Sample& sample, const fs::path& folder, std::vector<RecordedImage>& images) {
  if (const auto* image = std::get_if<ImageSample>(&sample.reading))
    images.push_back({folder / image->file, image->intrinsics.model, image->T_robot_camera, {}});
  if (const auto* pair = std::get_if<StereoSample>(&sample.reading)) {
    images.push_back({folder / pair->left_file, pair->left_intrinsics.model, pair->T_robot_left, {}});
    images.push_back({folder / pair->right_file,
                      pair->right_intrinsics.model,
                      pair->T_robot_left * pair->T_left_right,
                      {}});
  }
}

// ---- one image

/// What one thread needs for one camera.
struct Tools {
  std::vector<std::unique_ptr<Detector>> detectors;
  std::optional<Renderer> renderer;  ///< where there is a map
};
using ToolsByCamera = std::map<std::string, Tools>;

Tools& toolsFor(const CameraModel& camera, const RecordedFiducialsOptions& options, ToolsByCamera& tools) {
  const auto [entry, is_new] = tools.try_emplace(fingerprintOf(camera));
  if (is_new) {
    const MarkerLook look = options.map ? options.map->look() : MarkerLook{};
    for (const FiducialReader& reader : options.readers)
      entry->second.detectors.push_back(makeDetector(reader, options.families, look, camera));
    if (options.map) entry->second.renderer.emplace(camera).setScene(surfaceOf(*options.map));
  }
  return entry->second;
}

Pose T_panel_camera(const RecordedImage& image, const PanelMap& map) {
  return map.T_odom_panel.inverse() * *image.T_odom_robot * image.T_robot_camera;
}

std::optional<std::vector<MarkerPlace>> placesIn(const RecordedImage& image,
                                                 const RecordedFiducialsOptions& options, Tools& tools) {
  if (!options.map || !image.T_odom_robot) return std::nullopt;
  const Pose camera = T_panel_camera(image, *options.map);
  const View clean = tools.renderer->render(camera, Lighting{});
  return placesOf(*options.map, image.camera, camera.inverse(), clean.range_m);
}

RecordedResult read(const RecordedImage& image, const RecordedFiducialsOptions& options, Tools& tools) {
  const cv::Mat pixels = readImage(image.file, image.camera);
  const auto places = placesIn(image, options, tools);
  RecordedResult result;
  result.truth_known = places.has_value();
  std::vector<std::vector<Detection>> detections;
  for (const auto& detector : tools.detectors) {
    const TimedDetection timed = detectTimed(*detector, pixels);
    detections.push_back(timed.detections);
    RecordedReading& reading = result.readings.emplace_back();
    reading.detections = static_cast<int>(timed.detections.size());
    reading.detect_s = timed.cpu_s;
    if (options.map)
      for (const Detection& detection : timed.detections)
        reading.not_on_map += markerOf(detection, *options.map) == nullptr ? 1 : 0;
    if (!places) continue;
    reading.score = scoreDetections(timed.detections, *places, options.match_px);
    scorePose(timed.detections, *options.map, image.camera, T_panel_camera(image, *options.map).inverse(),
              reading.score);
  }
  for (std::size_t i = 0; i < detections.size(); ++i)
    for (std::size_t j = i + 1; j < detections.size(); ++j)
      result.agreements.push_back(agreementOf(detections[i], detections[j], options.match_px));
  return result;
}

// ---- keeping results

std::string format(const std::string& image_fingerprint, const RecordedResult& result) {
  std::string text = image_fingerprint + (result.truth_known ? " 1\n" : " 0\n");
  for (const RecordedReading& r : result.readings)
    text += print("%d %d %d %d %d %d %.17g %d %.17g %.17g %.17g\n", r.detections, r.not_on_map,
                  r.score.visible, r.score.found, r.score.wrong, r.score.unknown, r.score.squares_px2,
                  r.score.posed ? 1 : 0, r.score.position_error_m, r.score.angle_error_rad, r.detect_s);
  for (const ReaderAgreement& a : result.agreements)
    text += print("%d %d %d %.17g\n", a.both, a.only_first, a.only_second, a.squares_px2);
  return text;
}

/// Nothing where it is of another image.
std::optional<RecordedResult> parse(const std::string& text, const std::string& image_fingerprint,
                                    std::size_t readers) {
  std::istringstream words(text);
  std::string fingerprint;
  RecordedResult result;
  words >> fingerprint >> result.truth_known;
  if (fingerprint != image_fingerprint) return std::nullopt;
  result.readings.resize(readers);
  for (RecordedReading& r : result.readings)
    words >> r.detections >> r.not_on_map >> r.score.visible >> r.score.found >> r.score.wrong >>
        r.score.unknown >> r.score.squares_px2 >> r.score.posed >> r.score.position_error_m >>
        r.score.angle_error_rad >> r.detect_s;
  result.agreements.resize(readers * (readers - 1) / 2);
  for (ReaderAgreement& a : result.agreements)
    words >> a.both >> a.only_first >> a.only_second >> a.squares_px2;
  if (!words) return std::nullopt;
  return result;
}

std::string inputsOf(const std::vector<RecordedImage>& images, const RecordedFiducialsOptions& options) {
  Fingerprint cameras;
  for (const RecordedImage& image : images) {
    cameras.add(fingerprintOf(image.camera));
    add(cameras, image.T_robot_camera);
    if (image.T_odom_robot) add(cameras, *image.T_odom_robot);
  }
  std::string text = "What these results were made from; a run with other inputs removes them.\nversion " +
                     std::string(programVersion()) + "\ncameras " + cameras.hex() + "\n";
  if (options.map) text += "panel " + fingerprintOf(*options.map) + "\n";
  for (const auto& family : options.families) text += "family " + family + "\n";
  for (const FiducialReader& reader : options.readers) text += "reader " + reader.name() + "\n";
  return text + print("match %.17g px\n", options.match_px);
}

}  // namespace

std::vector<RecordedImage> recordedImages(RawlogReader& reader) {
  std::vector<RecordedImage> images;
  std::size_t first_of_instant = 0;  // images of the latest instant that has any
  Time image_time{};
  std::optional<std::pair<Time, Pose>> truth;  // the latest
  Progress progress("looking for images");
  while (const auto sample = reader.next()) {
    const std::size_t before = images.size();
    addImages(*sample, reader.imageFolder(), images);
    if (images.size() > before && (before == 0 || sample->time != image_time)) {
      first_of_instant = before;
      image_time = sample->time;
    }
    if (sample->label == labels::kTruth)
      truth = {sample->time, std::get<PoseSample>(sample->reading).T_odom_robot.mean};
    if (truth && truth->first == image_time)
      for (std::size_t i = first_of_instant; i < images.size(); ++i) images[i].T_odom_robot = truth->second;
    progress.update(reader.fraction());
  }
  return images;
}

ReaderAgreement agreementOf(const std::vector<Detection>& first, const std::vector<Detection>& second,
                            double match_px) {
  ReaderAgreement agreement;
  std::vector<bool> taken(second.size(), false);
  for (const Detection& a : first) {
    std::size_t match = 0;
    double squares = 0;
    for (; match < second.size(); ++match) {
      const Detection& b = second[match];
      if (taken[match] || a.family != b.family || a.id != b.id) continue;
      double largest = 0;
      squares = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double square = (a.corners_px[k] - b.corners_px[k]).squaredNorm();
        largest = std::max(largest, square);
        squares += square;
      }
      if (largest <= match_px * match_px) break;
    }
    if (match == second.size()) {
      ++agreement.only_first;
      continue;
    }
    taken[match] = true;
    ++agreement.both;
    agreement.squares_px2 += squares;
  }
  agreement.only_second = static_cast<int>(second.size()) - agreement.both;
  return agreement;
}

std::vector<RecordedResult> readRecordedFiducials(const std::vector<RecordedImage>& images,
                                                  const RecordedFiducialsOptions& options,
                                                  const fs::path& chunks) {
  const OneOpenCvThread one_thread;
  const ChunkStore store(chunks, inputsOf(images, options));
  std::vector<RecordedResult> results(images.size());
  tbb::enumerable_thread_specific<ToolsByCamera> tools;
  const auto make = [&](std::size_t i) {
    const std::string fingerprint = Fingerprint().add(readTextFile(images[i].file)).hex();
    std::optional<RecordedResult> kept;
    if (const auto text = store.read(i)) kept = parse(*text, fingerprint, options.readers.size());
    if (kept) {
      results[i] = *kept;
    } else {
      results[i] = read(images[i], options, toolsFor(images[i].camera, options, tools.local()));
      store.write(i, format(fingerprint, results[i]));
    }
  };
  forEachIndex(images.size(), "reading " + std::to_string(images.size()) + " images", make);
  return results;
}

std::vector<RecordedPicture> recordedPictures(const std::vector<RecordedImage>& images,
                                              const RecordedFiducialsOptions& options) {
  const OneOpenCvThread one_thread;
  ToolsByCamera tools_by_camera;
  std::vector<RecordedPicture> pictures;
  for (const RecordedImage& image : images) {
    Tools& tools = toolsFor(image.camera, options, tools_by_camera);
    RecordedPicture& picture = pictures.emplace_back();
    const cv::Mat pixels = readImage(image.file, image.camera);
    picture.image = inEightBits(pixels);
    picture.places = placesIn(image, options, tools);
    for (const auto& detector : tools.detectors) picture.detections.push_back(detector->detect(pixels));
  }
  return pictures;
}

}  // namespace fathom
