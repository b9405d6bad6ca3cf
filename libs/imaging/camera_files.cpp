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

/// `topic echo` ends each message with dashes: so many of them are looked at.
constexpr std::size_t kMostMessages = 100;

/// A file's documents, of which each keeps its lines' numbers. OpenCV begins with a directive of its own that
/// is no YAML.
std::vector<std::string> documentsOf(const std::filesystem::path& file) {
  std::istringstream lines(readTextFile(file));
  std::vector<std::string> documents(1);
  bool any = false;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    const bool is_end = line.starts_with("---") || line.starts_with("...");
    if (is_end && any) {
      if (documents.size() == kMostMessages) break;
      documents.emplace_back(number, '\n');
      any = false;
    }
    if (is_end || line.starts_with("%YAML")) line.clear();
    any = any || line.find_first_not_of(" \t\r") != std::string::npos;
    documents.back() += line + "\n";
  }
  if (!any && documents.size() > 1) documents.pop_back();
  return documents;
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
                                                             "dist_coeff",
                                                             "distortion_coeffs",
                                                             "D",
                                                             "d"};

/// A list, one of rows, or a matrix with its numbers under `data`.
std::vector<double> numbersOf(const YamlMap& y, const std::string& key) {
  if (y.isList(key)) return y.matrix(key);
  const YamlMap matrix = y.map(key);
  std::vector<double> data = matrix.numbers("data");
  if (matrix.has("rows") && matrix.has("cols") &&
      matrix.number("rows") * matrix.number("cols") != static_cast<double>(data.size()))
    throw y.error(key, print("says %.0f x %.0f, and has %zu numbers", matrix.number("rows"),
                             matrix.number("cols"), data.size()));
  return data;
}

/// The one of these keys that is there. Throws Error where two of them contradict each other.
std::optional<std::string> onlyKeyOf(const YamlMap& y, std::initializer_list<const char*> keys) {
  auto found = firstKeyOf(y, keys);
  for (const char* key : keys)
    if ((y.isList(key) || y.isMap(key)) && numbersOf(y, key) != numbersOf(y, *found))
      throw y.error(key, "has other numbers than " + *found + ", and both are there");
  return found;
}

/// Empty where the file says that there is none, as ROS does by an empty text too.
std::string distortionModelOf(const YamlMap& y) {
  if (!y.has("distortion_model") || y.isEmpty("distortion_model")) return "";
  const std::string model = y.text("distortion_model");
  return model == "none" ? "" : model;
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

/// The model is said to be none, and there are coefficients.
void refuseDistortion(const YamlMap& y, const std::string& key, const std::vector<double>& d) {
  if (!y.has("distortion_model") || !distortionModelOf(y).empty()) return;
  if (std::any_of(d.begin(), d.end(), [](double c) { return c != 0; }))
    throw y.error("distortion_model", "says that there is none, but there are coefficients under " + key);
}

/// A model is named, and no coefficient found: they stand under a key that nobody knows.
void demandDistortion(const YamlMap& y) {
  const std::string model = distortionModelOf(y);
  if (model.empty()) return;
  std::string known;
  for (const char* key : kDistortionKeys) known += (known.empty() ? "" : ", ") + std::string(key);
  throw y.error("distortion_model", "is " + model + ", but there are no coefficients under any of " + known);
}

/// Of a key that names a model: whether it is a fisheye's. Throws Error where it is none that is known.
bool namesFisheye(const YamlMap& y, const char* key, std::initializer_list<const char*> pinholes,
                  std::initializer_list<const char*> fisheyes) {
  if (!y.has(key) || y.isEmpty(key)) return false;
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
                         {"plumb_bob", "rational_polynomial", "radtan", "radial-tangential", "none"},
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
  if (std::all_of(K.begin(), K.end(), [](double k) { return k == 0; }))
    throw y.error(matrix, "is all zeros: ROS says so that the camera is not calibrated");
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

/// Of what is no part of the camera: the message's intrinsics are those of the full image.
std::vector<std::string> unappliedOf(const YamlMap& y) {
  const auto numberOf = [](const YamlMap& map, const char* key) {
    return map.has(key) ? map.number(key) : 0;
  };
  std::vector<std::string> remarks;
  if (const double x = numberOf(y, "binning_x"), by = numberOf(y, "binning_y"); x > 1 || by > 1)
    remarks.push_back(
        print("binning of %.0f x %.0f is not applied: the camera is that of the full image", x, by));
  if (!y.isMap("roi")) return remarks;
  const YamlMap roi = y.map("roi");
  const double width_px = numberOf(roi, "width"), height_px = numberOf(roi, "height"),
               x_px = numberOf(roi, "x_offset"), y_px = numberOf(roi, "y_offset");
  const bool is_full = width_px == numberOf(y, "width") && height_px == numberOf(y, "height");
  if ((width_px > 0 && height_px > 0 && !is_full) || x_px > 0 || y_px > 0)
    remarks.push_back(
        print("the region of interest, %.0f x %.0f px at (%.0f, %.0f), is not applied: the camera is "
              "that of the full image",
              width_px, height_px, x_px, y_px));
  return remarks;
}

CameraModel readCamera(const YamlMap& y, const CameraFileOptions& options) {
  const auto matrix = onlyKeyOf(y, kMatrixKeys);
  CameraModel camera = matrix ? readMatrices(y, *matrix, options) : readIntrinsics(y, options);
  camera.lens = lensOf(y);
  if (const auto key = onlyKeyOf(y, kDistortionKeys)) {
    const std::vector<double> d = numbersOf(y, *key);
    refuseDistortion(y, *key, d);
    setDistortion(y, *key, d, camera);
  } else {
    demandDistortion(y);
  }
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
  if (isCamera(root)) throw root.error("", "is one camera, without a name: leave --camera out");
  if (names.empty())
    throw root.error(
        "",
        "holds no camera: neither camera_matrix (OpenCV, ROS), K or k (camera_info) nor intrinsics (Kalibr)");
  throw root.error("", (wanted.empty() ? "holds several cameras, of which --camera names one: "
                                       : "has no camera " + wanted + "; there are ") +
                           all);
}

CameraFile readDocument(const std::string& text, const std::string& file, const CameraFileOptions& options) {
  const YamlFile yaml = YamlFile::parse(text, file);
  const YamlMap y = cameraOf(yaml.root(), options.camera);
  CameraFile read{readCamera(y, options), unappliedOf(y)};
  if (!firstKeyOf(y, kDistortionKeys))
    read.remarks.emplace_back("there are no distortion coefficients: the lens is taken to have none");
  for (std::string& doubt : doubtsAbout(read.camera)) read.remarks.push_back(std::move(doubt));
  return read;
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
  const std::vector<std::string> documents = documentsOf(file);
  CameraFile read = readDocument(documents.front(), file.string(), options);
  const auto isAnother = [&](const std::string& later) {
    try {
      return readDocument(later, file.string(), options).camera != read.camera;
    } catch (const Error& cut_short) {
      return false;
    }
  };
  if (std::any_of(documents.begin() + 1, documents.end(), isAnother))
    read.remarks.emplace_back(
        "the file has several messages, of which a later one has another camera: the first counts");
  return read;
}

}  // namespace fathom
