#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "audit/audit.h"
#include "landmarks/landmark_source.h"
#include "localization/localizer.h"
#include "recording/sample_source.h"

namespace fathom {

/// What stands between a recording and the filter.
struct ChainOptions {
  std::filesystem::path rawlog;
  std::string vehicle, map;          ///< files; empty: those that the recording names
  std::string calibration, sources;  ///< files; empty: none
  std::string backend = "apriltag";  ///< which library finds the markers
  bool panel_unknown = false;        ///< the map's panel poses are not to be believed
  AuditChoice audit{};               ///< what is wrong with the streams, and known to the user
};

/// A recording's samples on their way to a filter: from where --sources says, with what the images tell of
/// the panels. What takes long (finding the markers, solving for the panels) is done once, at construction;
/// open() begins anew each time.
class SampleChain {
 public:
  /// With `landmarks`, finds the markers in all images, or takes the cached detections. Throws Error, also
  /// where a stream has a fault that audit() is sure of; Interrupted.
  SampleChain(const ChainOptions& options, bool landmarks);

  std::unique_ptr<SampleSource> open() const;
  /// Vehicle, calibration, panels, and the time of the first sample; no options, no start.
  const LocalizationSetup& setup() const { return setup_; }
  /// What a user should know, one line each.
  const std::vector<std::string>& remarks() const { return remarks_; }
  const std::vector<PanelMap>& panels() const { return panels_; }

 private:
  std::unique_ptr<SampleSource> openBare() const;
  /// What is missing, one line each.
  std::vector<std::string> findLandmarks(const RecordingHeader& header);

  ChainOptions options_;
  LocalizationSetup setup_;
  std::vector<std::string> remarks_;
  std::vector<PanelMap> panels_;
  std::shared_ptr<const Sightings> sightings_;  ///< null: landmarks are not wanted, or there are none
};

}  // namespace fathom
