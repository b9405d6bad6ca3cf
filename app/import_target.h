#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

#include "camera_tables/board_corners.h"
#include "recording/imported.h"

namespace fathom {

/// Files of an import that were written, a line each, on the terminal.
void sayWritten(const ImportTarget& target, const std::vector<std::string>& endings);

/// "8x6" of an option's. Throws Error.
std::array<int, 2> timesOf(const std::string& option, const std::string& text);
/// "640x480", of an image. Throws Error.
std::array<int, 2> imageSizeOf(const std::string& option, const std::string& text);

/// --board and --square-m. Throws Error.
Checkerboard checkerboardOf(const std::string& board, double square_m);

/// --out and --name. `default_name`: what the name is where none is given, for --help.
void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name);

}  // namespace fathom
