#include "sea_trial/import_sea_trial.h"

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "audit/sensor_units.h"
#include "core/error.h"
#include "core/files.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "recording/csv.h"
#include "sea_trial/conventions.h"
#include "sea_trial/corrected_tables.h"

namespace fathom {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTurned_deg = 15;  ///< a DVL is, beyond what mountings are off

/// As PD0 writes "no bottom lock", and tables of it in m/s; or nothing at all.
bool isWithoutLock(const Vector3d& velocity) {
  constexpr double kBad_mm_s = -32768;
  const auto isBad = [&](double v) { return v == kBad_mm_s || std::abs(v - kBad_mm_s / 1000) < 1e-9; };
  return !velocity.allFinite() || isBad(velocity.x()) || isBad(velocity.y()) || isBad(velocity.z());
}

Vector3d three(const std::vector<double>& row, std::size_t first) {
  return {row[first], row[first + 1], row[first + 2]};
}

/// A column says its unit: an angle that is more than its whole range is in another.
void requireRadians(const std::filesystem::path& file, const std::vector<std::string>& columns,
                    const std::vector<std::vector<double>>& rows) {
  for (std::size_t column = 0; column < columns.size(); ++column) {
    if (!columns[column].ends_with("[rad]")) continue;
    const double most = columns[column].starts_with("Latitude") ? kPi / 2 : 2 * kPi;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (std::abs(rows[k][column]) > most + 1e-6)
        throw Error(file.string(), "line " + std::to_string(k + 2),
                    columns[column] + print(" is %.9g: is it in degrees?", rows[k][column]));
  }
}

std::vector<std::vector<double>> readRows(const std::filesystem::path& file,
                                          const std::vector<std::string>& columns,
                                          AbsentNumbers absent = AbsentNumbers::refused) {
  auto rows = readCsv(file, columns, absent);
  requireRadians(file, columns, rows);
  if (rows.size() < 10) throw Error(file.string(), "", "has fewer than 10 rows: nothing can be established");
  return rows;
}

/// White noise of each sample: third differences of white noise have variance 20 sigma², and motion slower
/// than the samples hardly enters. The largest of the three axes.
double highFrequencySigma(const std::vector<Vector3d>& v) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 3; k < v.size(); ++k)
    sum += (v[k] - 3.0 * v[k - 1] + 3.0 * v[k - 2] - v[k - 3]).cwiseAbs2();
  const double largest = (sum / (20.0 * static_cast<double>(v.size() - 3))).maxCoeff();
  return std::max(std::sqrt(largest), 1e-9);  // a vehicle file wants it positive
}

/// Normal gravity on the WGS-84 ellipsoid, m/s² (NIMA TR8350.2, eq. 4-1, Somigliana).
double normalGravity(double latitude_rad) {
  const double s2 = std::pow(std::sin(latitude_rad), 2);
  return 9.7803253359 * (1.0 + 0.00193185265241 * s2) / std::sqrt(1.0 - 0.00669437999013 * s2);
}

double rate(const std::vector<double>& time_s) {
  return static_cast<double>(time_s.size() - 1) / (time_s.back() - time_s.front());
}

/// `stretch`: by which the DVL's stamps are corrected.
std::string vehicleYaml(const SeaTrialData& data, const SeaTrialConventions& c, double stretch) {
  const double latitude = c.position_columns_swapped ? data.longitude_rad[0] : data.latitude_rad[0];
  char text[3000];
  std::snprintf(
      text, sizeof text,
      "# Snapir, a modified ECA A18D: iXblue Phins Subsea and Teledyne RDI Workhorse Navigator.\n"
      "# Mountings are not published: nominal is no lever arm and no rotation.\n"
      "gravity_m_s2: %.5f                 # normal gravity of WGS-84 at the latitude of the trial\n"
      "ins:\n"
      "  rate_hz: %.4g\n"
      "  gyro_sigma_rad_s: %.2g               # from the data: RMS third difference / sqrt(20), worst axis\n"
      "  accelerometer_sigma_m_s2: %.2g        # likewise; contains the vehicle's vibration\n"
      "  gyro_bias_sigma_rad_s: 0.000073      # Earth's rotation, which is in the gyro and not in the model\n"
      "  accelerometer_bias_sigma_m_s2: 0.003 # assumed, not published\n"
      "  bias_time_constant_s: 3600           # assumed, not published\n"
      "  pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}\n"
      "dvl:\n"
      "  rate_hz: %.4g\n"
      "  assumed_sound_speed_m_s: 1500        # assumed, not published\n"
      "  beam_sigma_m_s: 0.0141               # what gives 0.02 in x and y at 30 degrees\n"
      "  velocity_sigma_xy_m_s: 0.02          # data sheet\n"
      "  velocity_sigma_z_m_s: 0.02           # data sheet, which names no axis\n"
      "  range_sigma_m: 0.1                   # assumed; the recording has no ranges\n"
      "  beam_angle_deg: 30                   # data sheet\n"
      "  beam_azimuths_deg: [45, 135, 225, 315]   # usual mounting; the recording has no beams\n"
      "  pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}\n",
      normalGravity(latitude), rate(data.imu_time_s), highFrequencySigma(data.rate_imu),
      highFrequencySigma(data.acceleration_imu), rate(data.dvl_time_s) / stretch);
  return text;
}

/// Corrects the tables, too.
SeaTrialConventions establish(SeaTrialData& data, const SeaTrialFiles& files,
                              const SeaTrialOptions& options) {
  try {
    data = correctedTables(std::move(data), options.corrections, options.start);
    return establishConventions(data);
  } catch (const std::invalid_argument& problem) {
    throw Error(files.gt.string(), "", problem.what());
  }
}

Time stamp(const std::vector<double>& time_s, std::size_t k, double stretch, const SeaTrialOptions& options) {
  return after(options.start, time_s.front() + (time_s[k] - time_s.front()) * stretch);
}

std::vector<Sample> samples(const SeaTrialData& data, const SeaTrialConventions& c, double stretch,
                            const SeaTrialOptions& options) {
  const Matrix3d gyro = flipFrdRobot() * c.gyro.matrix();
  const Matrix3d accelerometer = flipFrdRobot() * c.accelerometer.matrix();
  const Matrix3d dvl = flipFrdRobot() * c.dvl.matrix();
  std::vector<Sample> all;
  for (std::size_t k = 0; k < data.imu_time_s.size(); ++k)
    all.push_back({stamp(data.imu_time_s, k, 1.0, options), labels::kIns,
                   InsSample{Pose{}, gyro * data.rate_imu[k], accelerometer * data.acceleration_imu[k], {}}});
  for (std::size_t k = 0; k < data.dvl_time_s.size(); ++k)
    all.push_back({stamp(data.dvl_time_s, k, stretch, options), labels::kDvl,
                   DvlSample{Pose{}, dvl * data.velocity_dvl[k]}});
  stableSort(all, [](const Sample& a, const Sample& b) { return a.time < b.time; });
  return all;
}

/// What the navigation solution needs to be the IMU's.
struct ReferenceChange {
  double stretch = 1.0, offset_s = 0.0;
  Vector3d point_m = Vector3d::Zero();  ///< its own, from there
};

std::vector<StampedPose> reference(const SeaTrialData& data, const SeaTrialConventions& c,
                                   const ReferenceChange& change, const SeaTrialOptions& options) {
  const auto position_odom = positionsEnu(data, c.position_columns_swapped, c.altitude_sign);
  const auto R_ned_frd = attitudesNed(data, c.attitude_sign);
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < position_odom.size(); ++k) {
    const Matrix3d R_odom_robot = swapNedEnu() * R_ned_frd[k] * flipFrdRobot();
    poses.push_back({after(stamp(data.gt_time_s, k, change.stretch, options), change.offset_s),
                     {R_odom_robot, position_odom[k] - R_odom_robot * change.point_m}});
  }
  const Vector3d first = poses.front().T_odom_robot.position;
  for (StampedPose& pose : poses) pose.T_odom_robot.position -= first;
  return poses;
}

/// What is more than scale errors and mountings make, and what would mend it.
std::string dvlRemark(double scale, double turned_deg, const DvlRegression& fit) {
  std::string line = print("DVL: it reads %.4g times the navigation solution's velocity, turned by %.3g deg",
                           scale, turned_deg);
  if (turned_deg < kTurned_deg)
    for (const SensorUnit& unit : kVelocityUnits)
      if (std::abs(scale * unit.si - 1) < 0.05)
        line += print("; %s, --correct %s corrects it", unit.says, unit.name);
  const Vector3d rotation_deg = fit.toldRotation() * degrees(1.0);
  const bool is_mounting = std::abs(scale - 1) < 0.1 && rotation_deg.head<2>().norm() < 0.1 * turned_deg;
  if (turned_deg >= kTurned_deg && is_mounting && fit.fits())
    line += print("; --correct dvl-turned:%.1f turns it back", rotation_deg.z());
  return line;
}

std::string dvlClockRemark(const DvlRegression& fit) {
  return print(
      "DVL: its velocities fit the navigation solution's %.2f s %s, to %.3g m/s instead of %.3g m/s; "
      "--correct clock-offset:%s:%.2f makes them so much %s",
      std::abs(fit.delay_s), fit.delay_s < 0 ? "earlier" : "later", fit.residual_m_s.norm(),
      fit.residual_undelayed_m_s, labels::kDvl, fit.delay_s, fit.delay_s < 0 ? "earlier" : "later");
}

std::vector<std::string> remarks(const SeaTrialData& data, const SeaTrialConventions& c) {
  std::vector<std::string> lines = c.doubts;
  if (data.without_lock > 0)
    lines.push_back(print("DVL: %zu of %zu rows have no bottom lock, and are left out", data.without_lock,
                          data.without_lock + data.dvl_time_s.size()));
  const DvlRegression& fit = c.dvl_regression;
  const double turned_deg = degrees(fit.toldRotation().norm()), scale = 1 + fit.toldScaleError();
  if (fit.explainsMore() && (scale <= 0.7 || scale >= 1.4 || turned_deg >= kTurned_deg))
    lines.push_back(dvlRemark(scale, turned_deg, fit));
  if (fit.isDelayed()) lines.push_back(dvlClockRemark(fit));
  return lines;
}

}  // namespace

SeaTrialFiles seaTrialFiles(const std::filesystem::path& folder, int section) {
  const auto find = [&](const std::string& stream) {
    const std::string name = stream + "_trajectory" + std::to_string(section) + ".csv";
    for (const auto& file : {folder / (name + ".gz"), folder / name})
      if (isThere(file)) return file;
    throw Error(folder.string(), "", "has no " + name + ".gz nor " + name);
  };
  return {find("IMU"), find("DVL"), find("GT")};
}

SeaTrialData readSeaTrial(const SeaTrialFiles& files) {
  SeaTrialData data;
  for (const auto& row : readRows(files.imu, {"Time [s]", "ACC X [m/s^2]", "ACC Y [m/s^2]", "ACC Z [m/s^2]",
                                              "GYRO X [rad/s]", "GYRO Y [rad/s]", "GYRO Z [rad/s]"})) {
    data.imu_time_s.push_back(row[0]);
    data.acceleration_imu.push_back(three(row, 1));
    data.rate_imu.push_back(three(row, 4));
  }
  for (const auto& row :
       readRows(files.dvl, {"Time [s]", "DVL X [m/s]", "DVL Y [m/s]", "DVL Z [m/s]"}, AbsentNumbers::nan)) {
    if (isWithoutLock(three(row, 1))) {
      ++data.without_lock;
      continue;
    }
    data.dvl_time_s.push_back(row[0]);
    data.velocity_dvl.push_back(three(row, 1));
  }
  for (const auto& row :
       readRows(files.gt, {"Time [s]", "Longitude [rad]", "Latitude [rad]", "Altitude [m]", "V North [m/s]",
                           "V East [m/s]", "V Down [m/s]", "Roll [rad]", "Pitch [rad]", "Yaw [rad]"})) {
    data.gt_time_s.push_back(row[0]);
    data.longitude_rad.push_back(row[1]);
    data.latitude_rad.push_back(row[2]);
    data.altitude_m.push_back(row[3]);
    data.velocity_ned.push_back(three(row, 4));
    data.roll_pitch_yaw.push_back(three(row, 7));
  }
  return data;
}

ImportedRecording importSeaTrial(const SeaTrialFiles& files, const SeaTrialOptions& options) {
  SeaTrialData data = readSeaTrial(files);
  SeaTrialConventions conventions = establish(data, files, options);
  const double stretch = options.undo_stamp_stretch ? conventions.stamp_stretch : 1.0;
  ImportedRecording recording;
  recording.header.description = "sea trial from " + files.imu.filename().string() + ", " +
                                 files.dvl.filename().string() + ", " + files.gt.filename().string();
  recording.samples = samples(data, conventions, stretch, options);
  recording.start = recording.samples.front().time;
  const ReferenceChange change = options.reference_as_published
                                     ? ReferenceChange{stretch, 0.0, Vector3d::Zero()}
                                     : ReferenceChange{conventions.stamp_stretch, conventions.imu_offset_s,
                                                       conventions.reference_point_m};
  recording.reference = reference(data, conventions, change, options);
  recording.vehicle_yaml = vehicleYaml(data, conventions, stretch);
  recording.remarks = remarks(data, conventions);
  recording.conclusions = std::move(conventions.conclusions);
  recording.conclusions.push_back({"the reference",
                                   options.reference_as_published
                                       ? "as published: by its own clock, at its own point"
                                       : "put on the IMU's clock, and where the IMU is: "
                                         "--reference-as-published leaves it",
                                   "", 0.0, ""});
  if (conventions.stamp_stretch != 1.0)
    recording.conclusions.push_back({"the stretch of the DVL's stamps",
                                     options.undo_stamp_stretch
                                         ? "undone; the vehicle file has the rate that results"
                                         : "kept as published; --undo-stamp-stretch undoes it",
                                     "", 0.0, print("factor %.7g", conventions.stamp_stretch)});
  return recording;
}

}  // namespace fathom
