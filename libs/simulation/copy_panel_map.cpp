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
  return by.parent_path() / file;
}

/// A map file and all that belongs to it, absolute and as named, the map first.
std::vector<fs::path> filesOf(const fs::path& map_file) {
  const fs::path map = fs::absolute(map_file).lexically_normal();
  std::vector<fs::path> files{map};
  for (const fs::path& panel : panelMapFiles(map)) {
    const fs::path mesh = named(panel, "mesh", readPanelMap(panel).mesh_file);
    files.insert(files.end(), {panel, mesh});
    for (const std::string& material : materialFiles(readTextFile(mesh)))
      files.push_back(named(mesh, "mtllib", material));
  }
  return files;
}

bool liesIn(const fs::path& folder, const fs::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

fs::path commonFolder(const std::vector<fs::path>& files) {
  fs::path common = files.front().parent_path();
  for (const fs::path& file : files)
    while (!liesIn(common, file.lexically_normal())) common = common.parent_path();
  return common;
}

/// Whether the way that a name leads never comes out of this folder. Then copies lead to copies; else they
/// lead to files elsewhere, the originals perhaps.
bool staysIn(const fs::path& folder, const fs::path& named) {
  fs::path way;
  bool inside = false;
  for (const fs::path& part : named) {
    if (part == ".." && way == way.root_path()) return false;
    way = part == ".." ? way.parent_path() : part == "." ? way : way / part;
    const bool now = liesIn(folder, way);
    if (inside && !now) return false;
    inside = now;
  }
  return true;
}

/// What is copied, absolute, and the folder that becomes the copy's.
struct Original {
  std::vector<fs::path> files;
  fs::path folder;
};

Original originalOf(const fs::path& map_file) {
  Original original{filesOf(map_file), {}};
  original.folder = commonFolder(original.files);
  for (fs::path& file : original.files) {
    if (!staysIn(original.folder, file))
      throw Error(map_file.string(), "",
                  "cannot be copied with the recording: " + file.string() + " leads out of the copy");
    file = file.lexically_normal();
  }
  return original;
}

}  // namespace

fs::path copyOfPanelMap(const fs::path& map_file, const fs::path& folder) {
  const Original original = originalOf(map_file);
  return folder / original.files.front().lexically_relative(original.folder);
}

fs::path copyPanelMap(const fs::path& map_file, const fs::path& folder) {
  const Original original = originalOf(map_file);
  for (const fs::path& file : original.files)
    writeTextFile(folder / file.lexically_relative(original.folder), readTextFile(file));
  return folder / original.files.front().lexically_relative(original.folder);
}

}  // namespace fathom
