#pragma once

#include <string>

#include "core/files.h"
#include "sensors/vehicle.h"
#include "support/panels.h"

namespace fathom::test {

/// The shipped vehicle with a camera of 320 x 240 px, as a file; its path.
inline std::filesystem::path writeSmallVehicle(const std::filesystem::path& folder) {
  std::string text = readTextFile(std::string(FATHOM_SOURCE_DIR) + "/config/rov.yaml");
  for (const auto& [what, by] : {std::pair("width_px: 640", "width_px: 320"),
                                 {"height_px: 480", "height_px: 240"},
                                 {"555.1962", "277.6"},
                                 {"555.2854", "277.6"},
                                 {"321.1975", "160.3"},
                                 {"244.7355", "122.1"}})
    text = with(text, what, by);
  writeNew(folder / "vehicle.yaml", text);
  return folder / "vehicle.yaml";
}

/// The shipped vehicle without a camera, with an INS of 50 Hz that gives an attitude.
inline Vehicle blindVehicle() {
  Vehicle vehicle = readVehicle(std::filesystem::path(FATHOM_SOURCE_DIR) / "config/rov.yaml");
  vehicle.camera.reset();
  vehicle.ins->rate_hz = 50;
  vehicle.ins->attitude_sigma = radians(0.5);
  return vehicle;
}

}  // namespace fathom::test
