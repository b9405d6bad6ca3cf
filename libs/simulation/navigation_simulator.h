#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "effects/registry.h"
#include "recording/samples.h"
#include "sensors/vehicle.h"
#include "simulation/image_format.h"
#include "simulation/trajectory.h"

namespace fathom {

/// What is simulated. Which sensors there are, how often they read and how noisy they are says the vehicle.
struct SimulationOptions {
  Vehicle vehicle;
  EffectParameters<double> effects;  ///< physics that the nominal model leaves out; biases are drawn on top
  double sea_floor_z_m = -6.0;       ///< flat, height in odom
  std::uint64_t seed = 1;
  bool noise = true;  ///< false: no white noise, no random bias, no random pressure offset

  Time start = fromUnixSeconds(1'700'000'000);  ///< stamp of the first sample
  double begin_s = 0.0;                         ///< the trajectory's time at `start`
  std::optional<double> duration_s;             ///< default: to the trajectory's end

  double truth_rate_hz = 10.0;
  bool images = false;  ///< entries of the camera; the image files are simulateImages()' part
  ImageFormat image_format;
  /// A beam has an echo between these slant ranges; the DVL has bottom lock with echoes on three beams.
  double beam_min_range_m = 0.05, beam_max_range_m = 50.0;
};

/// Runs the forward model (libs/sensors) along the trajectory, one sample a call, in time order: sample k
/// of a sensor at start + k / rate, rounded to the 100 ns tick. Keeps nothing of what it has handed out.
///
/// - INS: gyro, specific force; attitude where the vehicle file has attitude_sigma_deg. White noise and
///   first-order Gauss-Markov biases, which begin stationary and enter through the bias effects.
/// - DVL, DVL_BEAMS: one ping for both; no velocity without bottom lock. A beam without echo has no range.
/// - These show the motion at stamp + validityOffset(), and have no values where that is outside the
///   trajectory.
/// - DEPTH: white noise and one random offset a run, which enters through the effect pressure-offset.
/// - USBL: position of the transponder, 3 x 3 block of its covariance; orientation variance 1e6 rad².
/// - CAMERA, or STEREO where the camera has a second one: names of files (imageFiles), intrinsics.
/// - DVL.2 and the like: the same of the vehicle's other instances, each by its own specification.
/// - TRUTH: T_odom_robot, covariance 1e-12 on the diagonal.
///
/// Each sensor draws from a random stream of its own: leaving one out changes no other.
class NavigationSimulator {
 public:
  /// Both are referred to and must outlive it. Throws Error where begin or
  /// duration lie outside the trajectory.
  NavigationSimulator(const SimulationOptions& options, const Trajectory& trajectory);
  ~NavigationSimulator();
  NavigationSimulator(const NavigationSimulator&) = delete;
  NavigationSimulator& operator=(const NavigationSimulator&) = delete;

  std::optional<Sample> next();  ///< nothing at the end
  double duration_s() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The same, pushed: hands every sample to the sink.
void simulateNavigation(const SimulationOptions& options, const Trajectory& trajectory,
                        const std::function<void(const Sample&)>& sink);

/// Stamp of a simulated image, the vehicle having a camera.
Time imageTime(const SimulationOptions& options, std::size_t image);
/// Names of its files: CAMERA_0000.png, or STEREO_0000_left.png and STEREO_0000_right.png; .jpg for JPEG.
/// Those of a vehicle's other cameras are in a folder of their instance's name.
std::vector<std::string> imageFiles(const CameraSheet& camera, const ImageFormat& format, std::size_t image,
                                    const Instance& instance = {});

/// How long a simulation lasts, s: duration_s, or what is left of the trajectory. Throws Error as above.
double simulatedDuration_s(const SimulationOptions& options, const Trajectory& trajectory);

}  // namespace fathom
