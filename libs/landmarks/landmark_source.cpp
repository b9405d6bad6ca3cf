#include "landmarks/landmark_source.h"

#include <atomic>

#include "core/for_each.h"

namespace fathom {
namespace {

std::vector<CameraDetections> seenBy(const ImageEntry& entry, const Detections& detections) {
  std::vector<CameraDetections> cameras;
  for (const ImageEntry::Eye& eye : entry.eyes)
    if (const auto* found = detections.find(eye.image.file))
      cameras.push_back({*found, eye.image.camera, eye.T_first_camera});
  return cameras;
}

void count(Sightings& sightings) {
  for (const Sighting& sighting : sightings.by_entry) {
    if (sighting.robot || !sighting.unused.empty()) ++sightings.with_markers;
    sightings.panels_used += sighting.panels.panels.size();
    for (const UnusedPanel& unused : sighting.unused) ++sightings.panels_unused[unused.why];
  }
}

}  // namespace

Sightings solveSightings(const std::vector<ImageEntry>& entries, const Detections& detections,
                         const std::vector<PanelMap>& panels, const PanelPoseOptions& options) {
  Sightings sightings;
  sightings.by_entry.resize(entries.size());
  std::atomic<std::size_t> without_file = 0;
  forEachIndex(entries.size(), "solving for the panels", [&](std::size_t i) {
    const auto cameras = seenBy(entries[i], detections);
    if (cameras.size() < entries[i].eyes.size()) ++without_file;
    sightings.by_entry[i] = sightingOf(cameras, entries[i].T_robot_camera, panels, options);
  });
  sightings.without_file = without_file;
  count(sightings);
  return sightings;
}

LandmarkSource::LandmarkSource(std::unique_ptr<SampleSource> source,
                               std::shared_ptr<const Sightings> sightings)
    : source_(std::move(source)), sightings_(std::move(sightings)) {}

std::optional<Sample> LandmarkSource::next() {
  if (!derived_.empty()) {
    Sample sample = std::move(derived_.front());
    derived_.pop_front();
    return sample;
  }
  auto sample = source_->next();
  if (sample && isImage(*sample)) derive(sightings_->by_entry.at(entry_++), sample->time);
  return sample;
}

void LandmarkSource::derive(const Sighting& sighting, Time time) {
  const auto emit = [&](const char* label, Reading reading) {
    derived_.push_back({time, label, std::move(reading)});
  };
  if (sighting.robot) emit(labels::kMarkers, *sighting.robot);
  if (!sighting.panels.panels.empty()) emit(labels::kPanel, sighting.panels);
  if (!sighting.markers.markers.empty()) emit(labels::kMarkerSights, sighting.markers);
}

}  // namespace fathom
