#include "landmarks/landmark_source.h"

#include "recording/recorded_camera.h"

namespace fathom {

LandmarkSource::LandmarkSource(std::unique_ptr<SampleSource> source,
                               std::shared_ptr<const Detections> detections, std::vector<PanelMap> panels,
                               const PanelPoseOptions& options)
    : source_(std::move(source)),
      detections_(std::move(detections)),
      panels_(std::move(panels)),
      options_(options) {}

std::optional<Sample> LandmarkSource::next() {
  if (!derived_.empty()) {
    Sample sample = std::move(derived_.front());
    derived_.pop_front();
    return sample;
  }
  auto sample = source_->next();
  if (sample) derive(*sample);
  return sample;
}

void LandmarkSource::addCamera(const std::string& file, const mrpt::img::TCamera& intrinsics,
                               const Pose& T_first_camera, std::vector<CameraDetections>& cameras) const {
  const auto* detections = detections_->find(source_->imageFolder() / file);
  if (detections != nullptr) cameras.push_back({*detections, cameraModel(intrinsics), T_first_camera});
}

void LandmarkSource::derive(const Sample& sample) {
  const auto* image = std::get_if<ImageSample>(&sample.reading);
  const auto* pair = std::get_if<StereoSample>(&sample.reading);
  if (image == nullptr && pair == nullptr) return;
  const Pose& T_robot_camera = image != nullptr ? image->T_robot_camera : pair->T_robot_left;
  std::vector<CameraDetections> cameras;
  if (image != nullptr) {
    addCamera(image->file, image->intrinsics, {}, cameras);
  } else {
    addCamera(pair->left_file, pair->left_intrinsics, {}, cameras);
    addCamera(pair->right_file, pair->right_intrinsics, pair->T_left_right, cameras);
  }

  Sighting sighting = sightingOf(cameras, T_robot_camera, panels_, options_);
  ++tally_.images;
  if (cameras.size() < (image != nullptr ? 1U : 2U)) ++tally_.without_file;
  if (sighting.robot || !sighting.unused.empty()) ++tally_.with_markers;
  tally_.panels_used += sighting.panels.panels.size();
  for (const UnusedPanel& unused : sighting.unused) ++tally_.panels_unused[unused.why];

  const auto emit = [&](const char* label, Reading reading) {
    derived_.push_back({sample.time, label, std::move(reading)});
  };
  if (sighting.robot) emit(labels::kMarkers, std::move(*sighting.robot));
  if (!sighting.panels.panels.empty()) emit(labels::kPanel, std::move(sighting.panels));
  if (!sighting.markers.markers.empty()) emit(labels::kMarkerSights, std::move(sighting.markers));
}

}  // namespace fathom
