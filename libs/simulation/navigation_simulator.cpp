#include "simulation/navigation_simulator.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "sensors/vehicle.h"

namespace fathom {
namespace {

Time sampleTime(const SimulationOptions& options, std::uint64_t number, double rate_hz) {
  return after(options.start, static_cast<double>(number) / rate_hz);
}

/// What all sensors share.
struct Scene {
  const SimulationOptions& options;
  const Trajectory& trajectory;
  World<double> world;
  EffectParameters<double> effects;
  SimulatedNoise noise;

  SimulatedNoise noiseOf(const Instance& instance) const {
    SimulatedNoise own = noise;
    own.instance = instance;
    return own;
  }
  /// The motion `seconds` after the first stamp.
  KinematicState<double> at(double seconds) const { return trajectory.at(options.begin_s + seconds); }
  bool covers(double seconds) const {
    const double time_s = options.begin_s + seconds;
    constexpr double kTick_s = 1e-6;  // stamps are rounded to 0.1 us: the last may lie just beyond the end
    return time_s >= trajectory.start_s() - kTick_s && time_s <= trajectory.end_s() + kTick_s;
  }
};

/// One sensor's samples, at a fixed rate.
class Entries {
 public:
  Entries(const Scene& scene, std::string label, double rate_hz)
      : scene_(scene), label_(std::move(label)), rate_hz_(rate_hz) {}
  virtual ~Entries() = default;
  Entries(const Entries&) = delete;
  Entries& operator=(const Entries&) = delete;

  Time nextTime() const { return sampleTime(scene_.options, count_, rate_hz_); }
  Sample next() {
    const Time time = nextTime();
    ++count_;
    return {time, label_, read(secondsBetween(scene_.options.start, time))};
  }

 protected:
  /// The reading stamped `seconds` after the first stamp.
  virtual Reading read(double seconds) = 0;
  const Scene& scene_;

 private:
  std::string label_;
  double rate_hz_;
  std::uint64_t count_ = 0;
};

/// The entries of an instrument, from the state at the time of validity.
template <class Instrument>
class InstrumentEntries : public Entries {
 public:
  InstrumentEntries(const Scene& scene, const typename Instrument::Sheet& sheet, const Instance& instance)
      : Entries(scene, instance.label(Instrument::label), sheet.rate_hz),
        instance_(instance),
        simulated_(sheet, scene.noiseOf(instance)) {}

 private:
  Reading read(double seconds) override {
    Inputs<double> in{{}, scene_.world, scene_.effects.at<double>(seconds, instance_), seconds};
    if constexpr (requires { simulated_.draw(in.effects); }) simulated_.draw(in.effects);
    const double valid_s = seconds + in.validityOffset<typename Instrument::Instrument>();
    if (!scene_.covers(valid_s)) return simulated_.read(nullptr);
    in.state = scene_.at(valid_s);
    return simulated_.read(&in);
  }

  Instance instance_;
  typename Instrument::Simulated simulated_;
};

class CameraEntries : public Entries {
 public:
  CameraEntries(const Scene& scene, const CameraSheet& sheet, const Instance& instance)
      : Entries(scene, instance.label(sheet.T_left_right ? labels::kStereo : labels::kCamera), sheet.rate_hz),
        sheet_(sheet),
        instance_(instance) {}

 private:
  Reading read(double) override {
    const auto files = imageFiles(sheet_, scene_.options.image_format, image_++, instance_);
    const RecordedCamera intrinsics = recordedCamera(sheet_.model);
    if (!sheet_.T_left_right) return ImageSample{sheet_.T_robot_camera, intrinsics, files[0]};
    return StereoSample{
        sheet_.T_robot_camera, *sheet_.T_left_right, intrinsics, intrinsics, files[0], files[1]};
  }

  const CameraSheet& sheet_;
  Instance instance_;
  std::size_t image_ = 0;
};

class TruthEntries : public Entries {
 public:
  explicit TruthEntries(const Scene& scene) : Entries(scene, labels::kTruth, scene.options.truth_rate_hz) {}

 private:
  Reading read(double seconds) override {
    const auto state = scene_.at(seconds);
    PoseSample sample;
    sample.T_odom_robot.mean = {state.R_odom_robot, state.position_odom};
    sample.T_odom_robot.covariance.diagonal().setConstant(1e-12);
    return sample;
  }
};

std::vector<std::unique_ptr<Entries>> channelsOf(const Scene& scene) {
  const Vehicle& vehicle = scene.options.vehicle;
  std::vector<std::unique_ptr<Entries>> channels;
  forEachInstrument([&]<class Instrument>() {
    vehicle.forEachInstance([&](const Instance& instance, const SensorsOnBoard& sensors) {
      const auto& sheet = sensors.*Instrument::on_board;
      if (sheet && !Instrument::mountings(*sheet).empty())  // a DVL without beams has no entries of theirs
        channels.push_back(std::make_unique<InstrumentEntries<Instrument>>(scene, *sheet, instance));
    });
  });
  vehicle.forEachInstance([&](const Instance& instance, const SensorsOnBoard& sensors) {
    if (sensors.camera && scene.options.images)
      channels.push_back(std::make_unique<CameraEntries>(scene, *sensors.camera, instance));
  });
  channels.push_back(std::make_unique<TruthEntries>(scene));
  return channels;
}

}  // namespace

Time imageTime(const SimulationOptions& options, std::size_t image) {
  return sampleTime(options, image, options.vehicle.camera.value().rate_hz);
}

std::vector<std::string> imageFiles(const CameraSheet& camera, const ImageFormat& format, std::size_t image,
                                    const Instance& instance) {
  std::string number = std::to_string(image);
  number.insert(0, number.size() < 4 ? 4 - number.size() : 0, '0');
  const std::string ending = format.extension();
  const std::string folder = instance.isFirst() ? "" : std::string(instance.name()) + "/";
  if (!camera.T_left_right) return {folder + "CAMERA_" + number + ending};
  return {folder + "STEREO_" + number + "_left" + ending, folder + "STEREO_" + number + "_right" + ending};
}

double simulatedDuration_s(const SimulationOptions& options, const Trajectory& trajectory) {
  const double left_s = trajectory.end_s() - options.begin_s;
  if (options.begin_s < trajectory.start_s() || left_s < 0)
    throw Error("simulation", "begin", "lies outside the trajectory");
  if (!options.duration_s) return left_s;
  if (!(*options.duration_s > 0)) throw Error("simulation", "duration", "must be greater than zero");
  if (*options.duration_s > left_s)
    throw Error("simulation", "duration",
                "is longer than the trajectory, which has " + std::to_string(left_s) + " s");
  return *options.duration_s;
}

struct NavigationSimulator::Impl {
  Impl(const SimulationOptions& options, const Trajectory& trajectory)
      : scene{options,
              trajectory,
              {options.vehicle.gravityOdom(), options.sea_floor_z_m},
              options.effects,
              {options.seed, options.noise, options.beam_min_range_m, options.beam_max_range_m}},
        duration_s(simulatedDuration_s(options, trajectory)),
        end(after(options.start, duration_s)),
        channels(channelsOf(scene)) {}

  Scene scene;
  double duration_s;
  Time end;
  std::vector<std::unique_ptr<Entries>> channels;
};

NavigationSimulator::NavigationSimulator(const SimulationOptions& options, const Trajectory& trajectory)
    : impl_(std::make_unique<Impl>(options, trajectory)) {}
NavigationSimulator::~NavigationSimulator() = default;

double NavigationSimulator::duration_s() const { return impl_->duration_s; }

std::optional<Sample> NavigationSimulator::next() {
  const auto earlier = [](const auto& a, const auto& b) { return a->nextTime() < b->nextTime(); };
  Entries& channel = **std::min_element(impl_->channels.begin(), impl_->channels.end(), earlier);
  if (channel.nextTime() > impl_->end) return std::nullopt;
  return channel.next();
}

void simulateNavigation(const SimulationOptions& options, const Trajectory& trajectory,
                        const std::function<void(const Sample&)>& sink) {
  NavigationSimulator simulator(options, trajectory);
  while (const auto sample = simulator.next()) sink(*sample);
}

}  // namespace fathom
