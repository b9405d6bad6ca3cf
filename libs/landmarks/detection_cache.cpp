#include "landmarks/detection_cache.h"

#include <tbb/enumerable_thread_specific.h>

#include <set>

#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/for_each.h"
#include "core/version.h"
#include "image_files/image_file.h"
#include "image_files/one_opencv_thread.h"
#include "imaging/fingerprints.h"
#include "landmarks/kept_detections.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// All that detections depend on besides image and camera.
std::string inputsOf(const DetectionSettings& s) {
  std::string text = "Markers found in images.\nversion " + std::string(programVersion()) +
                     ", OpenCV " CV_VERSION "\nbackend " + std::string(nameOf(s.backend));
  if (s.fallback)
    text += ", below " + std::to_string(s.expected_markers) + " " + std::string(nameOf(*s.fallback));
  text += "\npreprocess " + std::string(nameOf(s.preprocess)) + (s.refine ? ", refined" : ", not refined") +
          ", corrected bits " + std::to_string(s.largest_corrected_bits) + "\nfamilies";
  for (const std::string& family : s.families) text += " " + family;
  text +=
      "\nborder " + std::to_string(s.look.border_width) + (s.look.white_on_black ? ", white on black" : "");
  return text + "\n";
}

/// What one thread needs for each camera.
using Detectors = std::map<std::string, std::unique_ptr<Detector>>;

std::vector<Detection> search(const CameraImage& image, const DetectionSettings& settings,
                              Detectors& detectors) {
  auto& detector = detectors[fingerprintOf(image.camera)];
  if (!detector) detector = detectorFor(image.camera, settings);
  return detector->detect(readImage(image.file, image.camera));
}

/// What becomes of one image.
struct Outcome {
  std::string fingerprint;  ///< of content and camera; empty: not readable
  std::optional<std::vector<Detection>> detections;
  bool kept_before = false;
  std::string why_not;
};

/// Finds what was kept of each image.
std::vector<Outcome> lookUp(const std::vector<CameraImage>& images, const KeptDetections& kept) {
  std::vector<Outcome> outcomes(images.size());
  forEachIndex(images.size(), "looking up " + std::to_string(images.size()) + " images", [&](std::size_t i) {
    Outcome& outcome = outcomes[i];
    try {
      Fingerprint fingerprint;
      fingerprint.add(readTextFile(images[i].file));
      add(fingerprint, images[i].camera);
      outcome.fingerprint = fingerprint.hex();
    } catch (const Error& error) {
      outcome.why_not = error.why;
      return;
    }
    const auto found = kept.find(outcome.fingerprint);
    if (found == kept.end()) return;
    outcome.detections = found->second;
    outcome.kept_before = true;
  });
  return outcomes;
}

/// Searches those that nothing was kept of.
void searchOthers(const std::vector<CameraImage>& images, const DetectionSettings& settings,
                  std::vector<Outcome>& outcomes) {
  const OneOpenCvThread one_thread;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (!outcomes[i].detections && outcomes[i].why_not.empty()) left.push_back(i);
  tbb::enumerable_thread_specific<Detectors> detectors;
  forEachIndex(left.size(), "finding markers in " + std::to_string(left.size()) + " images",
               [&](std::size_t k) {
                 Outcome& outcome = outcomes[left[k]];
                 try {
                   outcome.detections = search(images[left[k]], settings, detectors.local());
                 } catch (const Error& error) {
                   outcome.why_not = (error.where.empty() ? "" : error.where + ": ") + error.why;
                 }
               });
}

KeptDetections toKeep(const std::vector<Outcome>& outcomes) {
  KeptDetections kept;
  for (const Outcome& outcome : outcomes)
    if (outcome.detections) kept[outcome.fingerprint] = *outcome.detections;
  return kept;
}

fs::path fileFor(const fs::path& keep_in, const std::string& inputs) {
  return keep_in.empty() ? fs::path()
                         : fs::path(keep_in.string() + "_" + Fingerprint().add(inputs).hex() + ".gz");
}

Detections resultOf(const std::vector<CameraImage>& images, std::vector<Outcome>& outcomes) {
  Detections result;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (outcomes[i].kept_before) ++result.kept_before;
    if (outcomes[i].detections)
      result.by_file[images[i].file] = std::move(*outcomes[i].detections);
    else
      result.unreadable.push_back({images[i].file, outcomes[i].why_not});
  }
  return result;
}

}  // namespace

std::unique_ptr<Detector> detectorFor(const CameraModel& camera, const DetectionSettings& settings) {
  DetectorOptions options;
  options.preprocess = settings.preprocess;
  options.refine = settings.refine;
  options.camera = camera;
  options.look = settings.look;
  options.largest_corrected_bits = settings.largest_corrected_bits;
  auto first = makeDetector(settings.backend, settings.families, options);
  if (!settings.fallback) return first;
  return std::make_unique<FallbackDetector>(std::move(first),
                                            makeDetector(*settings.fallback, settings.families, options),
                                            static_cast<std::size_t>(settings.expected_markers));
}

DetectionSettings settingsFor(const std::vector<PanelMap>& panels, Backend backend) {
  std::set<std::string> families;
  DetectionSettings settings;
  settings.backend = backend;
  for (const PanelMap& panel : panels)
    for (const Marker& marker : panel.markers) {
      families.insert(marker.family);
      settings.look = marker.look;  // alike on all
    }
  settings.families = {families.begin(), families.end()};
  return settings;
}

const std::vector<Detection>* Detections::find(const fs::path& file) const {
  const auto found = by_file.find(file);
  return found == by_file.end() ? nullptr : &found->second;
}

std::size_t Detections::markerCount() const {
  std::size_t count = 0;
  for (const auto& [file, detections] : by_file) count += detections.size();
  return count;
}

Detections detectImages(const std::vector<CameraImage>& images, const DetectionSettings& settings,
                        const fs::path& keep_in) {
  const std::string inputs = inputsOf(settings);
  const fs::path file = fileFor(keep_in, inputs);
  const KeptDetections kept = file.empty() ? KeptDetections{} : readKept(file, inputs);
  auto outcomes = lookUp(images, kept);
  std::string not_kept_why;
  const auto keep = [&] {
    const KeptDetections now = toKeep(outcomes);
    const auto is_kept = [&](const auto& entry) { return kept.contains(entry.first); };
    const bool same = now.size() == kept.size() && std::all_of(now.begin(), now.end(), is_kept);
    if (file.empty() || same) return;
    try {
      writeKept(file, inputs, now);
    } catch (const Error& error) {
      not_kept_why = error.what();
    }
  };
  try {
    searchOthers(images, settings, outcomes);
  } catch (const Interrupted&) {
    keep();
    throw;
  }
  keep();
  Detections result = resultOf(images, outcomes);
  result.not_kept_why = not_kept_why;
  if (not_kept_why.empty()) result.kept_in = file;
  return result;
}

fs::path keepBeside(const fs::path& rawlog) {
  return rawlog.parent_path() / (rawlog.stem().string() + "_detections");
}

}  // namespace fathom
