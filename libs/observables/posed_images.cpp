#include "observables/posed_images.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "core/stable_sort.h"

namespace fathom {
namespace {

/// The panel whose position is known best; null where there is none.
const SeenPanel* surestPanel(const Sighting& sighting) {
  const auto& seen = sighting.panels.panels;
  const auto surest = std::min_element(seen.begin(), seen.end(), [](const SeenPanel& a, const SeenPanel& b) {
    return a.T_camera_panel.covariance.topLeftCorner<3, 3>().trace() <
           b.T_camera_panel.covariance.topLeftCorner<3, 3>().trace();
  });
  return surest == seen.end() ? nullptr : &*surest;
}

std::string whyNot(const Sighting& sighting) {
  return sighting.unused.empty() ? "no marker of a panel" : sighting.unused.front().why;
}

}  // namespace

double range_m(const PosedImage& posed, const std::vector<PanelMap>& panels) {
  return (posed.T_odom_camera().position - panels.at(posed.panel).T_odom_panel.position).norm();
}

PosedImages posedImages(const std::vector<ImageEntry>& entries, const Detections& detections,
                        const Sightings& sightings, const std::vector<PanelMap>& panels,
                        const LandmarkCalibration& calibration) {
  std::map<std::filesystem::path, std::string> unreadable;
  for (const UnreadableImage& image : detections.unreadable) unreadable[image.file] = image.why;

  PosedImages images;
  std::size_t number = 0, of_others = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ImageEntry& entry = entries[i];
    const Sighting& sighting = sightings.by_entry.at(i);
    const SeenPanel* const seen = surestPanel(sighting);
    for (std::size_t eye = 0; eye < entry.eyes.size(); ++eye, ++number) {
      if (!entry.instance.isFirst()) {
        ++of_others;
        continue;
      }
      const auto& [image, T_first_camera] = entry.eyes[eye];
      const auto* found = detections.find(image.file);
      if (found == nullptr || seen == nullptr) {
        images.unposed.push_back(
            {entry.time, number, image.file, found == nullptr ? unreadable[image.file] : whyNot(sighting)});
        continue;
      }
      const auto panel = static_cast<std::size_t>(seen->panel);
      const UncertainPose T_odom_robot =
          robotPose(seen->T_camera_panel, panels[panel].T_odom_panel, sighting.panels.T_robot_camera);
      images.posed.push_back(
          {entry.time, number, i, eye, image, T_odom_robot, entry.T_robot_camera * T_first_camera,
           trueCamera(entry, entry.eyes[eye], calibration), calibration.stamp_s(entry.time), panel, *found});
    }
  }
  if (of_others > 0)
    images.remarks.push_back("only the first camera's images are looked at; " + std::to_string(of_others) +
                             " of other cameras are left out");
  return images;
}

PosedImages posedImages(const std::filesystem::path& rawlog, const Vehicle& vehicle,
                        const std::vector<PanelMap>& panels, const DetectionSettings& settings,
                        const EffectParameters<double>& effects) {
  RecordingSource source(rawlog);
  const std::vector<ImageEntry> entries = imageEntries(source, vehicle);
  if (entries.empty()) throw Error(rawlog.string(), "", "has no images");
  const Detections detections = detectImages(imagesOf(entries), settings, keepBeside(rawlog));
  const LandmarkCalibration calibration{effects, RawlogReader(rawlog).next().value().time};
  const Sightings sightings = solveSightings(entries, detections, panels, calibration);
  PosedImages images = posedImages(entries, detections, sightings, panels, calibration);
  const auto earlier = [](const auto& a, const auto& b) { return a.time < b.time; };
  stableSort(images.posed, earlier);
  stableSort(images.unposed, earlier);
  if (const auto loss = source.loss())
    images.remarks.push_back("the recording is damaged: " + describe(*loss));
  if (!detections.not_kept_why.empty())
    images.remarks.push_back("detections are not kept: " + detections.not_kept_why);
  return images;
}

std::size_t keepSpread(std::vector<PosedImage>& posed, std::size_t moments) {
  std::map<std::size_t, std::size_t> numbers;  // of entries, counted as they come
  for (const PosedImage& image : posed) numbers.try_emplace(image.entry, numbers.size());
  const std::size_t all = numbers.size();
  if (all > moments)
    std::erase_if(posed, [&](const PosedImage& image) {
      const std::size_t k = numbers[image.entry];
      return k * moments / all == (k + 1) * moments / all;
    });
  return all;
}

}  // namespace fathom
