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

struct Names {
  using List = std::vector<std::string>;
  List operator()(const InsSample&) const {
    return {"angular_velocity_ins_x_rad_s",
            "angular_velocity_ins_y_rad_s",
            "angular_velocity_ins_z_rad_s",
            "specific_force_ins_x_m_s2",
            "specific_force_ins_y_m_s2",
            "specific_force_ins_z_m_s2",
            "q_odom_ins_x",
            "q_odom_ins_y",
            "q_odom_ins_z",
            "q_odom_ins_w"};
  }
  List operator()(const DvlSample&) const {
    return {"velocity_dvl_x_m_s", "velocity_dvl_y_m_s", "velocity_dvl_z_m_s"};
  }
  List operator()(const DvlBeamsSample& sample) const {
    List names;
    for (std::size_t k = 0; k < sample.beams.size(); ++k)
      names.push_back("range_" + std::to_string(k + 1) + "_m");
    return names;
  }
  List operator()(const DepthSample&) const { return {"pressure_pa", "temperature_celsius"}; }
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
  List operator()(const auto&) const { return {}; }
};

struct AppendValues {
  Values& values;
  void operator()(const InsSample& ins) const {
    append(values, ins.angular_velocity_ins);
    append(values, ins.specific_force_ins);
    append(values, ins.R_odom_ins);
  }
  void operator()(const DvlSample& dvl) const { append(values, dvl.velocity_dvl); }
  void operator()(const DvlBeamsSample& sample) const {
    for (const DvlBeam& beam : sample.beams) values.push_back(beam.range_m);
  }
  void operator()(const DepthSample& depth) const {
    values.emplace_back(depth.pressure_pa);
    values.push_back(depth.temperature_celsius);
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
  void operator()(const auto&) const {}
};

struct Absent {
  using List = std::vector<std::string>;
  List operator()(const InsSample& ins) const {
    List parts;
    if (!ins.angular_velocity_ins) parts.emplace_back("angular velocity");
    if (!ins.specific_force_ins) parts.emplace_back("specific force");
    if (!ins.R_odom_ins) parts.emplace_back("attitude");
    return parts;
  }
  List operator()(const DvlSample& dvl) const { return dvl.velocity_dvl ? List{} : List{"bottom lock"}; }
  List operator()(const DvlBeamsSample& sample) const {
    List parts;
    for (std::size_t k = 0; k < sample.beams.size(); ++k)
      if (!sample.beams[k].range_m) parts.push_back("echo of beam " + std::to_string(k + 1));
    return parts;
  }
  List operator()(const DepthSample& depth) const {
    return depth.temperature_celsius ? List{} : List{"temperature"};
  }
  List operator()(const auto&) const { return {}; }
};

struct Mountings {
  using List = std::vector<Pose>;
  List operator()(const InsSample& ins) const { return {ins.T_robot_ins}; }
  List operator()(const DvlSample& dvl) const { return {dvl.T_robot_dvl}; }
  List operator()(const DepthSample& depth) const { return {depth.T_robot_depth}; }
  List operator()(const PoseSample& pose) const { return {pose.T_robot_sensor}; }
  List operator()(const ImageSample& image) const { return {image.T_robot_camera}; }
  List operator()(const PanelSample& panels) const { return {panels.T_robot_camera}; }
  List operator()(const MarkersSample& markers) const { return {markers.T_robot_camera_forward}; }
  List operator()(const StereoSample& stereo) const { return {stereo.T_robot_left, stereo.T_left_right}; }
  List operator()(const DvlBeamsSample& sample) const {
    List poses;
    for (const DvlBeam& beam : sample.beams) poses.push_back(beam.T_robot_beam);
    return poses;
  }
  List operator()(const auto&) const { return {}; }
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
