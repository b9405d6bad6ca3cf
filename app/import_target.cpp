#include "import_target.h"

#include <iostream>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/text.h"
#include "imaging/camera_files.h"

namespace fathom {

void sayWritten(const ImportTarget& target, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) std::cout << "wrote " << target.file(ending).string() << "\n";
}

std::array<int, 2> timesOf(const std::string& option, const std::string& text) {
  const auto sides = numbersAround(text, 'x', 5);
  if (!sides) throw Error(option, text, "must be WIDTHxHEIGHT");
  return {static_cast<int>((*sides)[0]), static_cast<int>((*sides)[1])};
}

std::array<int, 2> imageSizeOf(const std::string& option, const std::string& text) {
  const std::array<int, 2> size = timesOf(option, text);
  if (!isImageSide(size[0]) || !isImageSide(size[1]))
    throw Error(option, text, print("sides must be from 1 to %d px", kLargestImageSide_px));
  return size;
}

Checkerboard checkerboardOf(const std::string& board, double square_m) {
  const auto [columns, rows] = timesOf("--board", board);
  if (columns < 2 || rows < 2) throw Error("--board", board, "must be 2x2 or more");
  if (!(square_m > 0)) throw Error("--square-m", "", "needed with --board, greater than zero");
  return {columns, rows, square_m};
}

void addImportTarget(CLI::App& command, ImportTarget& target, const std::string& default_name) {
  command.add_option("--out", target.folder, "Where the recording goes")
      ->required()
      ->type_name(values::kFolder);
  addNameOption(command, target.name, default_name);
}

}  // namespace fathom
