#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fiducials/detector.h"
#include "landmarks/image_entry.h"
#include "panel/panel_map.h"

/// The markers in all images of a recording, searched once and kept in a file.
namespace fathom {

/// How images are searched.
struct DetectionSettings {
  std::vector<std::string> families;
  MarkerLook look{};
  Backend backend = Backend::aruco;
  /// Asked too where the first finds fewer than `expected_markers`.
  std::optional<Backend> fallback;
  int expected_markers = 1;
  Preprocess preprocess = Preprocess::none;
  bool refine = true;
  int largest_corrected_bits = 2;
};

/// A detector for one camera's images, for one thread. Throws std::invalid_argument as makeDetector().
std::unique_ptr<Detector> detectorFor(const CameraModel& camera, const DetectionSettings& settings);

/// The families of all markers of these panels, sorted, and how they are printed; by this backend.
DetectionSettings settingsFor(const std::vector<PanelMap>& panels, Backend backend = Backend::aruco);

struct UnreadableImage {
  std::filesystem::path file;
  std::string why;
};

/// What was found in a list of images.
struct Detections {
  /// Of every image that could be read, by file as it was given.
  std::map<std::filesystem::path, std::vector<Detection>> by_file;
  std::vector<UnreadableImage> unreadable;  ///< in the order of the images
  std::size_t kept_before = 0;              ///< images that were not searched again
  std::filesystem::path kept_in;            ///< empty where nothing is kept
  std::string not_kept_why;                 ///< where it should have been and could not

  /// Null: not among the images, or not readable.
  const std::vector<Detection>* find(const std::filesystem::path& file) const;
  std::size_t markerCount() const;
};

/// Searches images, all cores at once. An image that is missing, damaged or not of its camera's size is named
/// in the result and otherwise passed over.
///
/// What is found is kept in the file KEEP_IN_KEY.gz, KEY standing for the settings, to the last bit, by the
/// content of each image and its camera: where images have moved it still counts, where one has changed only
/// that one is searched again. The file holds the images of the latest run. It is written aside and renamed;
/// after Ctrl-C it has what was found until then, and a damaged one is made anew. An empty `keep_in` keeps
/// nothing; where the file cannot be written, the result says so and is whole all the same.
///
/// Throws Interrupted; std::invalid_argument as makeDetector().
Detections detectImages(const std::vector<CameraImage>& images, const DetectionSettings& settings,
                        const std::filesystem::path& keep_in);

/// Where detections of a rawlog's images are kept: beside it, in NAME_detections_KEY.gz.
std::filesystem::path keepBeside(const std::filesystem::path& rawlog);

}  // namespace fathom
