#include "evaluation/fiducial_sheet.h"

#include <algorithm>

#include "core/text.h"
#include "evaluation/contact_sheet.h"

namespace fathom {
namespace {

std::string labelOf(const FiducialGrid& grid, const GridImage& image) {
  return print("%g m, %g deg, ", grid.ranges_m[image.range], degrees(grid.tilts_rad[image.tilt])) +
         grid.waters[image.water].name + print(", blur %g px", grid.blurs_px[image.blur]);
}

/// Of the first family and repeat; none twice.
std::vector<GridImage> columnsOf(const FiducialGrid& grid) {
  const auto last = [](const auto& list) { return list.size() - 1; };
  const auto middle = [](const auto& list) { return (list.size() - 1) / 2; };
  const std::size_t mid = middle(grid.ranges_m);
  const std::vector<GridImage> wanted{
      {0, 0, 0, 0, 0, 0},
      {0, mid, 0, 0, 0, 0},
      {0, last(grid.ranges_m), 0, 0, 0, 0},
      {0, mid, last(grid.tilts_rad), 0, 0, 0},
      {0, mid, 0, 0, last(grid.waters), 0},
      {0, mid, 0, 0, 0, last(grid.blurs_px)},
      {0, mid, middle(grid.tilts_rad), 0, middle(grid.waters), middle(grid.blurs_px)}};
  std::vector<GridImage> columns;
  for (const GridImage& image : wanted)
    if (std::none_of(columns.begin(), columns.end(),
                     [&](const GridImage& other) { return labelOf(grid, other) == labelOf(grid, image); }))
      columns.push_back(image);
  return columns;
}

}  // namespace

cv::Mat fiducialSheet(const FiducialGrid& grid, const PanelMap& map, const Vehicle& vehicle) {
  const auto columns = columnsOf(grid);
  const auto readers = readersOf(grid.backends, grid.preprocessings);
  std::vector<GridImage> images;
  for (std::size_t family = 0; family < grid.families.size(); ++family)
    for (GridImage image : columns) {
      image.family = family;
      images.push_back(image);
    }
  const auto pictures = fiducialPictures(grid, map, vehicle, images);

  std::vector<SheetRow> rows;
  for (std::size_t family = 0; family < grid.families.size(); ++family)
    for (std::size_t reader = 0; reader < readers.size(); ++reader) {
      SheetRow row{{grid.families[family], readers[reader].name()}, {}};
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const FiducialPicture& picture = pictures[family * columns.size() + c];
        row.tiles.push_back(
            markedTile(picture.image_bgr, picture.detections[reader], &picture.places, grid.match_px));
      }
      rows.push_back(row);
    }
  std::vector<std::string> labels;
  labels.reserve(columns.size());
  for (const GridImage& image : columns) labels.push_back(labelOf(grid, image));
  return contactSheet("green: found, orange: missed, red: false", labels, rows);
}

}  // namespace fathom
