#include "panel/panel_maps.h"

#include "core/yaml.h"
#include "panel/face.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPanels = "panels";

void checkApart(const YamlMap& list, const PanelMap& panel, const PanelMap& other) {
  if (panel.name == other.name) throw list.error(kPanels, "two panels are called `" + panel.name + "`");
  if (!panel.markers.empty() && !other.markers.empty() && panel.look() != other.look())
    throw list.error(kPanels, other.name + " and " + panel.name + " have another marker_look each");
  const std::string both = other.name + " and " + panel.name + " both have ";
  for (const Marker& marker : panel.markers)
    for (const Marker& twin : other.markers) {
      if (marker.family == twin.family && marker.id == twin.id)
        throw list.error(kPanels, "panels " + both + nameOf(marker));
      if (lookAlike(marker, twin))
        throw list.error(kPanels, nameOf(marker) + " of panel " + panel.name + " looks the same as " +
                                      nameOf(twin) + " of panel " + other.name);
    }
}

std::vector<fs::path> filesIn(const YamlFile& yaml, const fs::path& file) {
  const YamlMap& list = yaml.root();
  const auto names = list.texts(kPanels);
  yaml.rejectUnknownKeys();
  if (names.empty()) throw list.error(kPanels, "names no panel");
  std::vector<fs::path> files;
  for (const std::string& name : names) {
    if (fs::path(name).is_absolute()) throw list.error(kPanels, name + " must be relative to this file");
    files.push_back(file.parent_path() / name);
  }
  return files;
}

}  // namespace

std::vector<fs::path> panelMapFiles(const fs::path& file) {
  const YamlFile yaml(file);
  return yaml.root().has(kPanels) ? filesIn(yaml, file) : std::vector<fs::path>{file};
}

std::vector<PanelMap> readPanelMaps(const fs::path& file) {
  const YamlFile yaml(file);
  if (!yaml.root().has(kPanels)) return {readPanelMap(file)};
  std::vector<PanelMap> panels;
  for (const fs::path& panel_file : filesIn(yaml, file)) {
    panels.push_back(readPanelMap(panel_file));
    for (std::size_t i = 0; i + 1 < panels.size(); ++i) checkApart(yaml.root(), panels.back(), panels[i]);
  }
  return panels;
}

}  // namespace fathom
