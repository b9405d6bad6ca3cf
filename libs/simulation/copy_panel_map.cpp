#include "simulation/copy_panel_map.h"

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "panel/panel_map.h"

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

void requireBelow(const fs::path& relative, const fs::path& map_file) {
  const bool goes_up = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (relative.is_absolute() || goes_up)
    throw Error(map_file.string(), "mesh",
                "cannot be copied with the recording: " + relative.string() +
                    " does not lie in the map's folder or below");
}

}  // namespace

fs::path copyPanelMap(const fs::path& map_file, const fs::path& folder) {
  const fs::path from = map_file.parent_path(), mesh = readPanelMap(map_file).mesh_file;
  const std::string obj = readTextFile(from / mesh);
  std::vector<fs::path> files{map_file.filename(), mesh};
  for (const std::string& material : materialFiles(obj)) files.push_back(mesh.parent_path() / material);
  for (const fs::path& file : files) requireBelow(file, map_file);
  for (const fs::path& file : files) writeTextFile(folder / file, readTextFile(from / file));
  return folder / files.front();
}

}  // namespace fathom
