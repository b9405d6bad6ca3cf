#include "recording/observations.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservation6DFeatures.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/poses/CPose3DQuat.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>

#include "core/linear_algebra.h"
#include "recording/header_text.h"
#include "recording/mrpt_types.h"

namespace fathom {
namespace {

using namespace mrpt::obs;
using mrpt::poses::CPose3D;
using mrpt::poses::CPose3DQuat;

constexpr const char* kComment = "mrpt::obs::CObservationComment";
constexpr const char* kImu = "mrpt::obs::CObservationIMU";
constexpr const char* kRange = "mrpt::obs::CObservationRange";
constexpr const char* kGps = "mrpt::obs::CObservationGPS";
constexpr const char* kRobotPose = "mrpt::obs::CObservationRobotPose";
constexpr const char* kImageClass = "mrpt::obs::CObservationImage";
constexpr const char* kStereoImages = "mrpt::obs::CObservationStereoImages";
constexpr const char* kFeatures = "mrpt::obs::CObservation6DFeatures";
constexpr const char* kBearingRange = "mrpt::obs::CObservationBearingRange";

struct LabelledClass {
  std::string_view label;
  std::string_view mrpt_class;
};
constexpr auto kConvention = std::to_array<LabelledClass>({{labels::kIns, kImu},
                                                           {labels::kDvl, kImu},
                                                           {labels::kDvlBeams, kRange},
                                                           {labels::kDepth, kImu},
                                                           {labels::kUsbl, kRobotPose},
                                                           {Compass::label, kImu},
                                                           {Gnss::label, kGps},
                                                           {Altimeter::label, kRange},
                                                           {labels::kCamera, kImageClass},
                                                           {labels::kStereo, kStereoImages},
                                                           {labels::kSimulated, kImageClass},
                                                           {labels::kTruth, kRobotPose},
                                                           {labels::kPanel, kFeatures},
                                                           {labels::kHandles, kFeatures},
                                                           {labels::kMarkerSights, kBearingRange}});

/// The class the convention gives a label, that of its kind ("DVL.2": DVL); empty where it knows no such
/// label.
std::string_view classOf(std::string_view label) {
  for (const LabelledClass& entry : kConvention)
    if (baseOf(label) == entry.label) return entry.mrpt_class;
  return {};
}

using FieldTriple = std::array<TIMUDataIndex, 3>;
constexpr FieldTriple kAngularVelocity{IMU_WX, IMU_WY, IMU_WZ};
constexpr FieldTriple kSpecificForce{IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC};
constexpr FieldTriple kVelocity{IMU_X_VEL, IMU_Y_VEL, IMU_Z_VEL};
constexpr std::array<TIMUDataIndex, 4> kAttitude{IMU_ORI_QUAT_X, IMU_ORI_QUAT_Y, IMU_ORI_QUAT_Z,
                                                 IMU_ORI_QUAT_W};

// ---- reading ----

std::optional<Vector3d> readTriple(const CObservationIMU& imu, const FieldTriple& fields) {
  if (!std::all_of(fields.begin(), fields.end(), [&](auto field) { return imu.has(field); })) return {};
  return Vector3d(imu.get(fields[0]), imu.get(fields[1]), imu.get(fields[2]));
}

std::optional<Matrix3d> readAttitude(const CObservationIMU& imu) {
  if (!std::all_of(kAttitude.begin(), kAttitude.end(), [&](auto field) { return imu.has(field); })) return {};
  const Eigen::Quaterniond q(imu.get(IMU_ORI_QUAT_W), imu.get(IMU_ORI_QUAT_X), imu.get(IMU_ORI_QUAT_Y),
                             imu.get(IMU_ORI_QUAT_Z));
  const bool is_unit = std::abs(q.norm() - 1.0) < 0.01;
  if (!is_unit) return Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return q.normalized().toRotationMatrix();
}

/// `label`: of the sensor's kind.
Reading readImu(std::string_view label, const CObservationIMU& imu) {
  const Pose T_robot_sensor = fromMrpt(imu.sensorPose);
  if (label == labels::kIns)
    return InsSample{T_robot_sensor, readTriple(imu, kAngularVelocity), readTriple(imu, kSpecificForce),
                     readAttitude(imu)};
  if (label == labels::kDvl) return DvlSample{T_robot_sensor, readTriple(imu, kVelocity)};
  if (label == Compass::label) {
    if (!imu.has(IMU_YAW)) throw ConventionBreach{"a COMPASS entry lacks IMU_YAW"};
    return CompassSample{T_robot_sensor, imu.get(IMU_YAW)};
  }
  if (label != labels::kDepth) return UnknownSample{kImu};
  if (!imu.has(IMU_PRESSURE)) throw ConventionBreach{"a DEPTH entry lacks IMU_PRESSURE"};
  DepthSample depth{T_robot_sensor, imu.get(IMU_PRESSURE), {}};
  if (imu.has(IMU_TEMPERATURE)) depth.temperature_celsius = imu.get(IMU_TEMPERATURE);
  return depth;
}

Reading readBeams(const CObservationRange& range) {
  DvlBeamsSample beams;
  for (const auto& beam : range.sensedData) {
    beams.beams.push_back({fromMrpt(CPose3D(beam.sensorPose)), {}});
    if (beam.sensedDistance != 0.0F) beams.beams.back().range_m = static_cast<double>(beam.sensedDistance);
  }
  return beams;
}

Reading readAltimeter(const CObservationRange& range) {
  if (range.sensedData.size() != 1) throw ConventionBreach{"an ALTIMETER entry must have one range"};
  const auto& beam = range.sensedData.front();
  AltimeterSample sample{fromMrpt(CPose3D(beam.sensorPose)), {}};
  if (beam.sensedDistance != 0.0F) sample.range_m = static_cast<double>(beam.sensedDistance);
  return sample;
}

Reading readGnss(const CObservationGPS& gps) {
  GnssSample sample{fromMrpt(gps.sensorPose), {}};
  if (!gps.hasMsgClass<gnss::Message_NMEA_GGA>()) return sample;
  const auto& gga = gps.getMsgByClass<gnss::Message_NMEA_GGA>().fields;
  if (gga.fix_quality != 0)
    sample.geodetic = {gga.latitude_degrees, gga.longitude_degrees, gga.altitude_meters};
  return sample;
}

Reading readStereo(const CObservationStereoImages& stereo) {
  if (!stereo.hasImageRight) throw ConventionBreach{"a STEREO entry lacks its right image"};
  return StereoSample{fromMrpt(CPose3D(stereo.cameraPose)),
                      fromMrpt(CPose3D(stereo.rightCameraPose)),
                      fromMrpt(stereo.leftCamera),
                      fromMrpt(stereo.rightCamera),
                      stereo.imageLeft.getExternalStorageFile(),
                      stereo.imageRight.getExternalStorageFile()};
}

/// The inverse of a covariance or of an information matrix; nothing where that is not positive definite.
std::optional<Matrix6d> inverseIfDefinite(const Matrix6d& matrix) {
  const auto whitener = matrix.allFinite() ? lowerWhitener(matrix) : std::nullopt;
  if (!whitener) return std::nullopt;
  Matrix6d inverse = whitener->transpose() * *whitener;
  if (!inverse.allFinite()) return std::nullopt;
  return inverse;
}

Reading readPanels(const CObservation6DFeatures& features) {
  PanelSample sample{fromMrpt(features.sensorPose), {}};
  for (const auto& feature : features.sensedFeatures) {
    const auto covariance = inverseIfDefinite(feature.inf_matrix.asEigen());
    SeenPanel seen{feature.id, {fromMrpt(feature.pose), {}}};
    if (covariance)
      seen.T_camera_panel = UncertainPose::fromYawPitchRoll({fromMrpt(feature.pose), *covariance});
    else
      seen.T_camera_panel.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    sample.panels.push_back(seen);
  }
  return sample;
}

Reading readMarkers(const CObservationBearingRange& bearings) {
  MarkersSample sample{fromMrpt(bearings.sensorLocationOnRobot), {}};
  const Vector3d sigmas(bearings.sensor_std_range, bearings.sensor_std_yaw, bearings.sensor_std_pitch);
  const Matrix3d common = sigmas.cwiseAbs2().asDiagonal();
  for (const auto& mark : bearings.sensedData)
    sample.markers.push_back({mark.landmarkID, mark.range, mark.yaw, mark.pitch,
                              bearings.validCovariances ? Matrix3d(mark.covariance.asEigen()) : common});
  return sample;
}

Reading readPose(const CObservationRobotPose& pose) {
  return PoseSample{fromMrpt(pose.pose), fromMrpt(pose.sensorPose)};
}

Reading readImage(const CObservationImage& image) {
  return ImageSample{fromMrpt(image.cameraPose), fromMrpt(image.cameraParams),
                     image.image.getExternalStorageFile()};
}

/// Whether an image lies in the entry itself, not in a file.
bool hasPixels(const CObservation& observation) {
  const auto inside = [](const mrpt::img::CImage& image) { return image.getExternalStorageFile().empty(); };
  if (const auto* image = dynamic_cast<const CObservationImage*>(&observation)) return inside(image->image);
  const auto* stereo = dynamic_cast<const CObservationStereoImages*>(&observation);
  return stereo != nullptr &&
         (inside(stereo->imageLeft) || (stereo->hasImageRight && inside(stereo->imageRight)) ||
          (stereo->hasImageDisparity && inside(stereo->imageDisparity)));
}

template <class Observation>
const Observation& as(const CObservation& observation) {
  return dynamic_cast<const Observation&>(observation);
}

// ---- writing ----

void writeTriple(CObservationIMU& imu, const FieldTriple& fields, const std::optional<Vector3d>& value) {
  if (!value) return;
  for (std::size_t i = 0; i < fields.size(); ++i) imu.set(fields[i], (*value)[static_cast<Eigen::Index>(i)]);
}

CPose3DQuat toPoseQuat(const Pose& pose) { return CPose3DQuat(toMrpt(pose)); }

void append(CObservation& observation, Time time, const std::string& label,
            std::vector<std::uint8_t>& bytes) {
  observation.timestamp = toMrpt(time);
  observation.sensorLabel = label;
  mrpt::io::CMemoryStream stream;
  mrpt::serialization::archiveFrom(stream) << observation;
  const auto* data = static_cast<const std::uint8_t*>(stream.getRawBufferData());
  bytes.insert(bytes.end(), data, data + stream.getTotalBytesCount());
}

/// Turns each kind of reading into its observation and appends it.
struct Encoder {
  const Sample& sample;
  std::vector<std::uint8_t>& bytes;

  void write(CObservation& observation) const { append(observation, sample.time, sample.label, bytes); }

  void operator()(const InsSample& ins) const {
    requireLabel(labels::kIns);
    CObservationIMU imu;
    imu.sensorPose = toMrpt(ins.T_robot_ins);
    writeTriple(imu, kAngularVelocity, ins.angular_velocity_ins);
    writeTriple(imu, kSpecificForce, ins.specific_force_ins);
    if (ins.R_odom_ins) {
      const Eigen::Quaterniond q(*ins.R_odom_ins);
      for (int i = 0; i < 4; ++i) imu.set(kAttitude[static_cast<std::size_t>(i)], q.coeffs()[i]);
    }
    write(imu);
  }
  void operator()(const DvlSample& dvl) const {
    requireLabel(labels::kDvl);
    CObservationIMU imu;
    imu.sensorPose = toMrpt(dvl.T_robot_dvl);
    writeTriple(imu, kVelocity, dvl.velocity_dvl);
    write(imu);
  }
  void operator()(const DepthSample& depth) const {
    requireLabel(labels::kDepth);
    CObservationIMU imu;
    imu.sensorPose = toMrpt(depth.T_robot_depth);
    imu.set(IMU_PRESSURE, depth.pressure_pa);
    if (depth.temperature_celsius) imu.set(IMU_TEMPERATURE, *depth.temperature_celsius);
    write(imu);
  }
  void operator()(const CompassSample& compass) const {
    requireLabel(Compass::label);
    CObservationIMU imu;
    imu.sensorPose = toMrpt(compass.T_robot_compass);
    imu.set(IMU_YAW, compass.heading_rad);
    write(imu);
  }
  void operator()(const GnssSample& entry) const {
    requireLabel(Gnss::label);
    CObservationGPS gps;
    gps.sensorPose = toMrpt(entry.T_robot_gnss);
    gnss::Message_NMEA_GGA gga;
    gga.fields.fix_quality = entry.geodetic ? 1 : 0;
    if (entry.geodetic) {
      gga.fields.latitude_degrees = entry.geodetic->x();
      gga.fields.longitude_degrees = entry.geodetic->y();
      gga.fields.altitude_meters = entry.geodetic->z();
    }
    gps.setMsg(gga);
    gps.originalReceivedTimestamp = toMrpt(sample.time);
    write(gps);
  }
  void operator()(const AltimeterSample& altimeter) const {
    requireLabel(Altimeter::label);
    CObservationRange range;
    range.minSensorDistance = 0.0F;
    range.maxSensorDistance = 200.0F;
    CObservationRange::TMeasurement measurement;
    measurement.sensorPose = toMrpt(altimeter.T_robot_altimeter).asTPose();
    measurement.sensedDistance = static_cast<float>(altimeter.range_m.value_or(0.0));
    range.sensedData.push_back(measurement);
    write(range);
  }
  void operator()(const DvlBeamsSample& beams) const {
    requireLabel(labels::kDvlBeams);
    CObservationRange range;
    range.minSensorDistance = 0.0F;
    range.maxSensorDistance = 200.0F;
    for (const DvlBeam& beam : beams.beams) {
      CObservationRange::TMeasurement measurement;
      measurement.sensorID = static_cast<std::uint16_t>(range.sensedData.size());
      measurement.sensorPose = toMrpt(beam.T_robot_beam).asTPose();
      measurement.sensedDistance = static_cast<float>(beam.range_m.value_or(0.0));
      range.sensedData.push_back(measurement);
    }
    write(range);
  }
  void operator()(const PoseSample& pose) const {
    const auto expected = classOf(sample.label);
    if (!expected.empty() && expected != kRobotPose) requireLabel(labels::kUsbl);
    CObservationRobotPose observation;
    observation.pose = toMrpt(pose.T_odom_robot);
    observation.sensorPose = toMrpt(pose.T_robot_sensor);
    write(observation);
  }
  void operator()(const ImageSample& image) const {
    if (sample.label != labels::kSimulated) requireLabel(labels::kCamera);
    CObservationImage observation;
    observation.cameraPose = toMrpt(image.T_robot_camera);
    observation.cameraParams = toMrpt(image.intrinsics);
    observation.image.setExternalStorage(image.file);
    write(observation);
  }
  void operator()(const StereoSample& stereo) const {
    requireLabel(labels::kStereo);
    CObservationStereoImages observation;
    observation.cameraPose = toPoseQuat(stereo.T_robot_left);
    observation.rightCameraPose = toPoseQuat(stereo.T_left_right);
    observation.leftCamera = toMrpt(stereo.left_intrinsics);
    observation.rightCamera = toMrpt(stereo.right_intrinsics);
    observation.imageLeft.setExternalStorage(stereo.left_file);
    observation.imageRight.setExternalStorage(stereo.right_file);
    observation.hasImageRight = true;
    write(observation);
  }
  void operator()(const PanelSample& sample_in) const {
    if (sample.label != labels::kHandles) requireLabel(labels::kPanel);
    CObservation6DFeatures observation;
    observation.sensorPose = toMrpt(sample_in.T_robot_camera);
    for (const SeenPanel& seen : sample_in.panels) {
      const YawPitchRollPose pose = seen.T_camera_panel.toYawPitchRoll();
      CObservation6DFeatures::TMeasurement feature;  // its information is zero
      feature.id = seen.panel;
      feature.pose = toMrpt(pose.mean);
      if (const auto information = inverseIfDefinite(pose.covariance))
        feature.inf_matrix.asEigen() = *information;
      observation.sensedFeatures.push_back(feature);
    }
    write(observation);
  }
  void operator()(const MarkersSample& markers) const {
    requireLabel(labels::kMarkerSights);
    CObservationBearingRange observation;
    observation.sensorLocationOnRobot = toMrpt(markers.T_robot_camera_forward);
    observation.validCovariances = true;
    std::set<int> ids;  // MRPT refuses the same one twice
    for (const SeenMarker& marker : markers.markers) {
      CObservationBearingRange::TMeasurement mark{};
      mark.landmarkID = ids.insert(marker.id).second ? marker.id : INVALID_LANDMARK_ID;
      mark.range = static_cast<float>(marker.range_m);
      mark.yaw = static_cast<float>(marker.yaw_rad);
      mark.pitch = static_cast<float>(marker.pitch_rad);
      mark.covariance.asEigen() = marker.covariance;
      observation.sensedData.push_back(mark);
    }
    write(observation);
  }
  void operator()(const RecordingHeader&) const {
    throw std::logic_error("a rawlog's header is written once, by RawlogWriter's constructor");
  }
  void operator()(const UnknownSample&) const {
    throw std::logic_error("an unknown entry cannot be written");
  }

  void requireLabel(std::string_view expected) const {
    if (baseOf(sample.label) == expected) return;
    throw std::logic_error("label " + sample.label + " on a sample of kind " + std::string(expected));
  }
};

}  // namespace

Reading decodeReading(const CObservation& observation) {
  const std::string mrpt_class = observation.GetRuntimeClass()->className;
  const std::string label(baseOf(observation.sensorLabel));
  const auto expected = classOf(label);
  if (!expected.empty() && expected != mrpt_class)
    throw ConventionBreach{"an entry labelled " + observation.sensorLabel + " is a " + mrpt_class +
                           ", must be a " + std::string(expected)};
  if (hasPixels(observation)) {
    if (expected.empty()) return UnknownSample{mrpt_class};
    throw ConventionBreach{
        "an image is stored in the rawlog, must be in a file of its own (rawlog-edit --externalize)"};
  }
  if (mrpt_class == kComment) return parseHeaderText(as<CObservationComment>(observation).text);
  if (mrpt_class == kImu) return readImu(label, as<CObservationIMU>(observation));
  if (mrpt_class == kRobotPose) return readPose(as<CObservationRobotPose>(observation));
  if (label == labels::kPanel || label == labels::kHandles)
    return readPanels(as<CObservation6DFeatures>(observation));
  if (label == labels::kMarkerSights) return readMarkers(as<CObservationBearingRange>(observation));
  if (label == labels::kDvlBeams) return readBeams(as<CObservationRange>(observation));
  if (label == Altimeter::label) return readAltimeter(as<CObservationRange>(observation));
  if (label == Gnss::label) return readGnss(as<CObservationGPS>(observation));
  if (label == labels::kStereo) return readStereo(as<CObservationStereoImages>(observation));
  if (label == labels::kCamera || label == labels::kSimulated)
    return readImage(as<CObservationImage>(observation));
  return UnknownSample{mrpt_class};
}

void encodeSample(const Sample& sample, std::vector<std::uint8_t>& bytes) {
  std::visit(Encoder{sample, bytes}, sample.reading);
}

void encodeHeader(const RecordingHeader& header, Time time, std::vector<std::uint8_t>& bytes) {
  CObservationComment comment;
  comment.text = headerText(header);
  append(comment, time, "", bytes);
}

}  // namespace fathom
