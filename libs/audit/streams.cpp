#include "audit/streams.h"

#include <algorithm>
#include <cmath>

namespace fathom {

/// A stamp that is far ahead by mistake counts until the label's next.
double Streams::latestOfOthers(const StampStream& stream) const {
  double latest_s = 0.0;
  for (const auto& [label, other] : stamps)
    if (&other != &stream && !other.t_s.empty()) latest_s = std::max(latest_s, other.t_s.back());
  return latest_s;
}

void Streams::add(const Sample& sample) {
  if (std::holds_alternative<RecordingHeader>(sample.reading)) return;
  StampStream& stamp = stamps[sample.label];
  if (sample.time == Time{}) {
    ++stamp.without_stamp;
    return;
  }
  if (!time_zero) time_zero = sample.time;
  const double t_s = secondsBetween(*time_zero, sample.time);
  stamp.behind_s.push_back(std::max(0.0, latestOfOthers(stamp) - t_s));
  stamp.t_s.push_back(t_s);
  const Instance instance = Instance::of(sample.label);
  std::visit(
      [&]<class Entry>(const Entry& entry) {
        if constexpr (requires { add(t_s, instance, entry); }) add(t_s, instance, entry);
      },
      sample.reading);
  addRepeats(t_s, sample);
  const auto addImage = [&](const RecordedCamera& intrinsics, const std::string& file) {
    images.try_emplace(sample.label, ImageStream{intrinsics, {}}).first->second.files.push_back(file);
  };
  if (const auto* image = std::get_if<ImageSample>(&sample.reading)) addImage(image->intrinsics, image->file);
  if (const auto* pair = std::get_if<StereoSample>(&sample.reading))
    addImage(pair->left_intrinsics, pair->left_file);
}

void Repeats::add(double t_s, std::span<const double> reading) {
  const bool zero = std::all_of(reading.begin(), reading.end(), [](double x) { return std::abs(x) < 1e-9; });
  const bool same = !zero && std::equal(reading.begin(), reading.end(), last_.begin(), last_.end());
  ++readings;
  if (!same) {
    last_.assign(reading.begin(), reading.end());
    run_ = {t_s, t_s, 0};
    return;
  }
  ++repeated;
  run_.to_s = t_s;
  ++run_.repeated;
  if (run_.repeated > longest.repeated) longest = run_;
}

/// Of every instrument that has numbers of its own.
void Streams::addRepeats(double t_s, const Sample& sample) {
  const auto add = [&](const char* what, const auto& value) {
    repeats[{sample.label, what}].add(t_s, {value.data(), static_cast<std::size_t>(value.size())});
  };
  const auto addNumber = [&](const char* what, double value) {
    repeats[{sample.label, what}].add(t_s, {&value, 1});
  };
  if (const auto* imu = std::get_if<InsSample>(&sample.reading)) {
    if (imu->angular_velocity_ins) add("gyro", *imu->angular_velocity_ins);
    if (imu->specific_force_ins) add("accelerometer", *imu->specific_force_ins);
    if (imu->R_odom_ins) add("attitude", *imu->R_odom_ins);
  } else if (const auto* twist = std::get_if<DvlSample>(&sample.reading)) {
    if (twist->velocity_dvl) add("velocity", *twist->velocity_dvl);
  } else if (const auto* water = std::get_if<DepthSample>(&sample.reading)) {
    addNumber("pressure", water->pressure_pa);
  } else if (const auto* altimeter = std::get_if<AltimeterSample>(&sample.reading)) {
    if (altimeter->range_m) addNumber("range", *altimeter->range_m);
  } else if (const auto* compass = std::get_if<CompassSample>(&sample.reading)) {
    addNumber("heading", compass->heading_rad);
  } else if (const auto* gnss = std::get_if<GnssSample>(&sample.reading)) {
    if (gnss->geodetic) add("position", *gnss->geodetic);
  }
}

void Streams::add(double t_s, const Instance& instance, const InsSample& sample) {
  InsStream& stream = ins.try_emplace(instance, InsStream{sample.T_robot_ins, {}}).first->second;
  if (stream.windows.empty() || std::abs(t_s - stream.windows.back().t_s) > kInsWindow_s / 2) {
    // A stamp that steps back is the clock's fault, and told there.
    if (!stream.windows.empty() && t_s < stream.windows.back().t_s) return;
    stream.windows.emplace_back().t_s = t_s + kInsWindow_s / 2;
  }
  InsWindow& window = stream.windows.back();
  const auto addTo = [](Vector3d& mean, std::size_t& count, const std::optional<Vector3d>& value) {
    if (value && value->allFinite()) mean += (*value - mean) / static_cast<double>(++count);
  };
  addTo(window.rate, window.rates, sample.angular_velocity_ins);
  addTo(window.force, window.forces, sample.specific_force_ins);
  if (sample.R_odom_ins && sample.R_odom_ins->allFinite() && !window.attitude) {
    window.attitude = sample.R_odom_ins;
    window.attitude_t_s = t_s;
  }
}

void Streams::add(double t_s, const Instance& instance, const DvlSample& sample) {
  DvlStream& stream = dvl.try_emplace(instance, DvlStream{sample.T_robot_dvl, {}}).first->second;
  if (!sample.velocity_dvl || !sample.velocity_dvl->allFinite()) return;
  auto& all = stream.velocities;
  if (!all.empty() && t_s <= all.back().t_s) return;
  all.push_back({t_s, *sample.velocity_dvl});
}

void Streams::add(double t_s, const Instance& instance, const DepthSample& sample) {
  DepthStream& stream = depth.try_emplace(instance, DepthStream{sample.T_robot_depth, {}}).first->second;
  if (!std::isfinite(sample.pressure_pa)) return;
  auto& all = stream.pressures;
  if (!all.empty() && t_s < all.back().t_s + 0.999 / kMostPressuresHz) return;
  all.push_back({t_s, sample.pressure_pa});
}

}  // namespace fathom
