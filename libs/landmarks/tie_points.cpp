#include "landmarks/tie_points.h"

#include <algorithm>

#include "core/files.h"
#include "core/text.h"
#include "recording/csv.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

const std::vector<std::string> kPointColumns{"image",         "id",         "left_u_px",  "left_v_px",
                                             "left_sigma_px", "right_u_px", "right_v_px", "right_sigma_px"};

TiePoint pointOf(const TextTable& table, std::size_t row) {
  TiePoint point;
  point.id = table.wholeNumber(row, 1);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::size_t first = 2 + 3 * eye;
    point.pixels[eye] = {table.number(row, first), table.number(row, first + 1)};
    point.sigma_px[eye] = table.number(row, first + 2);
    if (!(point.sigma_px[eye] > 0)) throw table.error(row, "sigmas must be greater than zero");
  }
  return point;
}

}  // namespace

fs::path tiePointsBeside(const fs::path& rawlog) {
  return rawlog.parent_path() / (rawlog.stem().string() + "_points.csv");
}

void writeTiePoints(const fs::path& file, const TiePoints& points) {
  std::string text = headerLine(kPointColumns);
  for (const auto& [image, of_image] : points)
    for (const TiePoint& point : of_image) {
      text += "\n" + image + print(",%d", point.id);
      for (std::size_t eye = 0; eye < 2; ++eye)
        text += print(",%.9g,%.9g,%.9g", point.pixels[eye].x(), point.pixels[eye].y(), point.sigma_px[eye]);
    }
  writeTextFile(file, text + "\n");
}

TiePoints readTiePoints(const fs::path& file) {
  const TextTable table = readTable(file, kPointColumns);
  TiePoints points;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const TiePoint point = pointOf(table, row);
    std::vector<TiePoint>& of_image = points[table.rows[row][0]];
    if (std::any_of(of_image.begin(), of_image.end(),
                    [&](const TiePoint& other) { return other.id == point.id; }))
      throw table.error(row, "this point is in this image twice");
    of_image.push_back(point);
  }
  return points;
}

}  // namespace fathom
