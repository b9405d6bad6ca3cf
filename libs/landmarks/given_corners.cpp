#include "landmarks/given_corners.h"

#include <algorithm>

#include "core/files.h"
#include "core/text.h"
#include "panel/marker_family.h"
#include "recording/csv.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

const std::vector<std::string> kColumns{"image", "family", "id",    "sigma_px", "x0_px", "y0_px",
                                        "x1_px", "y1_px",  "x2_px", "y2_px",    "x3_px", "y3_px"};
constexpr std::size_t kFirstCorner = 4;

Detection detectionOf(const TextTable& table, std::size_t row) {
  const std::string& family = table.rows[row][1];
  if (!isMarkerFamily(family)) throw table.error(row, "no such family: `" + family + "`");
  const double sigma_px = table.number(row, 3);
  if (!(sigma_px > 0)) throw table.error(row, "sigma_px must be greater than zero");
  std::array<Vector2d, 4> corners_px;
  for (std::size_t k = 0; k < 4; ++k)
    corners_px[k] = {table.number(row, kFirstCorner + 2 * k), table.number(row, kFirstCorner + 2 * k + 1)};
  return givenDetection(family, table.wholeNumber(row, 2), corners_px, sigma_px);
}

}  // namespace

Detection givenDetection(std::string family, int id, const std::array<Vector2d, 4>& corners_px,
                         double sigma_px) {
  Detection detection;
  detection.family = std::move(family);
  detection.id = id;
  detection.corners_px = corners_px;
  detection.covariance_px2 = sigma_px * sigma_px * Matrix8d::Identity();
  detection.refined = true;
  return detection;
}

fs::path cornersBeside(const fs::path& rawlog) {
  return rawlog.parent_path() / (rawlog.stem().string() + "_corners.csv");
}

void writeGivenCorners(const fs::path& file, const std::map<std::string, std::vector<Detection>>& by_image) {
  std::string text = headerLine(kColumns);
  for (const auto& [image, detections] : by_image)
    for (const Detection& detection : detections) {
      text += "\n" + image + "," + detection.family + print(",%d,%.9g", detection.id, detection.sigma_px());
      for (const Vector2d& corner : detection.corners_px) text += print(",%.9g,%.9g", corner.x(), corner.y());
    }
  writeTextFile(file, text + "\n");
}

Detections readGivenCorners(const fs::path& file, const fs::path& image_folder) {
  const TextTable table = readTable(file, kColumns);
  Detections detections;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    Detection detection = detectionOf(table, row);
    std::vector<Detection>& of_image = detections.by_file[image_folder / table.rows[row][0]];
    const bool twice = std::any_of(of_image.begin(), of_image.end(), [&](const Detection& other) {
      return other.id == detection.id && other.family == detection.family;
    });
    if (twice) throw table.error(row, "this marker is in this image twice");
    of_image.push_back(std::move(detection));
  }
  for (auto& [image, of_image] : detections.by_file) std::sort(of_image.begin(), of_image.end(), comesBefore);
  detections.kept_in = file;
  return detections;
}

}  // namespace fathom
