#include "camera_tables/panel_views.h"

#include "core/error.h"
#include "core/evenly.h"
#include "fiducials/single_marker_pose.h"
#include "landmarks/detection_cache.h"
#include "landmarks/image_entry.h"

namespace fathom {
namespace {

constexpr std::size_t kFewestPoints = 8;

std::vector<CameraImage> firstCamera(const std::vector<ImageEntry>& entries) {
  std::vector<CameraImage> images;
  for (const ImageEntry& entry : entries)
    if (entry.instance.isFirst()) images.push_back(entry.eyes.front().image);
  return images;
}

BoardView viewOf(const PanelMap& panel, const CameraImage& image, const std::vector<Detection>& detections,
                 bool in_water) {
  BoardView view;
  view.name = image.file.filename().string() + " " + panel.name;
  view.in_water = in_water;
  for (const Detection& detection : detections) {
    const Marker* marker = markerOf(detection, panel);
    if (marker == nullptr) continue;
    const auto corners = marker->corners_panel();
    view.points_m.insert(view.points_m.end(), corners.begin(), corners.end());
    view.pixels.insert(view.pixels.end(), detection.corners_px.begin(), detection.corners_px.end());
  }
  return view;
}

}  // namespace

PanelViews panelViews(const std::filesystem::path& rawlog, const Vehicle& vehicle,
                      const std::vector<PanelMap>& panels, bool in_water, std::size_t most_images) {
  RecordingSource source(rawlog);
  const std::vector<CameraImage> images = evenly(firstCamera(imageEntries(source, vehicle)), most_images);
  if (images.empty()) throw Error(rawlog.string(), "", "has no images");
  const Detections detections = detectImages(images, settingsFor(panels), {});
  PanelViews seen{images.front().camera, {}, images.size()};
  for (const CameraImage& image : images)
    if (const auto* found = detections.find(image.file))
      for (const PanelMap& panel : panels)
        if (BoardView view = viewOf(panel, image, *found, in_water); view.points_m.size() >= kFewestPoints)
          seen.views.push_back(std::move(view));
  return seen;
}

}  // namespace fathom
