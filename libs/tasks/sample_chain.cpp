#include "tasks/sample_chain.h"

#include "core/error.h"
#include "core/parallel.h"
#include "effects/calibration.h"
#include "panel/panel_maps.h"
#include "sources/make_source.h"
#include "tasks/companions.h"

namespace fathom {
namespace {

std::vector<PanelPrior> priorsOf(const std::vector<PanelMap>& panels, bool unknown) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  std::vector<PanelPrior> priors;
  for (const PanelMap& panel : panels)
    priors.push_back({panel.name, panel.T_odom_panel, unknown ? kUnknown : panel.position_sigma_m,
                      unknown ? kUnknown : panel.angle_sigma_rad});
  return priors;
}

}  // namespace

SampleChain::SampleChain(const ChainOptions& options, bool landmarks) : options_(options) {
  const RecordingHeader header = RawlogReader(options.rawlog).header();
  setup_.vehicle = readVehicle(neededVehicleFile(options.vehicle, options.rawlog, header));
  if (!options.calibration.empty()) setup_.calibration = readCalibration(options.calibration);
  requireInstances(setup_.calibration, setup_.vehicle, options.calibration);
  setup_.time_zero = openBare()->next()->time;
  const std::vector<std::string> remarks =
      requirePlausible(audit(*openBare(), setup_.vehicle), options.audit, options.rawlog).remarks;
  std::vector<std::string> lacking;
  // Each reads the recording once, so side by side.
  bothAtOnce([&] { remarks_ = disagreements(inspectRecording(options.rawlog), setup_.vehicle); },
             [&] {
               if (landmarks) lacking = findLandmarks(header);
             });
  remarks_.insert(remarks_.end(), remarks.begin(), remarks.end());
  remarks_.insert(remarks_.end(), lacking.begin(), lacking.end());
}

std::vector<std::string> SampleChain::findLandmarks(const RecordingHeader& header) {
  std::vector<std::string> lacking;
  const auto map = panelMapFile(options_.map, options_.rawlog, header);
  if (!map) {
    lacking.emplace_back("no landmarks: the recording names no panel map, and --map gives none");
    return lacking;
  }
  panels_ = readPanelMaps(*map);
  setup_.panels = priorsOf(panels_, options_.panel_unknown);
  const std::vector<ImageEntry> entries = imageEntries(*openBare(), setup_.vehicle);
  if (entries.empty()) lacking.emplace_back("no landmarks: there are no images");
  const Detections detections = detectImages(
      imagesOf(entries), settingsFor(panels_, backendNamed(options_.backend)), keepBeside(options_.rawlog));
  if (!detections.not_kept_why.empty())
    lacking.push_back("detections are not kept: " + detections.not_kept_why);
  for (const UnreadableImage& image : detections.unreadable)
    lacking.push_back(image.file.string() + ": " + image.why);
  sightings_ = std::make_shared<const Sightings>(
      solveSightings(entries, detections, panels_, {setup_.calibration, setup_.time_zero}));
  return lacking;
}

std::unique_ptr<SampleSource> SampleChain::openBare() const {
  std::unique_ptr<SampleSource> source;
  if (options_.sources.empty())
    source = std::make_unique<RecordingSource>(options_.rawlog);
  else
    source = makeSource(options_.sources, options_.rawlog);
  return corrected(std::move(source), options_.audit, setup_.vehicle);
}

std::unique_ptr<SampleSource> SampleChain::open() const {
  auto source = openBare();
  if (sightings_) source = std::make_unique<LandmarkSource>(std::move(source), sightings_);
  return source;
}

}  // namespace fathom
