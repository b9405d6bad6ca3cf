#include "imaging/camera_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/files.h"
#include "core/text.h"
#include "core/yaml.h"

namespace fathom {
namespace {

/// OpenCV begins with a directive of its own that is no YAML.
YamlFile readForeignYaml(const std::filesystem::path& file) {
  std::string text = readTextFile(file);
  if (text.starts_with("%YAML")) text.erase(0, text.find('\n'));
  return YamlFile::parse(text, file.string());
}

std::optional<std::string> firstKeyOf(const YamlMap& y, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (y.has(key)) return key;
  return {};
}

/// k1, k2, p1, p2 and perhaps more: k3, then what only a rational model has.
void setDistortion(const YamlMap& y, const std::string& key, const std::vector<double>& d,
                   CameraModel& camera) {
  if (d.size() < 4 && !d.empty()) throw y.error(key, "must be k1, k2, p1, p2 and perhaps k3");
  if (std::any_of(d.begin() + std::min<std::ptrdiff_t>(5, std::ssize(d)), d.end(),
                  [](double rational) { return rational != 0; }))
    throw y.error(key, "has more than plumb bob's five coefficients");
  if (!d.empty()) setPlumbBob(d, camera);
}

void rejectOtherModels(const YamlMap& y, const char* key, std::initializer_list<const char*> known) {
  if (!y.has(key)) return;
  const std::string model = y.text(key);
  if (std::find(known.begin(), known.end(), model) == known.end())
    throw y.error(key, model + " is no pinhole with plumb-bob distortion");
}

void setImageSize(const YamlMap& y, const std::string& key, double width_px, double height_px,
                  CameraModel& camera) {
  for (const double side_px : {width_px, height_px})
    if (!isImageSide(side_px))
      throw y.error(key, print("an image has sides of 1 to %d px", kLargestImageSide_px));
  camera.width_px = static_cast<int>(width_px);
  camera.height_px = static_cast<int>(height_px);
}

void setPinhole(const YamlMap& y, const std::string& key, const std::array<double, 4>& fx_fy_cx_cy,
                CameraModel& camera) {
  camera.fx_px = fx_fy_cx_cy[0];
  camera.fy_px = fx_fy_cx_cy[1];
  camera.cx_px = fx_fy_cx_cy[2];
  camera.cy_px = fx_fy_cx_cy[3];
  if (!(camera.fx_px > 0 && camera.fy_px > 0)) throw y.error(key, "focal lengths must be greater than zero");
}

CameraModel readKalibr(const YamlMap& y) {
  rejectOtherModels(y, "camera_model", {"pinhole"});
  rejectOtherModels(y, "distortion_model", {"radtan", "none"});
  CameraModel camera;
  const std::vector<double> f = y.numbers("intrinsics"), size = y.numbers("resolution");
  if (f.size() != 4) throw y.error("intrinsics", "must be fu, fv, pu, pv");
  if (size.size() != 2) throw y.error("resolution", "must be width, height");
  setPinhole(y, "intrinsics", {f[0], f[1], f[2], f[3]}, camera);
  setImageSize(y, "resolution", size[0], size[1], camera);
  if (y.has("distortion_coeffs"))
    setDistortion(y, "distortion_coeffs", y.numbers("distortion_coeffs"), camera);
  return camera;
}

/// OpenCV's and ROS's: matrices with their numbers under `data`.
CameraModel readMatrices(const YamlMap& y, const std::string& matrix) {
  rejectOtherModels(y, "distortion_model", {"plumb_bob", "rational_polynomial"});
  CameraModel camera;
  const std::vector<double> K = y.map(matrix).numbers("data");
  if (K.size() != 9) throw y.error(matrix, "must have 3 x 3 numbers");
  setPinhole(y, matrix, {K[0], K[4], K[2], K[5]}, camera);
  const auto width = firstKeyOf(y, {"image_width", "image_Width"}),
             height = firstKeyOf(y, {"image_height", "image_Height"});
  if (!width || !height) throw y.error("image_width", "missing");
  setImageSize(y, *width, y.number(*width), y.number(*height), camera);
  if (const auto d = firstKeyOf(y, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs"}))
    setDistortion(y, *d, y.map(*d).numbers("data"), camera);
  return camera;
}

}  // namespace

bool isImageSide(double side_px) {
  return side_px >= 1 && side_px <= kLargestImageSide_px && side_px == std::floor(side_px);
}

void setPlumbBob(const std::vector<double>& coefficients, CameraModel& camera) {
  camera.k1 = coefficients[0];
  camera.k2 = coefficients[1];
  camera.p1 = coefficients[2];
  camera.p2 = coefficients[3];
  if (coefficients.size() > 4) camera.k3 = coefficients[4];
}

CameraModel readCameraFile(const std::filesystem::path& file, const std::string& camera) {
  const YamlFile yaml = readForeignYaml(file);
  const YamlMap& root = yaml.root();
  if (root.has(camera)) return readKalibr(root.map(camera));
  if (const auto matrix = firstKeyOf(root, {"camera_matrix", "Camera_Matrix", "cameraMatrix"}))
    return readMatrices(root, *matrix);
  throw root.error("", "holds neither " + camera + " (Kalibr) nor camera_matrix (OpenCV, ROS camera_info)");
}

}  // namespace fathom
