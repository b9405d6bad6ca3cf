#pragma once

#include <deque>
#include <map>
#include <memory>

#include "effects/registry.h"
#include "imaging/true_camera.h"
#include "landmarks/detection_cache.h"
#include "landmarks/image_entry.h"
#include "landmarks/sighting.h"

namespace fathom {

/// What the images of a recording tell, and what became of them.
struct Sightings {
  std::vector<Sighting> by_entry;  ///< in the order of the entries
  std::size_t without_file = 0;    ///< entries with a file that is not among the detections
  std::size_t with_markers = 0;    ///< entries with a marker of a panel
  std::size_t panels_used = 0;
  std::map<std::string, std::size_t> panels_unused;  ///< by the reason why
};

/// What is known of camera and panels beyond entries and maps.
struct LandmarkCalibration {
  EffectParameters<double> effects;
  Time time_zero{};  ///< the recording's first entry

  /// Seconds since then; 0 where there is no effect to ask.
  double stamp_s(Time time) const { return effects.on.any() ? secondsBetween(time_zero, time) : 0.0; }
};

/// One of an entry's cameras as it truly is.
TrueCamera trueCamera(const ImageEntry& entry, const ImageEntry::Eye& eye,
                      const LandmarkCalibration& calibration);

/// Solves every entry for its panels' poses, all cores at once. Of a pair with one file that could not be
/// read, the other one counts. With a calibration, camera and markers are taken as they truly are; a panel's
/// pose is that of the frame in which its map's T_odom_panel holds, wherever it was pushed. Throws
/// Interrupted.
Sightings solveSightings(const std::vector<ImageEntry>& entries, const Detections& detections,
                         const std::vector<PanelMap>& panels, const LandmarkCalibration& calibration = {},
                         const PanelPoseOptions& options = {});

/// Another source's samples, and behind each image what its markers tell, at the image's time: MARKERS (a
/// PoseSample), PANEL and MARKER_SIGHTS (MARKERS.port and so on of CAMERA.port), each where there is
/// something to tell.
class LandmarkSource : public SampleSource {
 public:
  /// `sightings` are those of this source's entries with images, all of them.
  LandmarkSource(std::unique_ptr<SampleSource> source, std::shared_ptr<const Sightings> sightings);

  const RecordingHeader& header() const override { return source_->header(); }
  std::optional<Sample> next() override;
  std::filesystem::path imageFolder() const override { return source_->imageFolder(); }
  double fraction() const override { return source_->fraction(); }
  std::optional<RecordingLoss> loss() const override { return source_->loss(); }

 private:
  void derive(const Sighting& sighting, const Sample& image);

  std::unique_ptr<SampleSource> source_;
  std::shared_ptr<const Sightings> sightings_;
  std::size_t entry_ = 0;       ///< the next with an image
  std::deque<Sample> derived_;  ///< of the latest image, not yet handed out
};

}  // namespace fathom
