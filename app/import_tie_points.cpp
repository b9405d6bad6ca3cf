#include "import_tie_points.h"

#include <iostream>
#include <memory>

#include "camera_tables/import_tie_points.h"
#include "core/text.h"
#include "import_target.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct TiePointOptions {
  TiePointTable source;
  ImportTarget target;
};

void importTiePointsTo(TiePointOptions options, const RunContext& context) {
  ImportTarget& target = options.target;
  if (target.name.empty()) target.name = fs::path(options.source.table).stem().string();
  const TiePointImport found =
      importTiePoints(options.source, target, RunInfo{.command_line = context.command_line});
  const StereoRig& rig = found.rig;
  std::cout << print("%zu frames, %zu points seen by both cameras, once by each (%zu left out: twice)\n",
                     found.frames, found.points, found.ambiguous)
            << print(
                   "windows %.3f and %.3f m before the cameras, whose corners fit to %.1f and %.1f px: the "
                   "right camera is known to %.1f mm and %.2f degrees\n",
                   rig.cameras[0].window.distance_m, rig.cameras[1].window.distance_m, rig.corner_rms_px[0],
                   rig.corner_rms_px[1], 1000 * rig.position_sigma_m, degrees(rig.angle_sigma_rad));
  sayWritten(target, {".rawlog", "_points.csv", "_vehicle.yaml", "_import.json"});
}

}  // namespace

void addImportTiePoints(CLI::App& parent, const RunContext& context) {
  auto* command =
      parent.add_subcommand("tie-points", "From what two cameras see of the same points, without images");
  command->footer(
      "Reads camera,frame,id,u_px,v_px: what has the same frame and id is the same point (an id twice in a\n"
      "frame of one camera is left out). Each camera's file has fx_px, fy_px, cx_px, cy_px, distortion in\n"
      "OpenCV's order, and reference_corners, the corners {u_px, v_px, x_cm, y_cm, z_cm} of the window that\n"
      "it looks through, which say where it stands. Writes a recording of pairs without their images,\n"
      "pinholes for cameras, and NAME_points.csv, which `diagnose` and `smooth` take: lines of sight of one\n"
      "point should meet.\n"
      "\n"
      "Example:\n"
      "  fathom import tie-points detections.csv --left camera1.yaml --right camera2.yaml \\\n"
      "    --out out/two_view\n"
      "  fathom diagnose out/two_view/detections.rawlog --out out/two_view/diagnosis");
  const auto options = std::make_shared<TiePointOptions>();
  command->add_option("TABLE", options->source.table, "What was seen")->required()->type_name(values::kCsv);
  command->add_option("--left", options->source.left, "Camera 1")->required()->type_name(values::kYaml);
  command->add_option("--right", options->source.right, "Camera 2")->required()->type_name(values::kYaml);
  command
      ->add_option("--sigma-px", options->source.sigma_px,
                   "Of a coordinate of a point; of a corner, at least")
      ->check(positive())
      ->capture_default_str();
  addImportTarget(*command, options->target, "the table's");
  command->callback([options, &context] { importTiePointsTo(*options, context); });
}

}  // namespace fathom
