#include "recording/fields.h"

#include <array>

namespace fathom {
namespace {

using Values = std::vector<std::optional<double>>;

constexpr int kPoseSize = 6;
constexpr std::array<const char*, kPoseSize> kPoseNames{"x", "y", "z", "yaw", "pitch", "roll"};
constexpr std::array<const char*, kPoseSize> kPoseUnits{"m", "m", "m", "rad", "rad", "rad"};

void append(Values& values, const std::optional<Vector3d>& vector) {
  for (int i = 0; i < 3; ++i) values.push_back(vector ? std::optional((*vector)[i]) : std::nullopt);
}

void append(Values& values, const std::optional<Matrix3d>& rotation) {
  Eigen::Quaterniond q(Matrix3d::Identity());
  if (rotation) q = Eigen::Quaterniond(*rotation);
  for (int i = 0; i < 4; ++i) values.push_back(rotation ? std::optional(q.coeffs()[i]) : std::nullopt);
}

std::string covarianceName(const std::string& row_name, std::size_t row, const std::string& column_name,
                           std::size_t column) {
  const std::string row_unit = kPoseUnits[row], column_unit = kPoseUnits[column];
  const std::string unit = row_unit == column_unit ? row_unit + "2" : row_unit + "_" + column_unit;
  return "cov_" + row_name + "_" + column_name + "_" + unit;
}

/// The upper triangle of a symmetric matrix, row by row.
void appendTriangle(Values& values, const auto& matrix) {
  for (int row = 0; row < matrix.rows(); ++row)
    for (int column = row; column < matrix.cols(); ++column) values.emplace_back(matrix(row, column));
}

template <class T>
std::optional<T> asOptional(const T* value) {
  return value == nullptr ? std::nullopt : std::optional(*value);
}

void append(Values& values, const std::optional<double>& scalar) { values.push_back(scalar); }

/// `number`: what follows its name.
void appendNames(const ValueText& text, const std::string& number, std::vector<std::string>& names) {
  const std::string name = std::string(text.name) + number, unit = "_" + std::string(text.unit);
  if (text.kind == ValueText::Kind::geodetic) {
    names.insert(names.end(), {"latitude_deg", "longitude_deg", "height_m"});
    return;
  }
  if (text.kind == ValueText::Kind::scalar) names.push_back(name + unit);
  for (const char* axis : {"_x", "_y", "_z"})
    if (text.kind != ValueText::Kind::scalar)
      names.push_back(name + axis + (text.kind == ValueText::Kind::vector ? unit : ""));
  if (text.kind == ValueText::Kind::rotation) names.push_back(name + "_w");
}

struct Names {
  using List = std::vector<std::string>;
  template <class Entry>
  List operator()(const Entry& entry) const {
    List names;
    if constexpr (kIsInstruments<Entry>) {
      using Instrument = InstrumentOf<Entry>;
      int number = 0;
      Instrument::forEachValue(entry, [&](int k, const auto*) {
        appendNames(
            Instrument::values[static_cast<std::size_t>(k)],
            requires { Instrument::numbered; } ? "_" + std::to_string(++number) : "", names);
      });
    }
    return names;
  }
  List operator()(const PoseSample&) const {
    List names{"x_odom_m",       "y_odom_m",       "z_odom_m",      "q_odom_robot_x",
               "q_odom_robot_y", "q_odom_robot_z", "q_odom_robot_w"};
    for (std::size_t row = 0; row < kPoseSize; ++row)
      for (std::size_t column = row; column < kPoseSize; ++column)
        names.push_back(covarianceName(kPoseNames[row], row, kPoseNames[column], column));
    return names;
  }
  /// Of one panel. Its covariance is UncertainPose's: rx, ry, rz are a rotation vector in the panel's axes.
  List operator()(const PanelSample&) const {
    List names{"panel",
               "x_camera_m",
               "y_camera_m",
               "z_camera_m",
               "q_camera_panel_x",
               "q_camera_panel_y",
               "q_camera_panel_z",
               "q_camera_panel_w"};
    constexpr std::array<const char*, kPoseSize> kAxes{"x", "y", "z", "rx", "ry", "rz"};
    for (std::size_t row = 0; row < kPoseSize; ++row)
      for (std::size_t column = row; column < kPoseSize; ++column)
        names.push_back(covarianceName(kAxes[row], row, kAxes[column], column));
    return names;
  }
  /// Of one marker.
  List operator()(const MarkersSample&) const {
    return {"id",
            "range_m",
            "yaw_rad",
            "pitch_rad",
            "cov_range_range_m2",
            "cov_range_yaw_m_rad",
            "cov_range_pitch_m_rad",
            "cov_yaw_yaw_rad2",
            "cov_yaw_pitch_rad2",
            "cov_pitch_pitch_rad2"};
  }
};

struct AppendValues {
  Values& values;
  template <class Entry>
  void operator()(const Entry& entry) const {
    if constexpr (kIsInstruments<Entry>)
      InstrumentOf<Entry>::forEachValue(entry,
                                        [&](int, const auto* value) { append(values, asOptional(value)); });
  }
  void operator()(const PoseSample& sample) const {
    const Pose T_odom_robot = sample.T_odom_robot.mean;
    append(values, std::optional(T_odom_robot.position));
    append(values, std::optional(T_odom_robot.rotation));
    appendTriangle(values, sample.T_odom_robot.covariance);
  }
  void operator()(const PanelSample& sample) const {
    for (const SeenPanel& seen : sample.panels) {
      values.emplace_back(seen.panel);
      append(values, std::optional(seen.T_camera_panel.pose.position));
      append(values, std::optional(seen.T_camera_panel.pose.rotation));
      appendTriangle(values, seen.T_camera_panel.covariance);
    }
  }
  void operator()(const MarkersSample& sample) const {
    for (const SeenMarker& marker : sample.markers) {
      for (const double value : {1.0 * marker.id, marker.range_m, marker.yaw_rad, marker.pitch_rad})
        values.emplace_back(value);
      appendTriangle(values, marker.covariance);
    }
  }
};

struct Absent {
  using List = std::vector<std::string>;
  List operator()(const PoseSample&) const { return {}; }
  template <class Entry>
  List operator()(const Entry& entry) const {
    List parts;
    if constexpr (kIsInstruments<Entry>) {
      using Instrument = InstrumentOf<Entry>;
      int number = 0;
      Instrument::forEachValue(entry, [&](int k, const auto* value) {
        ++number;
        if (value != nullptr) return;
        parts.emplace_back(Instrument::values[static_cast<std::size_t>(k)].absent);
        if constexpr (requires { Instrument::numbered; }) parts.back() += " " + std::to_string(number);
      });
    }
    return parts;
  }
};

struct Mountings {
  using List = std::vector<Pose>;
  List operator()(const ImageSample& image) const { return {image.T_robot_camera}; }
  List operator()(const PanelSample& panels) const { return {panels.T_robot_camera}; }
  List operator()(const MarkersSample& markers) const { return {markers.T_robot_camera_forward}; }
  List operator()(const StereoSample& stereo) const { return {stereo.T_robot_left, stereo.T_left_right}; }
  template <class Entry>
  List operator()(const Entry& entry) const {
    if constexpr (kIsInstruments<Entry>)
      return InstrumentOf<Entry>::mountings(entry);
    else
      return {};
  }
};

}  // namespace

std::vector<std::string> fieldNames(const Reading& reading) { return std::visit(Names{}, reading); }

std::size_t fieldRows(const Reading& reading) {
  if (const auto* panels = std::get_if<PanelSample>(&reading)) return panels->panels.size();
  if (const auto* markers = std::get_if<MarkersSample>(&reading)) return markers->markers.size();
  return 1;
}

void fieldValues(const Reading& reading, Values& values) {
  values.clear();
  std::visit(AppendValues{values}, reading);
}

std::vector<std::string> absentParts(const Reading& reading) { return std::visit(Absent{}, reading); }

std::vector<Pose> mountings(const Reading& reading) { return std::visit(Mountings{}, reading); }

std::vector<RecordedCamera> intrinsics(const Reading& reading) {
  if (const auto* image = std::get_if<ImageSample>(&reading)) return {image->intrinsics};
  if (const auto* stereo = std::get_if<StereoSample>(&reading))
    return {stereo->left_intrinsics, stereo->right_intrinsics};
  return {};
}

std::vector<std::string> imageFiles(const Reading& reading) {
  if (const auto* image = std::get_if<ImageSample>(&reading)) return {image->file};
  if (const auto* stereo = std::get_if<StereoSample>(&reading))
    return {stereo->left_file, stereo->right_file};
  return {};
}

}  // namespace fathom
