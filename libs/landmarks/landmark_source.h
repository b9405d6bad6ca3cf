#pragma once

#include <deque>
#include <map>
#include <memory>

#include "landmarks/detection_cache.h"
#include "landmarks/sighting.h"

namespace fathom {

/// What became of the images that went by.
struct LandmarkTally {
  std::size_t images = 0;        ///< a pair is one
  std::size_t without_file = 0;  ///< of these, with a file that is not among the detections
  std::size_t with_markers = 0;  ///< with a marker of a panel
  std::size_t panels_used = 0;
  std::map<std::string, std::size_t> panels_unused;  ///< by the reason why
};

/// Another source's samples, and behind each image what its markers tell, at the image's time: MARKERS (a
/// PoseSample), PANEL and MARKER_SIGHTS, each where there is something to tell. Mountings and intrinsics are
/// the entries' own. Of a pair with one file that could not be read, the other one counts.
class LandmarkSource : public SampleSource {
 public:
  LandmarkSource(std::unique_ptr<SampleSource> source, std::shared_ptr<const Detections> detections,
                 std::vector<PanelMap> panels, const PanelPoseOptions& options = {});

  const RecordingHeader& header() const override { return source_->header(); }
  std::optional<Sample> next() override;
  std::filesystem::path imageFolder() const override { return source_->imageFolder(); }
  double fraction() const override { return source_->fraction(); }
  std::optional<RecordingLoss> loss() const override { return source_->loss(); }

  const LandmarkTally& tally() const { return tally_; }

 private:
  void derive(const Sample& sample);
  void addCamera(const std::string& file, const mrpt::img::TCamera& intrinsics, const Pose& T_first_camera,
                 std::vector<CameraDetections>& cameras) const;

  std::unique_ptr<SampleSource> source_;
  std::shared_ptr<const Detections> detections_;
  std::vector<PanelMap> panels_;
  PanelPoseOptions options_;
  LandmarkTally tally_;
  std::deque<Sample> derived_;  ///< of the latest image, not yet handed out
};

}  // namespace fathom
