#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/time.h"

namespace fathom {

/// Where an import goes: FOLDER/NAME.rawlog and its companions.
struct ImportTarget {
  std::filesystem::path folder;
  std::string name;

  std::filesystem::path file(const std::string& ending) const { return folder / (name + ending); }
};

/// Files of it that were written, a line each, on the terminal.
void sayWritten(const ImportTarget& target, const std::vector<std::string>& endings);

/// When a recording begins whose source has no time: 2000-01-01.
Time timelessBegin();
/// A vehicle file with nothing aboard but a camera, left of a pair perhaps. `what`: a comment.
std::string cameraAloneYaml(const std::string& what, const CameraModel& camera, double rate_hz,
                            double corner_sigma_px);

/// --out and --name. `default_name`: what the name is where none is given, for --help.
void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name);

}  // namespace fathom
