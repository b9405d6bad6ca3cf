#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "sources/degraded_source.h"
#include "support/recordings.h"

/// Streams of samples for tests of sources.
namespace fathom::test {

/// Samples from a list.
class ListSource : public SampleSource {
 public:
  explicit ListSource(std::vector<Sample> samples) : samples_(std::move(samples)) {}

  const RecordingHeader& header() const override { return header_; }
  std::optional<Sample> next() override {
    return given_ < samples_.size() ? std::optional(samples_[given_++]) : std::nullopt;
  }
  std::filesystem::path imageFolder() const override { return "/images"; }
  double fraction() const override {
    return static_cast<double>(given_) / static_cast<double>(samples_.size());
  }

 private:
  std::vector<Sample> samples_;
  RecordingHeader header_{"panel.yaml", "rov.yaml", "a list"};
  std::size_t given_ = 0;
};

/// A stage by what YAML says of it.
inline DegradationStage stage(const std::string& text) {
  const YamlFile yaml = YamlFile::parse("stages: [{" + text + "}]", "stage.yaml");
  DegradationStage result = parseDegradationStage(yaml.root().maps("stages").front());
  yaml.rejectUnknownKeys();
  return result;
}

inline std::vector<Sample> drain(SampleSource& source) {
  std::vector<Sample> samples;
  while (auto sample = source.next()) samples.push_back(std::move(*sample));
  return samples;
}

inline std::vector<Sample> degraded(const std::vector<Sample>& samples,
                                    std::vector<DegradationStage> stages) {
  DegradedSource source(std::make_unique<ListSource>(samples), std::move(stages));
  return drain(source);
}

inline Time at(double seconds) { return after(kStart, seconds); }

/// A panel somewhere before a camera that sits aslant, and both forms of landmark that tell of it.
struct LandmarkScene {
  Pose T_odom_panel{rotationFromYawPitchRoll(3.0, 0.1, 1.5), {6, 0, -1.2}};
  Pose T_robot_camera{rotationFromYawPitchRoll(-1.5, 0.1, -1.6), {0.35, 0.02, 0.05}};

  Sample markers(Time time, const Pose& T_odom_robot) const {
    PoseSample sample;
    sample.T_odom_robot.mean = T_odom_robot;
    sample.T_odom_robot.covariance.setIdentity();
    return {time, labels::kMarkers, sample};
  }
  Sample panel(Time time, const Pose& T_odom_robot) const {
    const Pose T_odom_camera = T_odom_robot * T_robot_camera;
    return {
        time, labels::kPanel,
        PanelSample{T_robot_camera, {{0, {T_odom_camera.inverse() * T_odom_panel, Matrix6d::Identity()}}}}};
  }
  /// The robot's pose that either form implies.
  Pose robot(const Sample& sample) const {
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading)) return pose->T_odom_robot.mean;
    const auto& seen = std::get<PanelSample>(sample.reading);
    return T_odom_panel * (seen.T_robot_camera * seen.panels.at(0).T_camera_panel.pose).inverse();
  }
};

/// Samples of every sensor with random content, each complete, `seconds` long: INS at 20 Hz, others at 2 Hz.
inline std::vector<Sample> everySensor(double seconds, std::uint64_t seed = 1) {
  Random random(seed);
  const LandmarkScene scene;
  std::vector<Sample> samples;
  for (int i = 0; 0.05 * i < seconds; ++i) {
    const Time time = at(0.05 * i);
    samples.push_back(randomSample(0, time, random));
    if (i % 10 != 0) continue;
    for (const int kind : {1, 2, 3, 4, 6, 7}) samples.push_back(randomSample(kind, time, random));
    const Pose T_odom_robot = randomPose(random);
    samples.push_back(scene.markers(time, T_odom_robot));
    samples.push_back(scene.panel(time, T_odom_robot));
    samples.push_back(
        {time, labels::kTruth, std::get<PoseSample>(scene.markers(time, T_odom_robot).reading)});
  }
  return samples;
}

/// All there is in a sample, panels included.
inline std::string completeFingerprint(const Sample& sample) {
  std::string bytes = fingerprint(sample);
  if (const auto* panels = std::get_if<PanelSample>(&sample.reading))
    for (const SeenPanel& seen : panels->panels) {
      const auto add = [&](const auto& m) {
        for (const double x : m.reshaped()) bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
      };
      add(seen.T_camera_panel.pose.rotation);
      add(seen.T_camera_panel.pose.position);
      add(seen.T_camera_panel.covariance);
    }
  return bytes;
}

/// Of the samples that `keep` chooses.
template <class Keep>
std::vector<std::string> fingerprintsWhere(const std::vector<Sample>& samples, Keep keep) {
  std::vector<std::string> result;
  for (const Sample& sample : samples)
    if (keep(sample)) result.push_back(completeFingerprint(sample));
  return result;
}
inline std::vector<std::string> completeFingerprints(const std::vector<Sample>& samples) {
  return fingerprintsWhere(samples, [](const Sample&) { return true; });
}

inline std::vector<Sample> labelled(const std::vector<Sample>& samples, const std::string& label) {
  std::vector<Sample> result;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(result),
               [&](const Sample& sample) { return sample.label == label; });
  return result;
}

}  // namespace fathom::test
