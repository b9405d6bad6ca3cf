#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservation6DFeatures.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussianInf.h>
#include <mrpt/serialization/CArchive.h>

#include <array>
#include <cstdio>

#include "core/files.h"
#include "recording/mrpt_classes.h"
#include "recording/mrpt_types.h"
#include "support/recordings.h"
#include "support/run_program.h"
#include "support/shared_data.h"

// Stock MRPT opens what the writer writes, and finds in it what the recording convention says.
namespace fathom::test {
namespace {

using namespace mrpt::obs;

class RawlogMrpt : public testing::Test {
 protected:
  void SetUp() override {
    file = scratchFolder() / "recording.rawlog";
    Random random(21);
    samples = randomSamples(4000, random);
    writeRecording(file, samples, {"maps/panel.yaml", "rov.yaml", "two\nlines"});
  }
  std::filesystem::path file;
  std::vector<Sample> samples;
};

TEST_F(RawlogMrpt, LoadsAsObservationsOnly) {
  CRawlog rawlog;
  ASSERT_TRUE(rawlog.loadFromRawLogFile(file.string()));
  ASSERT_EQ(rawlog.size(), samples.size());  // the comment is taken out, see below
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto observation = rawlog.getAsObservation(i);
    ASSERT_EQ(observation->timestamp, toMrpt(samples[i].time));
    ASSERT_EQ(observation->sensorLabel, samples[i].label);
    mrpt::poses::CPose3D mounting;
    observation->getSensorPose(mounting);
    const Pose T_robot_sensor = mountings(samples[i].reading).at(0);
    ASSERT_LT((fromMrpt(mounting).position - T_robot_sensor.position).norm(), 1e-13);
    ASSERT_LT((fromMrpt(mounting).rotation - T_robot_sensor.rotation).norm(), 1e-13);
  }
}

TEST_F(RawlogMrpt, HeaderIsAConfigFile) {
  // The way a user of MRPT reads it; CRawlog::getCommentTextAsConfigFile() is for comments added to a
  // CRawlog.
  CRawlog rawlog;
  ASSERT_TRUE(rawlog.loadFromRawLogFile(file.string()));
  mrpt::config::CConfigFileMemory config;
  rawlog.getCommentTextAsConfigFile(config);
  EXPECT_EQ(config.read_string("recording", "panel_map", ""), "maps/panel.yaml");
  EXPECT_EQ(config.read_string("recording", "vehicle", ""), "rov.yaml");
  EXPECT_EQ(config.read_string("recording", "description", ""), "two\\nlines");
}

TEST_F(RawlogMrpt, FieldsAreWhereTheConventionPutsThem) {
  CRawlog rawlog;
  ASSERT_TRUE(rawlog.loadFromRawLogFile(file.string()));
  for (std::size_t i = 0; i < 80; ++i) {
    const auto observation = rawlog.getAsObservation(i);
    const auto imu = std::dynamic_pointer_cast<CObservationIMU>(observation);
    if (const auto* ins = std::get_if<InsSample>(&samples[i].reading)) {
      ASSERT_TRUE(imu);
      ASSERT_EQ(imu->has(IMU_WX), ins->angular_velocity_ins.has_value());
      ASSERT_EQ(imu->has(IMU_Z_ACC), ins->specific_force_ins.has_value());
      ASSERT_EQ(imu->has(IMU_ORI_QUAT_W), ins->R_odom_ins.has_value());
      if (ins->angular_velocity_ins) {
        EXPECT_EQ(imu->get(IMU_WX), ins->angular_velocity_ins->x());
      }
      if (ins->angular_velocity_ins) {
        EXPECT_EQ(imu->get(IMU_WZ), ins->angular_velocity_ins->z());
      }
      if (ins->specific_force_ins) {
        EXPECT_EQ(imu->get(IMU_X_ACC), ins->specific_force_ins->x());
      }
    } else if (const auto* dvl = std::get_if<DvlSample>(&samples[i].reading)) {
      ASSERT_TRUE(imu);
      ASSERT_EQ(imu->has(IMU_Y_VEL), dvl->velocity_dvl.has_value());
      if (dvl->velocity_dvl) {
        EXPECT_EQ(imu->get(IMU_Y_VEL), dvl->velocity_dvl->y());
      }
    } else if (const auto* depth = std::get_if<DepthSample>(&samples[i].reading)) {
      ASSERT_TRUE(imu);
      EXPECT_EQ(imu->get(IMU_PRESSURE), depth->pressure_pa);
      EXPECT_EQ(imu->has(IMU_TEMPERATURE), depth->temperature_celsius.has_value());
    } else if (const auto* beams = std::get_if<DvlBeamsSample>(&samples[i].reading)) {
      const auto range = std::dynamic_pointer_cast<CObservationRange>(observation);
      ASSERT_TRUE(range);
      ASSERT_EQ(range->sensedData.size(), beams->beams.size());
      EXPECT_EQ(range->sensedData[0].sensedDistance, static_cast<float>(beams->beams[0].range_m.value_or(0)));
    } else if (const auto* pose = std::get_if<PoseSample>(&samples[i].reading)) {
      const auto robot_pose = std::dynamic_pointer_cast<CObservationRobotPose>(observation);
      ASSERT_TRUE(robot_pose);
      EXPECT_EQ(robot_pose->pose.cov.asEigen(), pose->T_odom_robot.covariance);
    } else if (const auto* image = std::get_if<ImageSample>(&samples[i].reading)) {
      const auto picture = std::dynamic_pointer_cast<CObservationImage>(observation);
      ASSERT_TRUE(picture);
      EXPECT_TRUE(picture->image.isExternallyStored());
      EXPECT_EQ(picture->image.getExternalStorageFile(), image->file);
    } else if (const auto* panels = std::get_if<PanelSample>(&samples[i].reading)) {
      const auto features = std::dynamic_pointer_cast<CObservation6DFeatures>(observation);
      ASSERT_TRUE(features);
      ASSERT_EQ(features->sensedFeatures.size(), panels->panels.size());
      const SeenPanel& seen = panels->panels[0];
      EXPECT_EQ(features->sensedFeatures[0].id, seen.panel);
      // MRPT's own class for a pose with an information matrix says the same of it as for a covariance.
      mrpt::poses::CPose3DPDFGaussianInf told(features->sensedFeatures[0].pose,
                                              features->sensedFeatures[0].inf_matrix);
      mrpt::poses::CPose3DPDFGaussian expected = toMrpt(seen.T_camera_panel.toYawPitchRoll()), converted;
      converted.copyFrom(told);
      EXPECT_TRUE(converted.cov.asEigen().isApprox(expected.cov.asEigen(), 1e-6));
    } else if (const auto* markers = std::get_if<MarkersSample>(&samples[i].reading)) {
      const auto bearings = std::dynamic_pointer_cast<CObservationBearingRange>(observation);
      ASSERT_TRUE(bearings && bearings->validCovariances);
      ASSERT_EQ(bearings->sensedData.size(), markers->markers.size());
      EXPECT_EQ(bearings->sensedData[0].landmarkID, markers->markers[0].id);
      EXPECT_EQ(bearings->sensedData[0].pitch, static_cast<float>(markers->markers[0].pitch_rad));
      EXPECT_EQ(bearings->sensedData[0].covariance.asEigen(), markers->markers[0].covariance);
    } else if (const auto* stereo = std::get_if<StereoSample>(&samples[i].reading)) {
      const auto pair = std::dynamic_pointer_cast<CObservationStereoImages>(observation);
      ASSERT_TRUE(pair && pair->hasImageRight && !pair->hasImageDisparity);
      EXPECT_EQ(pair->imageRight.getExternalStorageFile(), stereo->right_file);
    }
  }
}

/// Observations of MRPT's libraries of maps and vision, alone and within a frame; the program loads those
/// when it meets them.
TEST(RawlogMrptClasses, OfFurtherLibrariesAreRead) {
  loadFurtherMrptClasses();
  const auto made = [](const char* name) {
    const auto* id = findMrptClass(name);
    EXPECT_NE(id, nullptr) << name;
    auto object = std::dynamic_pointer_cast<CObservation>(std::shared_ptr(id->createObject()));
    object->timestamp = toMrpt(kStart);
    return object;
  };
  CObservationIMU ins;
  ins.sensorLabel = "INS";
  ins.timestamp = toMrpt(kStart);
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << ins;
  for (const char* name : {"mrpt::obs::CObservationRotatingScan", "mrpt::obs::CObservationVisualLandmarks",
                           "mrpt::obs::CObservationPointCloud"}) {
    CSensoryFrame frame;
    frame.insert(made(name));
    frame.insert(std::make_shared<CObservationIMU>(ins));
    archive << *made(name) << frame;
  }
  const auto file = scratchFolder() / "further.rawlog";
  writeTextFile(
      file, std::string(static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()));
  const auto result = runFathom("info " + shellQuoted(file.string()));
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.out.find(" 10 entries"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("does not have"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("reading stopped"), std::string::npos) << result.out;
}

TEST_F(RawlogMrpt, RawlogEditListsIt) {
  if (std::system("command -v rawlog-edit >/dev/null") != 0) GTEST_SKIP() << "needs rawlog-edit (mrpt-apps)";
  const std::string command = "rawlog-edit --info -i '" + file.string() + "' 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  std::array<char, 4096> piece{};
  while (std::fgets(piece.data(), static_cast<int>(piece.size()), pipe)) output += piece.data();
  EXPECT_EQ(pclose(pipe), 0) << output;
  EXPECT_NE(output.find("Overall number of objects         : 4001"), std::string::npos) << output;
  EXPECT_NE(output.find("Observations format               : Yes"), std::string::npos) << output;
  EXPECT_NE(output.find("ALTIMETER, CAMERA, COMPASS, DEPTH, DVL, DVL_BEAMS, EKF_TL2, GNSS, INS, "
                        "MARKER_SIGHTS, PANEL, STEREO, USBL"),
            std::string::npos)
      << output;
}

}  // namespace
}  // namespace fathom::test
