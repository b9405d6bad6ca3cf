#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "commands.h"
#include "core/error.h"
#include "core/files.h"
#include "image_files/encode_image.h"
#include "panel/panel_maps.h"
#include "render/renderer.h"
#include "report/table.h"
#include "reports/panel_scene.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

// ---- check

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

Eigen::AlignedBox3f boundsOf(const Surface& surface) {
  Eigen::AlignedBox3f box;
  for (const auto& vertex : surface.vertices) box.extend(vertex.position);
  return box;
}

void printPose(const PanelMap& map) {
  const Vector3d& at = map.T_odom_panel.position;
  const Vector3d ypr = yawPitchRollFromRotation(map.T_odom_panel.rotation);
  std::cout << "  in odom    x " << fixed(at.x(), 3) << ", y " << fixed(at.y(), 3) << ", z "
            << fixed(at.z(), 3) << " m; yaw " << fixed(degrees(ypr[0]), 2) << ", pitch "
            << fixed(degrees(ypr[1]), 2) << ", roll " << fixed(degrees(ypr[2]), 2) << " deg; ";
  if (map.position_sigma_m == 0.0 && map.angle_sigma_rad == 0.0)
    std::cout << "known\n";
  else
    std::cout << "sigma " << fixed(map.position_sigma_m, 3) << " m, "
              << fixed(degrees(map.angle_sigma_rad), 2) << " deg\n";
}

void printMesh(const PanelMap& map) {
  const Eigen::Vector3f size = boundsOf(map.body).sizes();
  std::cout << "  mesh       " << map.mesh_file << ": " << fixed(size.x(), 3) << " x " << fixed(size.y(), 3)
            << " x " << fixed(size.z(), 3) << " m, " << map.body.triangles.size() << " triangles in "
            << map.components << " pieces (" << surfaceOf(map).triangles.size()
            << " with markers and handles)\n"
            << "  materials  " << joined(map.materials) << "\n";
}

void printMarkers(const PanelMap& map) {
  std::map<std::string, std::vector<int>> ids;
  for (const Marker& marker : map.markers) ids[marker.family].push_back(marker.id);
  std::cout << "  markers    " << map.markers.size() << "\n";
  for (auto& [family, list] : ids) {
    std::sort(list.begin(), list.end());
    std::cout << "    " << family << ":";
    for (const int id : list) std::cout << " " << id;
    std::cout << "\n";
  }
}

void printHandles(const PanelMap& map) {
  std::cout << "  handles    " << map.handles.size() << "\n";
  if (map.handles.empty()) return;
  Table table{{"    handle", "kind", "angle", "smallest", "largest"}};
  for (const Handle& h : map.handles)
    table.rows.push_back({"    " + h.id, std::string(nameOf(h.kind)), fixed(degrees(h.angle_rad), 1) + " deg",
                          fixed(degrees(h.smallest_angle_rad), 1) + " deg",
                          fixed(degrees(h.largest_angle_rad), 1) + " deg"});
  std::cout << formatTable(table);
}

void checkMaps(const std::vector<std::string>& files) {
  std::vector<std::vector<PanelMap>> maps;
  maps.reserve(files.size());
  for (const auto& file : files) maps.push_back(readPanelMaps(file));
  for (std::size_t i = 0; i < maps.size(); ++i)
    for (const PanelMap& panel : maps[i]) {
      std::cout << files[i] << ": panel " << panel.name << "\n";
      printPose(panel);
      printMesh(panel);
      printMarkers(panel);
      printHandles(panel);
    }
}

void addCheck(CLI::App& parent) {
  auto* command = parent.add_subcommand("check", "Read panel maps, and tell what is in them");
  command->footer(
      "Checks keys and values, the mesh (closed, not inside out, in metres), that markers are known and lie "
      "on\n"
      "the face, and that handles are within their range. One line says what is wrong, and where; exit "
      "status 2.\n"
      "\n"
      "Examples:\n"
      "  fathom map check maps/dexrov/panel.yaml\n"
      "  fathom map check maps/*/panel*.yaml");
  const auto files = std::make_shared<std::vector<std::string>>();
  command->add_option("FILE", *files, "Panel maps")->required()->type_name(values::kYaml);
  command->callback([files] { checkMaps(*files); });
}

// ---- show

struct ShowOptions {
  std::string map, folder;
  std::vector<std::string> states;
  std::vector<double> eye_panel{0.0, 0.0, 2.0};
};

/// The one panel that has the handle; the last where none has, which will say so.
PanelMap& panelWith(const std::string& handle, std::vector<PanelMap>& panels) {
  const auto has = [&](const PanelMap& panel) {
    return std::any_of(panel.handles.begin(), panel.handles.end(),
                       [&](const Handle& h) { return h.id == handle; });
  };
  if (std::count_if(panels.begin(), panels.end(), has) > 1)
    throw std::invalid_argument("several panels have a handle `" + handle + "`");
  const auto found = std::find_if(panels.begin(), panels.end(), has);
  return found == panels.end() ? panels.back() : *found;
}

/// `ID=ANGLE_DEG`
void setState(const std::string& state, std::vector<PanelMap>& panels) {
  const auto fail = [&state](const std::string& why) { return Error("command line", "--set " + state, why); };
  const auto equals = state.rfind('=');
  if (equals == std::string::npos) throw fail("must be ID=ANGLE_DEG");
  double angle_deg = 0.0;
  const char* end_of_text = state.data() + state.size();
  const auto [end, problem] = std::from_chars(state.data() + equals + 1, end_of_text, angle_deg);
  if (problem != std::errc() || end != end_of_text) throw fail("the angle must be a number of degrees");
  try {
    const std::string handle = state.substr(0, equals);
    panelWith(handle, panels).turnHandle(handle, radians(angle_deg));
  } catch (const std::invalid_argument& refused) {
    throw fail(refused.what());
  }
}

/// A camera at eye that looks at the panel's centre, upright where that can be.
Pose lookAtCentre_panel(const Vector3d& eye_panel) {
  Pose T_panel_camera;
  const Vector3d forward = -eye_panel.normalized();
  const bool along_y = forward.cross(Vector3d::UnitY()).norm() < 1e-6;
  const Vector3d up = along_y ? Vector3d(0, 0, -1) : Vector3d(0, 1, 0);
  const Vector3d right = forward.cross(up).normalized();
  T_panel_camera.rotation << right, forward.cross(right), forward;
  T_panel_camera.position = eye_panel;
  return T_panel_camera;
}

/// In clear water, by a lamp above the camera's left and some light from everywhere.
cv::Mat pictureOf(const std::vector<PanelMap>& panels, const Vector3d& eye_panel) {
  const CameraModel camera{
      .width_px = 1280, .height_px = 960, .fx_px = 1150, .fy_px = 1150, .cx_px = 639.5, .cy_px = 479.5};
  const Pose T_odom_camera = panels.front().T_odom_panel * lookAtCentre_panel(eye_panel);
  Spot lamp;
  const Matrix3d R_camera_lamp =
      rotationFromYawPitchRoll(0, -radians(90), 0);  // x of the lamp is z of the camera
  lamp.T_odom_lamp = T_odom_camera * Pose{R_camera_lamp, Vector3d(-0.5, -0.5, 0)};
  lamp.half_angle_rad = radians(80);
  lamp.irradiance_1m.setConstant(static_cast<float>(0.6 * eye_panel.squaredNorm()));
  Lighting light;
  light.ambient.setConstant(0.4f);
  light.spots.push_back(lamp);

  Renderer renderer(camera);
  Surface scene;
  for (const PanelMap& panel : panels) scene.add(surfaceOf(panel), panel.T_odom_panel);
  renderer.setScene(std::move(scene));
  return toDisplay(renderer.render(T_odom_camera, light).radiance);
}

/// A file name of what may be any text.
std::string fileName(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  return name;
}

void writeScene(const fs::path& target, const mrpt::opengl::COpenGLScene& scene) {
  PendingFile file(target);
  if (!scene.saveToFile(file.path().string())) throw Error(target.string(), "", "cannot be written");
  file.commit();
}

void showMap(const ShowOptions& options) {
  const Vector3d eye_panel(options.eye_panel.data());
  if (!eye_panel.allFinite() || eye_panel.norm() < 1e-3)
    throw Error("command line", "--camera", "must be away from the panel's centre, 0,0,0");
  auto panels = readPanelMaps(options.map);
  for (const auto& state : options.states) setState(state, panels);

  const std::string name = panels.size() == 1 ? panels.front().name : fs::path(options.map).stem().string();
  const fs::path base = fs::path(options.folder) / fileName(name);
  const fs::path scene_file = base.string() + ".3Dscene", picture_file = base.string() + ".png";
  writeScene(scene_file, panelScene(panels));
  writeTextFile(picture_file, pngBytes(pictureOf(panels, eye_panel)));
  std::cout << "wrote " << scene_file.string() << "\nwrote " << picture_file.string() << "\n";
}

void addShow(CLI::App& parent) {
  auto* command = parent.add_subcommand("show", "Draw a panel map, as a picture and as a 3D scene");
  command->footer(
      "Writes NAME.png, the panel in clear water, and NAME.3Dscene for MRPT's SceneViewer3D, with the frames "
      "and\n"
      "names of markers and handles. NAME is the panel's; of a list of panels, the file's.\n"
      "\n"
      "Examples:\n"
      "  fathom map show maps/dexrov/panel.yaml --out out\n"
      "  fathom map show maps/dexrov/panel.yaml --set A1=80 --set C1=270 --camera=-0.8,0.3,1.2 --out out\n"
      "  SceneViewer3D out/dexrov.3Dscene");
  const auto options = std::make_shared<ShowOptions>();
  command->add_option("FILE", options->map, "The panel map")->required()->type_name(values::kYaml);
  command->add_option("--out", options->folder, "Where the files go")->required()->type_name(values::kFolder);
  command
      ->add_option("--camera", options->eye_panel,
                   "Where the camera is, panel frame (x right, y up, z out of the face; the first panel's), "
                   "m; it looks at the "
                   "centre")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z")
      ->capture_default_str();
  command->add_option("--set", options->states, "Turn a handle first, ID=ANGLE_DEG; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("ID=ANGLE_DEG");
  command->callback([options] { showMap(*options); });
}

}  // namespace

void addMap(const RunContext& context) {
  auto* command = context.root->add_subcommand("map", "Check a panel map, or draw it");
  command->footer(
      "A panel map says where markers and handles are on a panel, and where the panel is; or it is a list "
      "of\n"
      "such files, `panels: [left.yaml, right.yaml]`.\n"
      "\n"
      "Examples:\n"
      "  fathom map check maps/dexrov/panel.yaml\n"
      "  fathom map show maps/dexrov/panel.yaml --out out");
  command->require_subcommand(1);
  addCheck(*command);
  addShow(*command);
}

}  // namespace fathom
