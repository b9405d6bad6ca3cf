#include <iostream>
#include <memory>
#include <set>
#include <stdexcept>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/files.h"
#include "evaluation/contact_sheet.h"
#include "evaluation/fiducial_sheet.h"
#include "image_files/encode_image.h"
#include "inputs/known_effects.h"
#include "reports/fiducial_report.h"
#include "reports/recorded_fiducials_report.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct CompareOptions {
  std::string recording, map, vehicle, grid, calibration, folder;
  double at_s = 0;
  std::vector<std::string> families, backends, preprocessings;
  std::optional<std::uint64_t> seed;
  std::optional<int> repeats;
};

template <class Kind>
std::vector<Kind> kindsNamed(const std::string& option, const std::vector<std::string>& names,
                             Kind (*named)(const std::string&)) {
  std::vector<Kind> kinds;
  for (const auto& name : names) try {
      kinds.push_back(named(name));
      if (std::count(kinds.begin(), kinds.end(), kinds.back()) > 1)
        throw std::invalid_argument("is there twice");
    } catch (const std::invalid_argument& refused) {
      throw Error(option, name, refused.what());
    }
  return kinds;
}

void checkFamilies(const std::vector<std::string>& families, const std::vector<Backend>& backends) {
  if (const auto why = complaintAbout(families, backends); !why.empty())
    throw Error("command line", "--family", why);
}

void sayWhere(const fs::path& folder) {
  std::cout << "\nreport: " << (folder / "report.html").string()
            << "\nimages: " << (folder / "contact_sheet.png").string() << "\n";
}

// ---- a grid of conditions

FiducialGrid gridOf(const CompareOptions& options) {
  FiducialGrid grid = options.grid.empty() ? FiducialGrid{} : readFiducialGrid(options.grid);
  if (!options.families.empty()) grid.families = options.families;
  if (!options.backends.empty()) grid.backends = kindsNamed("--backend", options.backends, backendNamed);
  if (!options.preprocessings.empty())
    grid.preprocessings = kindsNamed("--preprocess", options.preprocessings, preprocessNamed);
  grid.seed = options.seed.value_or(grid.seed);
  grid.repeats = options.repeats.value_or(grid.repeats);
  checkFamilies(grid.families, grid.backends);
  return grid;
}

void compareOnGrid(const CompareOptions& options, const RunContext& context) {
  if (options.map.empty() || options.vehicle.empty())
    throw Error("command line", options.map.empty() ? "--map" : "--vehicle",
                "is needed: images are made of a panel, with a vehicle's camera");
  FiducialStory story{{.command_line = context.command_line}, options.map, options.vehicle, gridOf(options),
                      readKnownEffects(options.calibration),  {}};
  story.grid.effects = story.known.effects;
  story.grid.t_s = options.at_s;
  story.run.seed = story.grid.seed;
  const PanelMap map = readPanelMap(options.map);
  if (map.markers.empty()) throw Error(options.map, "markers", "there are none");
  const Vehicle vehicle = readVehicle(options.vehicle);
  if (!vehicle.camera) throw Error(options.vehicle, "camera", "the vehicle has none");

  const fs::path folder = options.folder;
  story.results = compareFiducials(story.grid, map, vehicle, folder / "chunks");
  writeTextFile(folder / "contact_sheet.png", pngBytes(fiducialSheet(story.grid, map, vehicle)));
  writeOutputs(story, folder);
  if (story.known.given()) std::cout << story.known.inWords() << "\n";
  std::cout << story.grid.imageCount() << " images\n\n"
            << formatTable(overallTable(story)) << "\n"
            << formatTable(waterTable(story));
  sayWhere(folder);
}

// ---- a recording

/// The map with the families searched for only.
std::shared_ptr<PanelMap> mapOf(const CompareOptions& options, const RawlogReader& reader) {
  const auto file = panelMapFile(options.map, options.recording, reader.header());
  if (!file) return nullptr;
  auto map = std::make_shared<PanelMap>(readPanelMap(*file));
  if (!options.families.empty())
    std::erase_if(map->markers, [&](const Marker& marker) {
      return std::count(options.families.begin(), options.families.end(), marker.family) == 0;
    });
  return map;
}

RecordedFiducialsOptions searchOf(const CompareOptions& options, std::shared_ptr<const PanelMap> map) {
  RecordedFiducialsOptions search;
  search.map = std::move(map);
  std::set<std::string> families(options.families.begin(), options.families.end());
  if (families.empty() && search.map)
    for (const Marker& marker : search.map->markers) families.insert(marker.family);
  if (families.empty())
    throw Error("command line", "--family", "is needed: neither --map nor the recording names a panel map");
  search.families.assign(families.begin(), families.end());
  const auto backends = options.backends.empty() ? std::vector<Backend>(kBackends.begin(), kBackends.end())
                                                 : kindsNamed("--backend", options.backends, backendNamed);
  checkFamilies(search.families, backends);
  search.readers = readersOf(
      backends, options.preprocessings.empty()
                    ? std::vector<Preprocess>{Preprocess::none, Preprocess::stretch, Preprocess::clahe}
                    : kindsNamed("--preprocess", options.preprocessings, preprocessNamed));
  return search;
}

/// Some images of the recording, evenly spread.
cv::Mat recordingSheet(const std::vector<RecordedImage>& images, const RecordedFiducialsOptions& search) {
  const std::size_t columns = std::min<std::size_t>(6, images.size());
  std::vector<RecordedImage> some;
  std::vector<std::string> labels;
  for (std::size_t c = 0; c < columns; ++c) {
    some.push_back(images[(2 * c + 1) * images.size() / (2 * columns)]);
    labels.push_back(some.back().file.filename().string());
  }
  const auto pictures = recordedPictures(some, search);
  std::vector<SheetRow> rows;
  for (std::size_t reader = 0; reader < search.readers.size(); ++reader) {
    SheetRow row{{search.readers[reader].name()}, {}};
    for (const RecordedPicture& picture : pictures)
      row.tiles.push_back(markedTile(picture.image, picture.detections[reader],
                                     picture.places ? &*picture.places : nullptr, search.match_px));
    rows.push_back(row);
  }
  const bool truth = !pictures.empty() && pictures.front().places;
  return contactSheet(truth ? "green: found, orange: missed, red: false" : "blue: detected", labels, rows);
}

void compareOnRecording(const CompareOptions& options, const RunContext& context) {
  RawlogReader reader(options.recording);
  RecordedFiducialsStory story;
  story.run.command_line = context.command_line;
  story.recording = options.recording;
  const auto map = mapOf(options, reader);
  story.options = searchOf(options, map);
  const auto images = recordedImages(reader);
  story.loss = reader.loss();
  if (images.empty()) throw Error(options.recording, "", "has no images");

  const fs::path folder = options.folder;
  story.results = readRecordedFiducials(images, story.options, folder / "chunks");
  writeTextFile(folder / "contact_sheet.png", pngBytes(recordingSheet(images, story.options)));
  writeOutputs(story, folder);
  if (story.loss) std::cout << "the recording is damaged: " << describe(*story.loss) << "\n";
  std::cout << formatTable(readerTable(story)) << "\n" << formatTable(agreementTable(story));
  sayWhere(folder);
}

CLI::Option* addList(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                     const std::string& help) {
  return command.add_option(name, values, help)
      ->delimiter(',')
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
}

constexpr const char* kCompareHelp =
    "Prints the panel with each family's markers at the same size in the same places, makes images of it "
    "from\n"
    "the same views through several waters and blurs by the simulator's forward model, and has each library\n"
    "read them. Writes results.csv (detection rate, false detections, corner and pose errors, one line a\n"
    "condition), times.csv (measured), result.json, report.html and contact_sheet.png. The same seed gives "
    "the\n"
    "same results. Interrupted and started again, the same command goes on with what it has.\n"
    "\n";

constexpr const char* kCompareMoreHelp =
    "Markers count as found where they truly show; with --recording, where the nominal camera has them.\n"
    "\n"
    "With --recording the libraries read a recording's images instead, after each preprocessing: where it "
    "has\n"
    "truth and a panel map, how many of the markers that should show; else how many, and whether they "
    "agree.\n"
    "\n"
    "Examples:\n"
    "  fathom compare-fiducials --map maps/dexrov/panel.yaml --vehicle config/rov.yaml --out out/fiducials\n"
    "  fathom compare-fiducials --map maps/dexrov/panel.yaml --vehicle config/rov.yaml\n"
    "      --family tag36h11,DICT_4X4_50 --preprocess none,clahe --repeats 1 --out out/fiducials\n"
    "  fathom compare-fiducials --map maps/dexrov/panel.yaml --vehicle config/rov.yaml\n"
    "      --calibration out/dive/calibration.yaml --out out/fiducials\n"
    "  fathom compare-fiducials --recording out/survey/survey.rawlog --out out/readers";

}  // namespace

void addCompareFiducials(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "compare-fiducials", "Which markers, read by which library, are found under water, and how well");
  command->footer(kCompareHelp + std::string(kEffectsInViews) + kCompareMoreHelp);
  const auto options = std::make_shared<CompareOptions>();
  auto* recording = command->add_option("--recording", options->recording, "Read this recording's images")
                        ->type_name(values::kRawlog);
  command
      ->add_option("--map", options->map,
                   "The panel (with --recording: default the one its first comment names)")
      ->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Whose camera sees the panel")
      ->type_name(values::kYaml)
      ->excludes(recording);
  command
      ->add_option("--grid", options->grid,
                   "What is varied (default: as config/compare_fiducials.yaml has it)")
      ->type_name(values::kYaml)
      ->excludes(recording);
  auto* calibration =
      addCalibrationOption(*command, options->calibration, "Effects that the images are to have")
          ->excludes(recording);
  addTimeOption(*command, options->at_s, calibration);
  command->add_option("--out", options->folder, "Where results go")->required()->type_name(values::kFolder);
  addList(*command, "--family", options->families,
          "Marker families, separated by commas (with --recording: default the map's)");
  addList(*command, "--backend", options->backends, "Libraries (default: all)")
      ->check(CLI::IsMember(backendNames()));
  addList(*command, "--preprocess", options->preprocessings,
          "Before the search: none, stretch, clahe (default: none; with --recording all)");
  command->add_option("--seed", options->seed, "Of views and noise (default: the grid's)")
      ->excludes(recording);
  command->add_option("--repeats", options->repeats, "Views of each range and tilt (default: the grid's)")
      ->check(CLI::Range(1, 1000))
      ->excludes(recording);
  command->callback([options, &context] {
    options->recording.empty() ? compareOnGrid(*options, context) : compareOnRecording(*options, context);
  });
}

}  // namespace fathom
