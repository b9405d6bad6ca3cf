#include "core/shipped_file.h"

#include <cstdlib>
#include <sstream>
#include <vector>

#include "core/files.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// As the XDG Base Directory Specification has it.
std::string systemDataFolders() {
  const char* given = std::getenv("XDG_DATA_DIRS");
  return given != nullptr && *given != '\0' ? given : "/usr/local/share:/usr/share";
}

std::vector<fs::path> dataFolders() {
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  std::vector<fs::path> folders{program.parent_path().parent_path() / FATHOM_DATA_DIR};
  std::istringstream system(systemDataFolders());
  for (std::string folder; std::getline(system, folder, ':');)
    if (fs::path(folder).is_absolute()) folders.push_back(fs::path(folder) / "fathom");
  folders.emplace_back(FATHOM_SOURCE_DIR);
  return folders;
}

}  // namespace

fs::path shippedFile(const fs::path& file) {
  if (file.empty() || file.is_absolute() || isThere(file)) return file;
  for (const fs::path& folder : dataFolders())
    if (isThere(folder / file)) return folder / file;
  return file;
}

}  // namespace fathom
