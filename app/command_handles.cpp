#include <algorithm>
#include <iostream>
#include <memory>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "commands.h"
#include "core/error.h"
#include "core/files.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "handles/evidence_picture.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "reports/handles_report.h"
#include "simulation/copy_panel_map.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct HandlesOptions {
  std::string recording, vehicle, map, water = "config/water_clear.yaml", truth, folder;
  std::size_t window = 30, every = 1;
  std::uint64_t seed = 1;
  bool no_pictures = false, no_simulation = false;
};

constexpr std::size_t kShownPictures = 3;

/// All handles of an image that are in view, one below the other.
class EvidenceFolder {
 public:
  EvidenceFolder(fs::path folder, const std::vector<PanelMap>& panels)
      : folder_(std::move(folder)), panels_(panels) {}

  void add(const PosedImage& posed, const cv::Mat& image, const std::vector<HandleReading>& readings) {
    std::vector<cv::Mat> rows;
    std::size_t confident = 0;
    for (const HandleReading& reading : readings) {
      if (!reading.view.why_not.empty()) continue;
      rows.push_back(evidencePicture(image, reading, titleOf(posed.panel, reading)));
      confident += reading.confident ? 1 : 0;
    }
    if (rows.empty()) return;
    cv::Mat sheet;
    cv::vconcat(rows, sheet);
    std::vector<uchar> bytes;
    cv::imencode(".jpg", sheet, bytes, {cv::IMWRITE_JPEG_QUALITY, 85});
    const fs::path file = folder_ / (posed.image.file.stem().string() + ".jpg");
    writeTextFile(file, std::string(bytes.begin(), bytes.end()));
    const std::scoped_lock lock(mutex_);
    written_.emplace_back(posed.number, confident, file);
  }

  /// Of images with most handles read, those apart in time.
  std::vector<fs::path> telling() {
    std::sort(written_.begin(), written_.end());
    std::vector<fs::path> chosen;
    const std::size_t parts = std::min(kShownPictures, written_.size());
    for (std::size_t part = 0; part < parts; ++part) {
      const auto first = written_.begin() + static_cast<std::ptrdiff_t>(part * written_.size() / parts);
      const auto last = written_.begin() + static_cast<std::ptrdiff_t>((part + 1) * written_.size() / parts);
      chosen.push_back(std::get<2>(*std::max_element(
          first, last, [](const auto& a, const auto& b) { return std::get<1>(a) < std::get<1>(b); })));
    }
    return chosen;
  }

 private:
  std::string titleOf(std::size_t panel, const HandleReading& reading) const {
    const std::string id = panels_[panel].handles[reading.handle].id;
    if (!reading.confident) return id + ": " + reading.why_not;
    return print(
        "%s: %.1f +- %.1f deg%s", id.c_str(), degrees(reading.angle_rad), degrees(reading.sigma_rad),
        reading.edge.found ? print("; by its edges %.1f", degrees(reading.edge.angle_rad)).c_str() : "");
  }

  fs::path folder_;
  const std::vector<PanelMap>& panels_;
  std::mutex mutex_;
  std::vector<std::tuple<std::size_t, std::size_t, fs::path>> written_;
};

/// The maps' copies, with what was read as their state; the one to be read.
fs::path writeMaps(const HandlesStory& story, const fs::path& folder) {
  fs::path copy = copyPanelMap(story.map, folder);
  const std::vector<fs::path> files = panelMapFiles(copy);
  for (std::size_t i = 0; i < files.size(); ++i) writeTextFile(files[i], formatPanelMap(story.panels[i]));
  return copy;
}

/// Panel and handles as each image shows them.
void writeResultsLog(const HandlesStory& story, const RecordingHeader& header, const fs::path& file) {
  RawlogWriter rawlog(file, header, RawlogReader(story.recording).next().value().time);
  for (std::size_t i = 0; i < story.images.posed.size(); ++i) {
    const PosedImage& posed = story.images.posed[i];
    const UncertainPose T_camera_panel = T_camera_panelOf(posed, story.panels[posed.panel]);
    PanelSample panel{posed.T_robot_camera, {{static_cast<int>(posed.panel), T_camera_panel}}};
    PanelSample handles{posed.T_robot_camera, {}};
    for (const HandleSight& sight : story.recorded) {
      if (sight.image != i || !sight.confident) continue;
      Handle handle = story.panels[sight.panel].handles[sight.handle];
      handle.angle_rad = sight.angle_rad;
      const LinkedPose seen = composed(T_camera_panel.pose, handle.T_panel_handle());
      Matrix6d own = Matrix6d::Zero();
      own(5, 5) = sight.sigma_rad * sight.sigma_rad;
      handles.panels.push_back(
          {static_cast<int>(sight.handle),
           {seen.pose, seen.wrt_first * T_camera_panel.covariance * seen.wrt_first.transpose() + own}});
    }
    rawlog.write({posed.time, labels::kPanel, panel});
    if (!handles.panels.empty()) rawlog.write({posed.time, labels::kHandles, handles});
  }
  rawlog.finish();
}

KnownWorld readWorld(const HandlesStory& story, const HandlesOptions& options) {
  KnownWorld world{readVehicle(story.vehicle),
                   readPanelMaps(story.map),
                   readEnvironment(shippedFile(options.water)),
                   {},
                   seaFloorOf(options.recording)};
  if (!world.vehicle.camera) throw Error(story.vehicle, "camera", "the vehicle has none");
  if (std::all_of(world.panels.begin(), world.panels.end(),
                  [](const PanelMap& map) { return map.handles.empty(); }))
    throw Error(story.map, "handles", "there are none");
  return world;
}

/// The same panels, with their true angles.
std::vector<PanelMap> readTruth(const std::string& file, const std::vector<PanelMap>& panels) {
  std::vector<PanelMap> truth = readPanelMaps(file);
  if (truth.size() != panels.size()) throw Error(file, "", "has other panels");
  for (std::size_t i = 0; i < panels.size(); ++i)
    if (truth[i].handles.size() != panels[i].handles.size()) throw Error(file, "handles", "has others");
  return truth;
}

void readHandles(const HandlesOptions& options, const RunContext& context) {
  HandlesStory story;
  story.run = {.command_line = context.command_line, .seed = options.seed};
  story.recording = options.recording;
  story.water = options.water;
  story.truth = options.truth;
  story.window = options.window;
  RecordingHeader header = RawlogReader(options.recording).header();
  story.vehicle = neededVehicleFile(options.vehicle, options.recording, header);
  story.map = neededPanelMapFile(options.map, options.recording, header);
  KnownWorld world = readWorld(story, options);
  if (!options.truth.empty()) story.true_panels = readTruth(options.truth, world.panels);
  const DetectionSettings detection = settingsFor(world.panels);
  if (detection.families.empty()) throw Error(story.map, "markers", "there are none");
  story.images = posedImages(options.recording, world.vehicle, world.panels, detection);
  story.remarks = story.images.remarks;
  const auto is_left_out = [&](const auto& image) { return image.number % options.every != 0; };
  std::erase_if(story.images.posed, is_left_out);
  std::erase_if(story.images.unposed, is_left_out);
  if (story.images.posed.empty()) throw Error(options.recording, "", "no image shows where the panel is");

  const fs::path folder = options.folder;
  const std::vector<PanelMap> as_mapped = world.panels;
  EvidenceFolder evidence(folder / "evidence", as_mapped);
  SeeHandles see;
  if (!options.no_pictures)
    see = [&](const PosedImage& posed, const cv::Mat& image, const std::vector<HandleReading>& readings) {
      evidence.add(posed, image, readings);
    };
  story.recorded = recordedHandles(story.images, world, options.window, see);
  story.states = statesOf(story.recorded, world.panels);
  for (const HandleState& state : story.states)
    if (state.confident > 0) world.panels[state.panel].handles[state.handle].angle_rad = state.angle_rad;
  story.panels = world.panels;
  if (!options.no_simulation) {
    const PairMaker maker(world, {.seed = options.seed}, detection);
    story.simulated = simulatedHandles(story.images, maker, options.window);
  }
  story.pictures = evidence.telling();
  writeOutputs(story, as_mapped, folder);
  const fs::path map = writeMaps(story, folder / "panel");
  const fs::path results = folder / (fs::path(options.recording).stem().string() + "_results.rawlog");
  header.panel_map = fs::relative(map, folder).string();
  writeResultsLog(story, header, results);

  for (const std::string& remark : story.remarks) std::cout << remark << "\n";
  std::cout << formatTable(stateTable(story, as_mapped));
  if (const Table unread = unreadTable(story); !unread.rows.empty()) std::cout << "\n" << formatTable(unread);
  std::cout << "\nreport: " << (folder / "report.html").string() << "\nresults: " << results.string()
            << "\nmap with these angles: " << map.string() << "\n";
}

}  // namespace

void addHandles(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "handles", "Read the angles of the panel's handles in a recording's images (task T_H)");
  command->footer(
      "For every image whose markers tell where the panel is, every handle of the map is read twice. By the\n"
      "paper's chain: box of the handle -> region of interest, turned to the front -> active contour led by "
      "a\n"
      "superellipse -> Canny -> Hough -> the most prominent straight edge. And by rendering it at candidate "
      "angles\n"
      "through the given water and matching the image. The match's angle is stated, with a sigma; where the "
      "two\n"
      "contradict each other that is said. No angle is stated of a handle that is out of view, hidden, in an "
      "image\n"
      "that is saturated or black, or that matches no angle better than others.\n"
      "\n"
      "Angles are averaged over the last --window images, and over all. Writes handles.csv, result.json,\n"
      "report.html, NAME_results.rawlog (PANEL, HANDLES), panel/ (the map with these angles: `fathom map "
      "show`\n"
      "renders it), and evidence/, a picture an image. Then the images are simulated from where they were "
      "taken,\n"
      "with these angles, and read likewise.\n"
      "\n"
      "Examples:\n"
      "  fathom handles rawlogs/trial/trial.rawlog --water config/water_turbid.yaml --every 10 --out "
      "out/handles\n"
      "  fathom map show out/handles/panel/panel.yaml");
  const auto options = std::make_shared<HandlesOptions>();
  command->add_option("RECORDING", options->recording, "The recording, with images")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where results go")->required()->type_name(values::kFolder);
  command->add_option("--water", options->water, "Daylight and water of the images (`fathom fit-water`)")
      ->type_name(values::kYaml)
      ->capture_default_str();
  command->add_option("--truth", options->truth, "A map with the handles' true angles, to compare with")
      ->type_name(values::kYaml);
  command->add_option("--window", options->window, "Images of the moving average")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--every", options->every, "Of the images only every so-manyth")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the noise in simulated images")->capture_default_str();
  command->add_flag("--no-pictures", options->no_pictures, "Leave evidence/ out");
  command->add_flag("--no-simulation", options->no_simulation, "Do not read simulated images as well");
  command->add_option("--map", options->map, "Panel map; without it, the recording's own")
      ->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Vehicle file; without it, the recording's own")
      ->type_name(values::kYaml);
  command->callback([options, &context] { readHandles(*options, context); });
}

}  // namespace fathom
