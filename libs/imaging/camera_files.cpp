#include "imaging/camera_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/files.h"
#include "core/text.h"
#include "core/yaml.h"
#include "imaging/camera_check.h"

namespace fathom {
namespace {

/// OpenCV begins with a directive of its own that is no YAML; `topic echo` ends each message with dashes, of
/// which messages the first counts.
YamlFile readForeignYaml(const std::filesystem::path& file) {
  std::istringstream lines(readTextFile(file));
  std::string text;
  bool any = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_end = line.starts_with("---") || line.starts_with("...");
    if (is_end && any) break;
    if (is_end || line.starts_with("%YAML")) line.clear();  // lines keep their numbers
    any = any || line.find_first_not_of(" \t\r") != std::string::npos;
    text += line + "\n";
  }
  return YamlFile::parse(text, file.string());
}

std::optional<std::string> firstKeyOf(const YamlMap& y, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (y.has(key)) return key;
  return {};
}

constexpr std::initializer_list<const char*> kMatrixKeys{"camera_matrix", "Camera_Matrix", "cameraMatrix",
                                                         "K", "k"};
constexpr std::initializer_list<const char*> kDistortionKeys{"distortion_coefficients",
                                                             "Distortion_Coefficients",
                                                             "distCoeffs",
                                                             "dist_coeffs",
                                                             "distortion_coeffs",
                                                             "D",
                                                             "d"};

/// A list, or a matrix with its numbers under `data`.
std::vector<double> numbersOf(const YamlMap& y, const std::string& key) {
  return y.isList(key) ? y.numbers(key) : y.map(key).numbers("data");
}

/// Coefficients as OpenCV orders them, of the lens that the file says; of a plumb bob k3 may be left out, and
/// more than five are a rational model's, as in OpenCV.
void setDistortion(const YamlMap& y, const std::string& key, const std::vector<double>& d,
                   CameraModel& camera) {
  if (d.empty()) return;
  if (camera.lens == LensModel::fisheye) {
    if (d.size() != 4) throw y.error(key, "must be k1, k2, k3, k4 of a fisheye lens");
  } else {
    if (d.size() < 4) throw y.error(key, "must be k1, k2, p1, p2 and perhaps k3");
    const auto zeroFrom = [&](std::ptrdiff_t from) {
      return std::all_of(d.begin() + std::min(from, std::ssize(d)), d.end(), [](double c) { return c == 0; });
    };
    if (!zeroFrom(8)) throw y.error(key, "has more than the rational model's eight coefficients");
    camera.lens = zeroFrom(5) ? LensModel::plumb_bob : LensModel::rational;
  }
  setLens(d, camera);
}

/// A model is named, and no coefficient found: they stand under a key that nobody knows.
void demandDistortion(const YamlMap& y) {
  if (!y.has("distortion_model")) return;
  const std::string model = y.text("distortion_model");
  if (model.empty() || model == "none") return;
  std::string known;
  for (const char* key : kDistortionKeys) known += (known.empty() ? "" : ", ") + std::string(key);
  throw y.error("distortion_model", "is " + model + ", but there are no coefficients under any of " + known);
}

/// Of a key that names a model: whether it is a fisheye's. Throws Error where it is none that is known.
bool namesFisheye(const YamlMap& y, const char* key, std::initializer_list<const char*> pinholes,
                  std::initializer_list<const char*> fisheyes) {
  if (!y.has(key)) return false;
  const std::string model = y.text(key);
  if (std::find(fisheyes.begin(), fisheyes.end(), model) != fisheyes.end()) return true;
  if (std::find(pinholes.begin(), pinholes.end(), model) == pinholes.end())
    throw y.error(key, model + " is neither a pinhole with plumb-bob or rational distortion nor a fisheye");
  return false;
}

/// By each of the marks that programs leave.
LensModel lensOf(const YamlMap& y) {
  bool fisheye = y.has("fisheye_model") && y.number("fisheye_model") != 0;
  fisheye = namesFisheye(y, "model_type", {"PINHOLE", "pinhole"}, {"KANNALA_BRANDT"}) || fisheye;
  fisheye = namesFisheye(y, "camera_model", {"pinhole", "PINHOLE"}, {"fisheye"}) || fisheye;
  fisheye = namesFisheye(y, "distortion_model",
                         {"plumb_bob", "rational_polynomial", "radtan", "radial-tangential", "none", ""},
                         {"equidistant", "equi", "fisheye", "kannala_brandt"}) ||
            fisheye;
  return fisheye ? LensModel::fisheye : LensModel::plumb_bob;
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

/// Kalibr's.
CameraModel readIntrinsics(const YamlMap& y, const CameraFileOptions& options) {
  CameraModel camera;
  const std::vector<double> f = y.numbers("intrinsics");
  if (f.size() != 4) throw y.error("intrinsics", "must be fu, fv, pu, pv");
  setPinhole(y, "intrinsics", {f[0], f[1], f[2], f[3]}, camera);
  if (!options.image_size_px) {
    const std::vector<double> size = y.numbers("resolution");
    if (size.size() != 2) throw y.error("resolution", "must be width, height");
    setImageSize(y, "resolution", size[0], size[1], camera);
  }
  return camera;
}

/// OpenCV's and ROS's.
CameraModel readMatrices(const YamlMap& y, const std::string& matrix, const CameraFileOptions& options) {
  CameraModel camera;
  const std::vector<double> K = numbersOf(y, matrix);
  if (K.size() != 9) throw y.error(matrix, "must have 3 x 3 numbers");
  if (K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1)
    throw y.error(matrix, "must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  if (std::abs(K[1]) > 1e-4 * std::abs(K[0])) throw y.error(matrix, "has a skew, which the model has not");
  setPinhole(y, matrix, {K[0], K[4], K[2], K[5]}, camera);
  if (options.image_size_px) return camera;
  const auto width = firstKeyOf(y, {"image_width", "image_Width", "width"}),
             height = firstKeyOf(y, {"image_height", "image_Height", "height"});
  if (!width || !height) throw y.error("image_width", "missing; --image-size gives it");
  setImageSize(y, *width, y.number(*width), y.number(*height), camera);
  return camera;
}

bool isCamera(const YamlMap& y) { return y.has("intrinsics") || firstKeyOf(y, kMatrixKeys); }

CameraModel readCamera(const YamlMap& y, const CameraFileOptions& options) {
  const LensModel lens = lensOf(y);
  const auto matrix = firstKeyOf(y, kMatrixKeys);
  CameraModel camera = matrix ? readMatrices(y, *matrix, options) : readIntrinsics(y, options);
  camera.lens = lens;
  if (const auto d = firstKeyOf(y, kDistortionKeys))
    setDistortion(y, *d, numbersOf(y, *d), camera);
  else
    demandDistortion(y);
  if (options.image_size_px) {
    camera.width_px = (*options.image_size_px)[0];
    camera.height_px = (*options.image_size_px)[1];
  }
  return camera;
}

/// Names of the cameras of a file that holds several.
std::vector<std::string> camerasIn(const YamlMap& root) {
  std::vector<std::string> names;
  for (const std::string& key : root.keys())
    if (root.isMap(key) && isCamera(root.map(key))) names.push_back(key);
  return names;
}

YamlMap cameraOf(const YamlMap& root, const std::string& wanted) {
  const std::vector<std::string> names = camerasIn(root);
  const auto isThere = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (wanted.empty() && isCamera(root)) return root;
  if (wanted.empty() && names.size() == 1) return root.map(names.front());
  constexpr const char* kFirstOfCamchain = "cam0";
  const std::string name = wanted.empty() ? kFirstOfCamchain : wanted;
  if (isThere(name)) return root.map(name);
  std::string all;
  for (const std::string& one : names) all += (all.empty() ? "" : ", ") + one;
  if (names.empty())
    throw root.error(
        "",
        "holds no camera: neither camera_matrix (OpenCV, ROS), K or k (camera_info) nor intrinsics (Kalibr)");
  throw root.error("", (wanted.empty() ? "holds several cameras, of which --camera names one: "
                                       : "has no camera " + wanted + "; there are ") +
                           all);
}

}  // namespace

bool isImageSide(double side_px) {
  return side_px >= 1 && side_px <= kLargestImageSide_px && side_px == std::floor(side_px);
}

void setLens(const std::vector<double>& coefficients, CameraModel& camera) {
  const auto names = coefficientsOf(camera.lens);
  for (std::size_t i = 0; i < std::min(coefficients.size(), names.size()); ++i)
    camera.*names[i].value = coefficients[i];
}

CameraFile readCameraFile(const std::filesystem::path& file, const CameraFileOptions& options) {
  const YamlFile yaml = readForeignYaml(file);
  CameraFile read{readCamera(cameraOf(yaml.root(), options.camera), options), {}};
  read.remarks = doubtsAbout(read.camera);
  return read;
}

}  // namespace fathom
