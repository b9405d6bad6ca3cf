#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/run_program.h"

/// Every command that writes files, on inputs so small that each takes seconds, and whose paths have blanks
/// and letters that ASCII lacks.
namespace fathom::test {

struct WritingCommand {
  std::string name;       ///< for gtest: letters only
  std::string arguments;  ///< all but --out
  std::string out_file;   ///< what --out names below the folder of results; empty: the folder itself
};
std::ostream& operator<<(std::ostream& out, const WritingCommand& command);

/// Their inputs are in inputFolder(), which must be asked for before they are run.
std::vector<WritingCommand> writingCommands();
/// The one of this name.
WritingCommand writingCommand(const std::string& name);

/// The inputs' folder: of this process, made at the first call. Removed at its end.
std::filesystem::path inputFolder();

/// As one would type it in the project's folder, whose config/ is looked up.
std::string commandLine(const WritingCommand& command, const std::filesystem::path& results);
ProgramResult run(const WritingCommand& command, const std::filesystem::path& results);

}  // namespace fathom::test
