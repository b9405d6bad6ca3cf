#include "tasks/companions.h"

#include <cmath>

#include "core/error.h"
#include "core/files.h"
#include "report/table.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

// Below what anyone can measure on a vehicle, above what text with a few decimals loses.
constexpr double kSamePosition_m = 1e-4;
constexpr double kSameAngle_rad = 1e-4;
constexpr double kSamePixel_px = 1e-3;
constexpr double kSameDistortion = 1e-6;

std::optional<fs::path> companion(const std::string& option, const std::string& named, const std::string& key,
                                  const fs::path& rawlog) {
  if (!option.empty()) return option;
  if (named.empty()) return std::nullopt;
  const fs::path file = rawlog.parent_path() / named;
  if (!isThere(file))
    throw Error(rawlog.string(), "[recording] " + key, "names " + file.string() + ", which is not there");
  return file;
}

std::string poseText(const Pose& pose) {
  const Vector3d angles = yawPitchRollFromRotation(pose.rotation);
  return fixed(pose.position.x(), 4) + " " + fixed(pose.position.y(), 4) + " " + fixed(pose.position.z(), 4) +
         " m, yaw pitch roll " + fixed(degrees(angles[0]), 3) + " " + fixed(degrees(angles[1]), 3) + " " +
         fixed(degrees(angles[2]), 3) + " deg";
}

struct Comparison {
  std::vector<std::string> lines;

  template <class Sheet>
  bool onBoard(const LabelInfo& label, const std::optional<Sheet>& sheet, const std::string& section) {
    if (!sheet) lines.push_back(label.label + ": recorded, but the vehicle file has no section " + section);
    return sheet.has_value();
  }

  void mounting(const LabelInfo& label, const Pose& sheet) {
    const Pose& recorded = label.mountings.front();
    const double offset_m = (recorded.position - sheet.position).norm();
    const double angle_rad = angleBetween(recorded.rotation, sheet.rotation);
    if (offset_m <= kSamePosition_m && angle_rad <= kSameAngle_rad) return;
    lines.push_back(label.label + ": mounted at " + poseText(recorded) + " in the recording, at " +
                    poseText(sheet) + " in the vehicle file: " + fixed(offset_m, 4) + " m and " +
                    fixed(degrees(angle_rad), 3) + " deg apart");
  }

  void intrinsics(const LabelInfo& label, const CameraSheet& sheet) {
    if (label.intrinsics.empty()) return;
    const CameraModel& recorded = label.intrinsics.front().model;
    const auto compare = [&](const char* name, double in_recording, double in_sheet, double tolerance) {
      if (std::abs(in_recording - in_sheet) <= tolerance) return;
      lines.push_back(label.label + ": " + name + " is " + fixed(in_recording, 6) + " in the recording, " +
                      fixed(in_sheet, 6) + " in the vehicle file");
    };
    compare("width_px", recorded.width_px, sheet.model.width_px, 0);
    compare("height_px", recorded.height_px, sheet.model.height_px, 0);
    compare("fx_px", recorded.fx_px, sheet.model.fx_px, kSamePixel_px);
    compare("fy_px", recorded.fy_px, sheet.model.fy_px, kSamePixel_px);
    compare("cx_px", recorded.cx_px, sheet.model.cx_px, kSamePixel_px);
    compare("cy_px", recorded.cy_px, sheet.model.cy_px, kSamePixel_px);
    if (recorded.lens != sheet.model.lens)
      lines.push_back(label.label + ": the lens is " + std::string(nameOf(recorded.lens)) +
                      " in the recording, " + std::string(nameOf(sheet.model.lens)) + " in the vehicle file");
    for (const LensCoefficient& c : coefficientsOf(sheet.model.lens))
      compare(c.name, recorded.*c.value, sheet.model.*c.value, kSameDistortion);
  }

  void beams(const LabelInfo& label, const std::vector<Pose>& sheet) {
    if (label.mountings.size() != sheet.size()) {
      lines.push_back(label.label + ": " + std::to_string(label.mountings.size()) +
                      " beams in the recording, " + std::to_string(sheet.size()) + " in the vehicle file");
      return;
    }
    for (std::size_t k = 0; k < label.mountings.size(); ++k) {
      // A beam has no roll of its own: only where it starts and where it points is compared.
      const Pose& recorded = label.mountings[k];
      const Pose& sheet_beam = sheet[k];
      const double offset_m = (recorded.position - sheet_beam.position).norm();
      const Vector3d x_recorded = recorded.rotation.col(0), x_sheet = sheet_beam.rotation.col(0);
      const double angle_rad = std::atan2(x_recorded.cross(x_sheet).norm(), x_recorded.dot(x_sheet));
      if (offset_m <= kSamePosition_m && angle_rad <= kSameAngle_rad) continue;
      lines.push_back(label.label + " " + std::to_string(k) + ": recording and vehicle file are " +
                      fixed(offset_m, 4) + " m and " + fixed(degrees(angle_rad), 3) + " deg apart");
    }
  }
};

fs::path needed(const std::optional<fs::path>& file, const fs::path& rawlog, const char* what,
                const char* option) {
  if (file) return *file;
  throw Error(rawlog.string(), "",
              std::string("names no ") + what + " in its first comment; give one with " + option);
}

}  // namespace

std::optional<fs::path> vehicleFile(const std::string& option, const fs::path& rawlog,
                                    const RecordingHeader& header) {
  return companion(option, header.vehicle, "vehicle", rawlog);
}

std::optional<fs::path> panelMapFile(const std::string& option, const fs::path& rawlog,
                                     const RecordingHeader& header) {
  return companion(option, header.panel_map, "panel_map", rawlog);
}

fs::path neededVehicleFile(const std::string& option, const fs::path& rawlog, const RecordingHeader& header) {
  return needed(vehicleFile(option, rawlog, header), rawlog, "vehicle file", "--vehicle");
}

fs::path neededPanelMapFile(const std::string& option, const fs::path& rawlog,
                            const RecordingHeader& header) {
  return needed(panelMapFile(option, rawlog, header), rawlog, "panel map", "--map");
}

std::vector<std::string> disagreements(const RecordingInfo& recording, const Vehicle& vehicle) {
  Comparison compare;
  for (const LabelInfo& label : recording.labels) {
    if (label.mountings.empty()) continue;
    forEachInstrument([&]<class Instrument>() {
      const auto instance = Instance::of(label.label, Instrument::label);
      if (!instance) return;
      const auto& sheet = vehicle.sensors(*instance).*Instrument::on_board;
      if (!compare.onBoard(label, sheet, instance->label(Instrument::section))) return;
      const std::vector<Pose> mountings = Instrument::mountings(*sheet);
      if constexpr (requires { Instrument::numbered; })
        compare.beams(label, mountings);
      else
        compare.mounting(label, mountings.front());
    });
    if (const auto instance = Instance::of(label.label, labels::kCamera)) {
      const auto& camera = vehicle.sensors(*instance).camera;
      if (!compare.onBoard(label, camera, instance->label("camera"))) continue;
      compare.mounting(label, camera->T_robot_camera);
      compare.intrinsics(label, *camera);
    }
  }
  return compare.lines;
}

}  // namespace fathom
