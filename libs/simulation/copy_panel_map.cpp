#include "simulation/copy_panel_map.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/error.h"
#include "core/files.h"
#include "panel/panel_maps.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// The files named by `mtllib` lines of an OBJ, as written.
std::vector<std::string> materialFiles(const std::string& obj) {
  std::vector<std::string> files;
  std::istringstream lines(obj);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword, file;
    if (words >> keyword >> file && keyword == "mtllib") files.push_back(file);
  }
  return files;
}

/// The path of a file that another file names.
fs::path named(const fs::path& by, const std::string& key, const fs::path& file) {
  if (file.is_absolute())
    throw Error(by.string(), key, "cannot be copied with the recording: " + file.string() + " is absolute");
  return (by.parent_path() / file).lexically_normal();
}

/// A map file and all that belongs to it, absolute, the map first.
std::vector<fs::path> filesOf(const fs::path& map_file) {
  const fs::path map = fs::absolute(map_file).lexically_normal();
  std::vector<fs::path> files{map};
  for (const fs::path& panel_file : panelMapFiles(map)) {
    const fs::path panel = panel_file.lexically_normal();
    const fs::path mesh = named(panel, "mesh", readPanelMap(panel).mesh_file);
    files.insert(files.end(), {panel, mesh});
    for (const std::string& material : materialFiles(readTextFile(mesh)))
      files.push_back(named(mesh, "mtllib", material));
  }
  return files;
}

fs::path commonFolder(const std::vector<fs::path>& files) {
  fs::path common = files.front().parent_path();
  for (const fs::path& file : files)
    while (std::mismatch(common.begin(), common.end(), file.begin(), file.end()).first != common.end())
      common = common.parent_path();
  return common;
}

}  // namespace

fs::path copyOfPanelMap(const fs::path& map_file, const fs::path& folder) {
  const auto files = filesOf(map_file);
  return folder / files.front().lexically_relative(commonFolder(files));
}

fs::path copyPanelMap(const fs::path& map_file, const fs::path& folder) {
  const auto files = filesOf(map_file);
  const fs::path from = commonFolder(files);
  for (const fs::path& file : files)
    writeTextFile(folder / file.lexically_relative(from), readTextFile(file));
  return folder / files.front().lexically_relative(from);
}

}  // namespace fathom
