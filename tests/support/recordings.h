#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/random.h"
#include "recording/fields.h"
#include "recording/rawlog.h"
#include "support/random_pose.h"
#include "support/random_state.h"

/// Recordings for tests: made, written, read and compared.
namespace fathom::test {

inline const Time kStart = fromUnixSeconds(1'700'000'000.0);

inline RecordedCamera randomCamera(Random& random) {
  RecordedCamera camera;
  CameraModel& model = camera.model;
  model = {640, 480, random.uniform(500, 600), random.uniform(500, 600), 320.5, 240.25};
  for (double* coefficient : {&model.k1, &model.k2, &model.p1, &model.p2, &model.k3})
    *coefficient = 0.01 * random.normal();
  if (random.uniform() < 0.5) {
    model.lens = LensModel::rational;
    for (double* coefficient : {&model.k4, &model.k5, &model.k6}) *coefficient = 0.01 * random.normal();
  }
  camera.name = "front";
  return camera;
}

/// `field` or, every now and then, nothing.
template <class T>
std::optional<T> sometimes(Random& random, const T& field) {
  return random.uniform() < 0.8 ? std::optional<T>(field) : std::nullopt;
}

constexpr int kKinds = 13;

/// A sample of the `kind`-th kind with random content and randomly absent fields.
inline Sample randomSample(int kind, Time time, Random& random) {
  switch (kind) {
    case 0:
      return {time, labels::kIns,
              InsSample{randomPose(random), sometimes<Vector3d>(random, random.normal3()),
                        sometimes<Vector3d>(random, random.normal3()),
                        sometimes<Matrix3d>(random, randomPose(random).rotation)}};
    case 1:
      return {time, labels::kDvl,
              DvlSample{randomPose(random), sometimes<Vector3d>(random, random.normal3())}};
    case 2: {
      DvlBeamsSample beams;
      for (int k = 0; k < 4; ++k)
        beams.beams.push_back({randomPose(random), sometimes(random, random.uniform(0.5, 50.0))});
      return {time, labels::kDvlBeams, beams};
    }
    case 3:
      return {time, labels::kDepth,
              DepthSample{randomPose(random), random.uniform(1e5, 5e5),
                          sometimes(random, random.uniform(2, 25))}};
    case 4:
    case 5: {
      PoseSample pose;
      pose.T_odom_robot.mean = randomPose(random);
      Eigen::Matrix<double, 6, 6> root;
      for (double& element : root.reshaped()) element = random.normal();
      pose.T_odom_robot.covariance = root * root.transpose();
      pose.T_robot_sensor = randomPose(random);
      return {time, kind == 4 ? labels::kUsbl : "EKF_TL2", pose};
    }
    case 6:
      return {time, labels::kCamera,
              ImageSample{randomPose(random), randomCamera(random),
                          "CAMERA_" + std::to_string(random.bits() % 10000) + ".png"}};
    case 10:
      return {time, Compass::label, CompassSample{randomPose(random), random.uniform(-3, 3)}};
    case 11:
      return {time, Gnss::label,
              GnssSample{randomPose(random),
                         sometimes<Vector3d>(random, {random.uniform(-80, 80), random.uniform(-180, 180),
                                                      random.uniform(-50, 50)})}};
    case 12:
      return {time, Altimeter::label,
              AltimeterSample{randomPose(random), sometimes(random, random.uniform(0.5, 50.0))}};
    case 8: {
      PanelSample panels{randomPose(random), {}};
      for (auto count = 1 + random.bits() % 3; count > 0; --count)
        panels.panels.push_back(
            {static_cast<int>(random.bits() % 5), {randomPose(random), 1e-4 * randomCovariance<6>(random)}});
      return {time, labels::kPanel, panels};
    }
    case 9: {
      MarkersSample markers{randomPose(random), {}};
      int id = 0;
      for (auto count = 1 + random.bits() % 8; count > 0; --count)
        markers.markers.push_back({id += 1 + static_cast<int>(random.bits() % 100), random.uniform(0.3, 10),
                                   0.5 * random.normal(), 0.5 * random.normal(),
                                   1e-4 * randomCovariance<3>(random)});
      return {time, labels::kMarkerSights, markers};
    }
    default:
      return {time, labels::kStereo,
              StereoSample{randomPose(random), randomPose(random), randomCamera(random), randomCamera(random),
                           "left.png", "right, \"odd\".png"}};
  }
}

/// Samples of every kind in turn, 10 ms apart.
inline std::vector<Sample> randomSamples(int count, Random& random) {
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    samples.push_back(randomSample(i % kKinds, after(kStart, 0.01 * i), random));
  return samples;
}

inline void writeRecording(const std::filesystem::path& file, const std::vector<Sample>& samples,
                           const RecordingHeader& header = {"maps/panel.yaml", "rov.yaml", "a test"}) {
  RawlogWriter writer(file, header, kStart);
  for (const Sample& sample : samples) writer.write(sample);
  writer.finish();
}

struct ReadBack {
  std::vector<Sample> samples;  ///< without the header comment
  std::optional<RecordingLoss> loss;
};

inline ReadBack readRecording(const std::filesystem::path& file) {
  RawlogReader reader(file);
  ReadBack result;
  while (auto sample = reader.next())
    if (!std::holds_alternative<RecordingHeader>(sample->reading))
      result.samples.push_back(std::move(*sample));
  result.loss = reader.loss();
  return result;
}

/// All there is in a sample, bit for bit.
inline std::string fingerprint(const Sample& sample) {
  std::string bytes = sample.label + '|' + std::to_string(sample.reading.index()) + '|' +
                      std::to_string(sample.time.time_since_epoch().count());
  const auto add = [&bytes](const double value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof raw);
  };
  std::vector<std::optional<double>> values;
  fieldValues(sample.reading, values);
  for (const auto& value : values) {
    bytes += value ? '1' : '0';
    add(value.value_or(0.0));
  }
  for (const Pose& pose : mountings(sample.reading)) {
    for (const double x : pose.rotation.reshaped()) add(x);
    for (const double x : pose.position) add(x);
  }
  for (const auto& camera : intrinsics(sample.reading)) {
    const CameraModel& m = camera.model;
    for (const double x : {m.fx_px, m.fy_px, m.cx_px, m.cy_px, m.k1, m.k2, m.p1, m.p2, m.k3}) add(x);
    for (const double x : {camera.model.k4, camera.model.k5, camera.model.k6}) add(x);
    bytes += camera.name + std::to_string(m.width_px) + 'x' + std::to_string(m.height_px);
  }
  for (const std::string& image : imageFiles(sample.reading)) bytes += '|' + image;
  return bytes;
}

inline std::vector<std::string> fingerprints(const std::vector<Sample>& samples) {
  std::vector<std::string> result;
  result.reserve(samples.size());
  for (const Sample& sample : samples) result.push_back(fingerprint(sample));
  return result;
}

/// A gzip file's content, by zlib's own reader.
inline std::string inflated(const std::filesystem::path& file) {
  const gzFile in = gzopen(file.c_str(), "rb");
  std::string text, piece(1 << 16, '\0');
  for (int size = 0; (size = gzread(in, piece.data(), static_cast<unsigned>(piece.size()))) > 0;)
    text.append(piece, 0, static_cast<std::size_t>(size));
  gzclose(in);
  return text;
}

/// What it read, as this kind of reading.
template <class T>
const T& as(const Sample& sample) {
  return std::get<T>(sample.reading);
}

}  // namespace fathom::test
