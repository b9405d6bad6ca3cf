#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace fathom {

/// How another program's run ended, and what it took.
struct ChildResult {
  int status = 0;  ///< exit status
  int signal = 0;  ///< that stopped it; 0: none did
  double wall_s = 0, cpu_s = 0;
  double peak_mb = 0;  ///< resident memory
};

/// Runs a program, found on the path where its name has no folder, with nothing to read; what it prints goes
/// to `log`. Asked to stop, it asks that program to, and waits for it. Throws Error where it cannot be
/// started; Interrupted.
ChildResult runChild(const std::vector<std::string>& words, const std::filesystem::path& log);

/// The programs that this thread starts from now on stay on one core, the so-manyth of those it may use: many
/// at a time are quicker than many threads in one.
void stayOnOneCore(std::size_t number);

/// The last line that is not empty of a text file, what programs complain with. Throws Error.
std::string lastLineOf(const std::filesystem::path& file);

}  // namespace fathom
