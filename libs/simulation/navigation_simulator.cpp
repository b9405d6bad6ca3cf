#include "simulation/navigation_simulator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/gauss_markov.h"
#include "core/random.h"
#include "sensors/models.h"

namespace fathom {
namespace {

/// Numbers of the random streams: fixed, so that a new sensor changes no other's noise.
enum Stream : std::uint64_t {
  kInsWhite,
  kInsBias,
  kInsAttitude,
  kDvlVelocity,
  kDvlRange,
  kDepthNoise,
  kUsblNoise
};

Time sampleTime(const SimulationOptions& options, std::uint64_t number, double rate_hz) {
  return after(options.start, static_cast<double>(number) / rate_hz);
}

/// What all sensors share.
struct Scene {
  const SimulationOptions& options;
  const Trajectory& trajectory;
  World<double> world;
  EffectParameters<double> effects;

  Random stream(Stream number) const { return Random::stream(options.seed, number); }
  double sigma(double sheet_sigma) const { return options.noise ? sheet_sigma : 0.0; }
  /// The motion `seconds` after the first stamp.
  KinematicState<double> at(double seconds) const { return trajectory.at(options.begin_s + seconds); }
  bool covers(double seconds) const {
    const double time_s = options.begin_s + seconds;
    constexpr double kTick_s = 1e-6;  // stamps are rounded to 0.1 us: the last may lie just beyond the end
    return time_s >= trajectory.start_s() - kTick_s && time_s <= trajectory.end_s() + kTick_s;
  }
};

/// One sensor's samples, at a fixed rate.
class Channel {
 public:
  Channel(const Scene& scene, const char* label, double rate_hz)
      : scene_(scene), label_(label), rate_hz_(rate_hz) {}
  virtual ~Channel() = default;
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

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
  const char* label_;
  double rate_hz_;
  std::uint64_t count_ = 0;
};

/// A bias that drifts, of a stationary sigma; begins in its stationary distribution.
class DrawnBias {
 public:
  DrawnBias(double sigma, double time_constant_s, double interval_s)
      : sigma_(sigma), further_(interval_s, time_constant_s) {}

  std::array<double, 3> next(Random& random) {
    value_ = step_.decay * value_ + step_.innovation() * (sigma_ * random.normal3());
    step_ = further_;
    return {value_.x(), value_.y(), value_.z()};
  }

 private:
  double sigma_;
  GaussMarkovStep further_, step_;
  Vector3d value_ = Vector3d::Zero();
};

class InsChannel : public Channel {
 public:
  InsChannel(const Scene& scene, const InsSheet& sheet)
      : Channel(scene, labels::kIns, sheet.rate_hz),
        sheet_(sheet),
        gyro_bias_(sheet.gyro_bias_sigma_rad_s, sheet.bias_time_constant_s, 1.0 / sheet.rate_hz),
        accelerometer_bias_(sheet.accelerometer_bias_sigma_m_s2, sheet.bias_time_constant_s,
                            1.0 / sheet.rate_hz),
        white_(scene.stream(kInsWhite)),
        bias_(scene.stream(kInsBias)),
        attitude_(scene.stream(kInsAttitude)) {}

 private:
  Reading read(double seconds) override {
    EffectParameters<double> effects = scene_.effects.at<double>(seconds);
    if (scene_.options.noise) {
      effects.add<GyroBias>(gyro_bias_.next(bias_));
      effects.add<AccelerometerBias>(accelerometer_bias_.next(bias_));
    }
    const Vector3d gyro_error = scene_.sigma(sheet_.gyro_sigma_rad_s) * white_.normal3(),
                   force_error = scene_.sigma(sheet_.accelerometer_sigma_m_s2) * white_.normal3();
    InsSample sample{sheet_.T_robot_ins, {}, {}, {}};
    const double valid_s = seconds + validityOffset<Sensor::ins>(effects, seconds);
    if (!scene_.covers(valid_s)) return sample;
    const auto state = scene_.at(valid_s);
    sample.angular_velocity_ins = predictGyro(state, sheet_.T_robot_ins, effects, seconds) + gyro_error;
    sample.specific_force_ins =
        predictSpecificForce(state, scene_.world, sheet_.T_robot_ins, effects, seconds) + force_error;
    if (sheet_.attitude_sigma_rad) {
      const Vector3d error = scene_.sigma(*sheet_.attitude_sigma_rad) * attitude_.normal3();
      sample.R_odom_ins =
          predictAttitude(state, sheet_.T_robot_ins, effects, seconds) * expSO3<double>(error);
    }
    return sample;
  }

  const InsSheet& sheet_;
  DrawnBias gyro_bias_, accelerometer_bias_;
  Random white_, bias_, attitude_;
};

/// Ranges without noise; absent where the beam looks up or the floor is out of reach.
std::vector<std::optional<double>> echoes(const Scene& scene, const DvlSheet& sheet,
                                          const KinematicState<double>& state, double t_s) {
  std::vector<std::optional<double>> ranges_m;
  for (std::size_t k = 0; k < sheet.beam_azimuths_rad.size(); ++k) {
    const double range_m =
        predictBeamRange(state, scene.world, sheet.T_robot_dvl, sheet.T_robot_beam(k), scene.effects, t_s);
    const bool heard = range_m >= scene.options.beam_min_range_m && range_m <= scene.options.beam_max_range_m;
    ranges_m.push_back(heard ? std::optional(range_m) : std::nullopt);
  }
  return ranges_m;
}

class DvlChannel : public Channel {
 public:
  DvlChannel(const Scene& scene, const DvlSheet& sheet)
      : Channel(scene, labels::kDvl, sheet.rate_hz), sheet_(sheet), random_(scene.stream(kDvlVelocity)) {}

 private:
  Reading read(double seconds) override {
    const double xy = scene_.sigma(sheet_.velocity_sigma_xy_m_s),
                 z = scene_.sigma(sheet_.velocity_sigma_z_m_s);
    const Vector3d error = Vector3d(xy, xy, z).cwiseProduct(random_.normal3());
    const double valid_s = seconds + validityOffset<Sensor::dvl>(scene_.effects, seconds);
    DvlSample sample{sheet_.T_robot_dvl, {}};
    if (!scene_.covers(valid_s)) return sample;
    const auto state = scene_.at(valid_s);
    if (hasBottomLock(state, seconds))
      sample.velocity_dvl = predictDvlVelocity(state, sheet_.T_robot_dvl, scene_.effects, seconds) + error;
    return sample;
  }

  bool hasBottomLock(const KinematicState<double>& state, double t_s) const {
    const auto ranges_m = echoes(scene_, sheet_, state, t_s);
    const auto heard = std::count_if(ranges_m.begin(), ranges_m.end(), [](auto& r) { return r.has_value(); });
    return heard >= std::min<std::ptrdiff_t>(3, std::ssize(ranges_m));
  }

  const DvlSheet& sheet_;
  Random random_;
};

class DvlBeamsChannel : public Channel {
 public:
  DvlBeamsChannel(const Scene& scene, const DvlSheet& sheet)
      : Channel(scene, labels::kDvlBeams, sheet.rate_hz), sheet_(sheet), random_(scene.stream(kDvlRange)) {}

 private:
  Reading read(double seconds) override {
    const double valid_s = seconds + validityOffset<Sensor::dvl>(scene_.effects, seconds);
    std::vector<std::optional<double>> ranges_m(sheet_.beam_azimuths_rad.size());
    if (scene_.covers(valid_s)) ranges_m = echoes(scene_, sheet_, scene_.at(valid_s), seconds);
    DvlBeamsSample sample;
    for (std::size_t k = 0; k < ranges_m.size(); ++k) {
      const double error_m = scene_.sigma(sheet_.range_sigma_m) * random_.normal();
      // A range of 0 means "no echo" in a recording, so noise must not reach it.
      if (ranges_m[k]) ranges_m[k] = std::max(*ranges_m[k] + error_m, 1e-3);
      sample.beams.push_back({sheet_.T_robot_beam(k), ranges_m[k]});
    }
    return sample;
  }

  const DvlSheet& sheet_;
  Random random_;
};

class DepthChannel : public Channel {
 public:
  DepthChannel(const Scene& scene, const DepthSheet& sheet)
      : Channel(scene, labels::kDepth, sheet.rate_hz), sheet_(sheet), random_(scene.stream(kDepthNoise)) {
    offset_pa_ = scene.sigma(sheet.pressure_offset_sigma_pa) * random_.normal();
  }

 private:
  Reading read(double seconds) override {
    DepthSample sample;
    sample.T_robot_depth = sheet_.T_robot_depth;
    auto effects = scene_.effects.at<double>(seconds);
    if (scene_.options.noise) effects.add<PressureOffset>({offset_pa_});
    sample.pressure_pa =
        predictPressure(scene_.at(seconds), scene_.world, sheet_, sheet_.T_robot_depth, effects, seconds) +
        scene_.sigma(sheet_.pressure_sigma_pa) * random_.normal();
    return sample;
  }

  const DepthSheet& sheet_;
  Random random_;
  double offset_pa_;
};

class UsblChannel : public Channel {
 public:
  UsblChannel(const Scene& scene, const UsblSheet& sheet)
      : Channel(scene, labels::kUsbl, sheet.rate_hz), sheet_(sheet), random_(scene.stream(kUsblNoise)) {}

 private:
  Reading read(double seconds) override {
    const Vector3d error = scene_.sigma(sheet_.position_sigma_m) * random_.normal3();
    const Vector3d position = predictUsbl(scene_.at(seconds), sheet_.T_robot_usbl) + error;
    PoseSample sample;
    sample.T_robot_sensor = sheet_.T_robot_usbl;
    sample.T_odom_robot.mean = Pose{Matrix3d::Identity(), position};
    Matrix6d& covariance = sample.T_odom_robot.covariance;
    covariance.setZero();
    covariance.diagonal().head<3>().setConstant(std::pow(sheet_.position_sigma_m, 2));
    covariance.diagonal().tail<3>().setConstant(1e6);
    return sample;
  }

  const UsblSheet& sheet_;
  Random random_;
};

class CameraChannel : public Channel {
 public:
  CameraChannel(const Scene& scene, const CameraSheet& sheet)
      : Channel(scene, sheet.T_left_right ? labels::kStereo : labels::kCamera, sheet.rate_hz),
        sheet_(sheet) {}

 private:
  Reading read(double) override {
    const auto files = imageFiles(sheet_, scene_.options.image_format, image_++);
    const RecordedCamera intrinsics = recordedCamera(sheet_.model);
    if (!sheet_.T_left_right) return ImageSample{sheet_.T_robot_camera, intrinsics, files[0]};
    return StereoSample{
        sheet_.T_robot_camera, *sheet_.T_left_right, intrinsics, intrinsics, files[0], files[1]};
  }

  const CameraSheet& sheet_;
  std::size_t image_ = 0;
};

class TruthChannel : public Channel {
 public:
  explicit TruthChannel(const Scene& scene) : Channel(scene, labels::kTruth, scene.options.truth_rate_hz) {}

 private:
  Reading read(double seconds) override {
    const auto state = scene_.at(seconds);
    PoseSample sample;
    sample.T_odom_robot.mean = Pose{state.R_odom_robot, state.position_odom};
    Matrix6d& covariance = sample.T_odom_robot.covariance;
    covariance.setZero();
    covariance.diagonal().setConstant(1e-12);
    return sample;
  }
};

std::vector<std::unique_ptr<Channel>> channelsOf(const Scene& scene) {
  const Vehicle& vehicle = scene.options.vehicle;
  std::vector<std::unique_ptr<Channel>> channels;
  if (vehicle.ins) channels.push_back(std::make_unique<InsChannel>(scene, *vehicle.ins));
  if (vehicle.dvl) channels.push_back(std::make_unique<DvlChannel>(scene, *vehicle.dvl));
  if (vehicle.dvl && !vehicle.dvl->beam_azimuths_rad.empty())
    channels.push_back(std::make_unique<DvlBeamsChannel>(scene, *vehicle.dvl));
  if (vehicle.depth) channels.push_back(std::make_unique<DepthChannel>(scene, *vehicle.depth));
  if (vehicle.usbl) channels.push_back(std::make_unique<UsblChannel>(scene, *vehicle.usbl));
  if (vehicle.camera && scene.options.images)
    channels.push_back(std::make_unique<CameraChannel>(scene, *vehicle.camera));
  channels.push_back(std::make_unique<TruthChannel>(scene));
  return channels;
}

}  // namespace

Time imageTime(const SimulationOptions& options, std::size_t image) {
  return sampleTime(options, image, options.vehicle.camera.value().rate_hz);
}

std::vector<std::string> imageFiles(const CameraSheet& camera, const ImageFormat& format, std::size_t image) {
  std::string number = std::to_string(image);
  number.insert(0, number.size() < 4 ? 4 - number.size() : 0, '0');
  const std::string ending = format.extension();
  if (!camera.T_left_right) return {"CAMERA_" + number + ending};
  return {"STEREO_" + number + "_left" + ending, "STEREO_" + number + "_right" + ending};
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
      : scene{options, trajectory, {options.vehicle.gravityOdom(), options.sea_floor_z_m}, options.effects},
        duration_s(simulatedDuration_s(options, trajectory)),
        end(after(options.start, duration_s)),
        channels(channelsOf(scene)) {}

  Scene scene;
  double duration_s;
  Time end;
  std::vector<std::unique_ptr<Channel>> channels;
};

NavigationSimulator::NavigationSimulator(const SimulationOptions& options, const Trajectory& trajectory)
    : impl_(std::make_unique<Impl>(options, trajectory)) {}
NavigationSimulator::~NavigationSimulator() = default;

double NavigationSimulator::duration_s() const { return impl_->duration_s; }

std::optional<Sample> NavigationSimulator::next() {
  const auto earlier = [](const auto& a, const auto& b) { return a->nextTime() < b->nextTime(); };
  Channel& channel = **std::min_element(impl_->channels.begin(), impl_->channels.end(), earlier);
  if (channel.nextTime() > impl_->end) return std::nullopt;
  return channel.next();
}

void simulateNavigation(const SimulationOptions& options, const Trajectory& trajectory,
                        const std::function<void(const Sample&)>& sink) {
  NavigationSimulator simulator(options, trajectory);
  while (const auto sample = simulator.next()) sink(*sample);
}

}  // namespace fathom
