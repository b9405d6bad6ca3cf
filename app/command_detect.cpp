#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include "commands.h"
#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/text.h"
#include "fiducials/detector.h"
#include "image_files/image_file.h"
#include "panel/marker_family.h"
#include "sensors/vehicle.h"

namespace fathom {
namespace {

struct DetectOptions {
  std::vector<std::string> images, families;
  std::string backend = "apriltag", preprocess = "none", corners, vehicle, out;
  bool fallback = false;
  MarkerLook look;
};

Preprocess preprocessNamed(const std::string& name) {
  for (const Preprocess kind : {Preprocess::stretch, Preprocess::clahe})
    if (name == nameOf(kind)) return kind;
  return Preprocess::none;
}

bool refinesCorners(const DetectOptions& options, Backend backend) {
  return options.corners.empty() ? hasRoughCorners(backend) : options.corners == "fitted";
}

std::optional<CameraModel> cameraOf(const std::string& vehicle_file) {
  if (vehicle_file.empty()) return std::nullopt;
  const Vehicle vehicle = readVehicle(vehicle_file);
  if (!vehicle.camera) throw Error(vehicle_file, "camera", "the vehicle has none");
  return vehicle.camera->model;
}

void checkFamilies(const std::vector<std::string>& families, Backend backend, const MarkerLook& look) {
  for (const auto& family : families) {
    if (!isMarkerFamily(family))
      throw Error("--family", family,
                  "no such marker family; there are " + CLI::detail::join(markerFamilies(), ", "));
    if (!canRead(backend, family, look))
      throw Error("--family", family,
                  "the " + std::string(nameOf(backend)) + " backend cannot read it" +
                      (look.border_width == 1 ? "" : " with such a border"));
  }
}

std::unique_ptr<Detector> detectorFor(const DetectOptions& options,
                                      const std::optional<CameraModel>& camera) {
  const auto make = [&](Backend backend, const std::vector<std::string>& families) {
    DetectorOptions detector;
    detector.preprocess = preprocessNamed(options.preprocess);
    detector.refine = refinesCorners(options, backend);
    detector.camera = camera;
    detector.look = options.look;
    return makeDetector(backend, families, detector);
  };
  const Backend first = backendNamed(options.backend);
  checkFamilies(options.families, first, options.look);
  auto detector = make(first, options.families);
  if (!options.fallback) return detector;
  std::vector<std::string> readable = options.families;
  std::erase_if(readable,
                [&](const auto& family) { return !canRead(fallbackOf(first), family, options.look); });
  if (readable.empty()) return detector;
  return std::make_unique<FallbackDetector>(std::move(detector), make(fallbackOf(first), readable));
}

void checkSize(const std::string& file, const cv::Mat& image, const std::optional<CameraModel>& camera) {
  if (!camera || (image.cols == camera->width_px && image.rows == camera->height_px)) return;
  const auto size = [](int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
  };
  throw Error(file, "",
              "is of " + size(image.cols, image.rows) + " pixels, the vehicle's camera of " +
                  size(camera->width_px, camera->height_px));
}

void writeRow(const std::string& image, const Detection& detection, std::ostream& csv) {
  csv << csvField(image) << ',' << detection.id << std::fixed << std::setprecision(4);
  for (const Vector2d& corner : detection.corners_px) csv << ',' << corner.x() << ',' << corner.y();
  csv << ',' << detection.family << ',' << detection.sigma_px() << ',';
  if (detection.corrected_bits >= 0) csv << detection.corrected_bits;
  csv << ',';
  if (std::isfinite(detection.decision_margin)) csv << std::setprecision(1) << detection.decision_margin;
  csv << '\n';
}

/// What an empty table does not mean.
std::string lookedFor(const MarkerLook& look) {
  return print(
      "looked for %s ones whose border is %d cell%s wide, not for %s ones (%s) or other borders "
      "(--border-cells)",
      look.white_on_black ? "white" : "black", look.border_width, look.border_width == 1 ? "" : "s",
      look.white_on_black ? "black" : "white",
      look.white_on_black ? "without --white-on-black" : "--white-on-black");
}

void detect(const DetectOptions& options) {
  const auto camera = cameraOf(options.vehicle);
  const auto detector = detectorFor(options, camera);
  std::ostringstream csv;
  csv << "image,id,x0,y0,x1,y1,x2,y2,x3,y3,family,sigma_px,corrected_bits,decision_margin\n";
  Progress progress("detecting");
  std::size_t done = 0, found = 0;
  for (const auto& file : options.images) {
    const cv::Mat image = readImage(file);
    checkSize(file, image, camera);
    for (const Detection& detection : detector->detect(image)) writeRow(file, detection, csv), ++found;
    progress.update(static_cast<double>(++done) / static_cast<double>(options.images.size()));
  }
  if (found == 0) std::cerr << "fathom: no marker found; " << lookedFor(options.look) << "\n";
  if (options.out.empty())
    std::cout << csv.str();
  else
    writeTextFile(options.out, csv.str());
}

}  // namespace

void addDetect(const RunContext& context) {
  auto* command = context.root->add_subcommand("detect", "Find ArUco and AprilTag markers in images");
  command->footer(
      "Prints a CSV table: image, id, eight corner coordinates, then the family, the corners' sigma and how\n"
      "sure the code was read. Corners are the black border square's: top left, top right, bottom right, "
      "bottom\n"
      "left, as seen on the upright marker. Pixel (0, 0) is the centre of the image's top left pixel; add "
      "0.5\n"
      "to compare with AprilTag's own coordinates. Either backend reads the DICT_... families and tag16h5 "
      "to\n"
      "tag36h11; tagStandard..., tagCircle... and tagCustom... only apriltag.\n"
      "\n"
      "Examples:\n"
      "  fathom detect photo.jpg --family tag36h11\n"
      "  fathom detect dive_Images/*.png --family DICT_ARUCO_ORIGINAL,DICT_4X4_50 --backend aruco --out "
      "markers.csv\n"
      "  fathom detect turbid.png --family DICT_ARUCO_ORIGINAL --preprocess clahe --fallback");
  const auto options = std::make_shared<DetectOptions>();
  command->add_option("IMAGE", options->images, "PNG, JPEG or BMP images")
      ->required()
      ->type_name(values::kFile);
  command->add_option("--family", options->families, "Marker families, separated by commas")
      ->required()
      ->delimiter(',')
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--backend", options->backend, "Library that searches")
      ->check(CLI::IsMember(backendNames()))
      ->capture_default_str();
  command->add_option("--preprocess", options->preprocess, "Before the search: none, clahe or stretch")
      ->check(CLI::IsMember({"none", "clahe", "stretch"}))
      ->capture_default_str();
  command
      ->add_option("--corners", options->corners,
                   "fitted to the edges' pixels, or the library's own (default: library for apriltag, fitted "
                   "for aruco)")
      ->check(CLI::IsMember({"fitted", "library"}));
  command
      ->add_option("--border-cells", options->look.border_width,
                   "How wide the black border is: 1, or 2 as in Kalibr's grids of AprilTags")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command->add_flag("--white-on-black", options->look.white_on_black,
                    "Markers are engraved or cut out, white on black");
  command->add_flag("--fallback", options->fallback,
                    "Search images in which the backend finds nothing with the other one");
  command
      ->add_option("--vehicle", options->vehicle,
                   "Vehicle file: its camera's lens bends straight edges, account for it (fitted corners)")
      ->type_name(values::kYaml);
  command->add_option("--out", options->out, "Write the table here instead")->type_name(values::kFile);
  command->callback([options] { detect(*options); });
}

}  // namespace fathom
