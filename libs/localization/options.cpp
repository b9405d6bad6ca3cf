#include "localization/options.h"

#include <sstream>

#include "core/text.h"
#include "core/yaml.h"

namespace fathom {

namespace {

/// Of those that the filter fuses.
Channel readChannel(const YamlMap& y, const std::string& key, const std::string& name) {
  const auto found = std::find_if(kEveryChannel.begin(), kEveryChannel.end(), [&](Channel channel) {
    return textOf(channel).is_filtered && textOf(channel).id == name;
  });
  if (found != kEveryChannel.end()) return *found;
  std::string known;
  for (const Channel channel : kEveryChannel)
    if (textOf(channel).is_filtered) known.append(known.empty() ? "" : ", ").append(nameOf(channel));
  throw y.error(key,
                std::string("unknown channel `").append(name).append("` (known: ").append(known).append(")"));
}

std::vector<Channel> readChannels(const YamlMap& y) {
  std::vector<Channel> channels;
  for (const std::string& name : y.texts("fuse")) channels.push_back(readChannel(y, "fuse", name));
  if (channels.empty()) throw y.error("fuse", "names no channel");
  return channels;
}

/// A density per axis: one number for all three, or [x, y, z].
void readDensity(const YamlMap& y, const std::string& key, Vector3d& density) {
  if (!y.has(key)) return;
  density = y.isList(key) ? y.vector3(key) : Vector3d::Constant(y.number(key));
  if (density.minCoeff() < 0.0) throw y.error(key, "must not be negative");
}

ProcessNoise readProcessNoise(const YamlMap& y, ProcessNoise noise) {
  readDensity(y, "position_m2_s", noise.position);
  readDensity(y, "orientation_rad2_s", noise.orientation);
  readDensity(y, "velocity_m2_s3", noise.velocity);
  readDensity(y, "angular_velocity_rad2_s3", noise.angular_velocity);
  readDensity(y, "acceleration_m2_s5", noise.acceleration);
  if (y.has("sea_floor_m2_s")) noise.sea_floor = y.notNegative("sea_floor_m2_s");
  return noise;
}

DrivingNoise readDriving(const YamlMap& y, const ProcessNoise& otherwise) {
  DrivingNoise noise{otherwise.angular_velocity, otherwise.acceleration};
  readDensity(y, "angular_velocity_rad2_s3", noise.angular_velocity);
  readDensity(y, "acceleration_m2_s5", noise.acceleration);
  return noise;
}

/// Sections `transit` and `turning` of the process noise.
void readRegimes(const YamlMap& y, LocalizationOptions& options) {
  if (y.has("transit")) {
    const YamlMap transit = y.map("transit");
    if (transit.has("above_m_s")) options.regimes.transit_m_s = transit.positive("above_m_s");
    options.driven[Regime::transit] = readDriving(transit, options.noise);
  }
  if (y.has("turning")) {
    const YamlMap turning = y.map("turning");
    if (turning.has("above_deg_s")) options.regimes.turning_rad_s = radians(turning.positive("above_deg_s"));
    options.driven[Regime::turning] = readDriving(turning, options.noise);
  }
}

BiasNoise readBiases(const YamlMap& y) {
  return {radians(y.notNegative("gyro_sigma_deg_s")), y.notNegative("accelerometer_sigma_m_s2"),
          y.positive("time_constant_s")};
}

/// Whether it adapts.
bool readNoise(const YamlMap& y) {
  const std::string noise = y.text("noise");
  if (noise != "adaptive" && noise != "fixed") throw y.error("noise", "must be adaptive or fixed");
  return noise == "adaptive";
}

Gate readGate(const YamlMap& y) {
  Gate gate;
  const std::string kind = y.text("kind");
  if (kind == "none") {
    gate.kind = Gate::Kind::none;
  } else if (kind == "chi-square") {
    y.read("probability", gate.probability);
    if (gate.probability <= 0.0 || gate.probability >= 1.0)
      throw y.error("probability", "must lie between 0 and 1");
  } else if (kind == "fixed") {
    gate.kind = Gate::Kind::fixed;
    gate.max_position_m = y.positive("max_position_m");
    gate.max_angle_rad = radians(y.positive("max_angle_deg"));
  } else {
    throw y.error("kind", "must be none, chi-square or fixed");
  }
  return gate;
}

LandmarkOptions readLandmarks(const YamlMap& y, LandmarkOptions landmarks) {
  if (y.has("pose")) {
    const std::string form = y.text("pose");
    if (form != "mean" && form != "joint") throw y.error("pose", "must be mean or joint");
    landmarks.form = form == "mean" ? LandmarkOptions::Form::mean : LandmarkOptions::Form::joint;
  }
  if (y.has("position_sigma_m")) landmarks.position_sigma_m = y.positive("position_sigma_m");
  if (y.has("angle_sigma_deg")) landmarks.angle_sigma_rad = radians(y.positive("angle_sigma_deg"));
  return landmarks;
}

LostOptions readLost(const YamlMap& y, LostOptions lost) {
  if (y.has("position_sigma_m")) lost.position_sigma_m = y.positive("position_sigma_m");
  if (y.has("angle_sigma_deg")) lost.angle_sigma_rad = radians(y.positive("angle_sigma_deg"));
  if (y.has("contradiction_s")) lost.contradiction_s = y.positive("contradiction_s");
  if (y.has("blind_s")) lost.blind_s = y.positive("blind_s");
  return lost;
}

void readPositive(const YamlMap& y, const std::string& key, double& value) {
  if (y.has(key)) value = y.positive(key);
}

/// `bases` counts the files that led here by their key `base`.
LocalizationOptions readOnto(LocalizationOptions options, const std::filesystem::path& file, int bases) {
  constexpr int kMostBases = 20;
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  if (bases > kMostBases) throw y.error("base", "these files name each other in a circle");
  if (y.has("base")) options = readOnto(std::move(options), file.parent_path() / y.text("base"), bases + 1);
  y.read("task", options.task);
  if (y.has("fuse")) options.fuse = readChannels(y);
  y.read("bias_states", options.bias_states);
  if (y.has("process_noise")) options.noise = readProcessNoise(y.map("process_noise"), options.noise);
  if (y.has("process_noise")) readRegimes(y.map("process_noise"), options);
  if (y.has("sigma_times")) {
    const YamlMap times = y.map("sigma_times");
    for (const std::string& name : times.keys())
      options.sigma_times[readChannel(y, "sigma_times", name)] = times.positive(name);
  }
  if (y.has("biases")) options.biases = readBiases(y.map("biases"));
  if (y.has("noise")) options.adapts_noise = readNoise(y);
  if (y.has("gate")) options.gate = readGate(y.map("gate"));
  if (y.has("landmarks")) options.landmarks = readLandmarks(y.map("landmarks"), options.landmarks);
  if (y.has("lost")) options.lost = readLost(y.map("lost"), options.lost);
  if (y.has("history_s")) options.history_s = y.notNegative("history_s");
  readPositive(y, "gap_s", options.gap_s);
  readPositive(y, "alignment_s", options.alignment_s);
  if (y.has("first_fix_s")) options.first_fix_s = y.notNegative("first_fix_s");
  readPositive(y, "output_rate_hz", options.output_rate_hz);
  y.read("smooth", options.smooth);
  yaml.rejectUnknownKeys();
  return options;
}

std::string axes(const Vector3d& v) {
  return print("[%s, %s, %s]", shortest(v.x()).c_str(), shortest(v.y()).c_str(), shortest(v.z()).c_str());
}

std::string channelsText(const std::vector<Channel>& channels) {
  std::string text;
  for (const Channel channel : channels) text.append(text.empty() ? "" : ", ").append(nameOf(channel));
  return print("[%s]", text.c_str());
}

/// Lines of the section process_noise.
std::string regimesText(const LocalizationOptions& o) {
  std::string text;
  for (const auto& [regime, noise] : o.driven) {
    const bool turns = regime == Regime::turning;
    text += print("  %s: {%s: %s, angular_velocity_rad2_s3: %s, acceleration_m2_s5: %s}\n",
                  turns ? "turning" : "transit", turns ? "above_deg_s" : "above_m_s",
                  shortest(turns ? degrees(o.regimes.turning_rad_s) : o.regimes.transit_m_s).c_str(),
                  axes(noise.angular_velocity).c_str(), axes(noise.acceleration).c_str());
  }
  return text;
}

std::string sigmaTimesText(const LocalizationOptions& o) {
  std::string text;
  for (const auto& [channel, times] : o.sigma_times)
    text.append(text.empty() ? "" : ", ").append(nameOf(channel)).append(": " + shortest(times));
  return text.empty() ? "" : "sigma_times: {" + text + "}\n";
}

std::string biasesText(const LocalizationOptions& o) {
  if (!o.biases) return "";
  return print("biases: {gyro_sigma_deg_s: %s, accelerometer_sigma_m_s2: %s, time_constant_s: %s}\n",
               shortest(degrees(o.biases->gyro_sigma_rad_s)).c_str(),
               shortest(o.biases->accelerometer_sigma_m_s2).c_str(),
               shortest(o.biases->time_constant_s).c_str());
}

std::string gateText(const Gate& gate) {
  switch (gate.kind) {
    case Gate::Kind::none:
      return "{kind: none}";
    case Gate::Kind::chi_square:
      return "{kind: chi-square, probability: " + shortest(gate.probability) + "}";
    case Gate::Kind::fixed:
      return "{kind: fixed, max_position_m: " + shortest(gate.max_position_m) +
             ", max_angle_deg: " + shortest(degrees(gate.max_angle_rad)) + "}";
  }
  return "";
}

}  // namespace

std::string formatLocalizationOptions(const LocalizationOptions& o) {
  std::ostringstream y;
  y << "task: " << o.task << "\nfuse: " << channelsText(o.fuse)
    << "\nnoise: " << (o.adapts_noise ? "adaptive" : "fixed")
    << "\nbias_states: " << (o.bias_states ? "true" : "false")
    << "\nprocess_noise:\n  position_m2_s: " << axes(o.noise.position)
    << "\n  orientation_rad2_s: " << axes(o.noise.orientation)
    << "\n  velocity_m2_s3: " << axes(o.noise.velocity)
    << "\n  angular_velocity_rad2_s3: " << axes(o.noise.angular_velocity)
    << "\n  acceleration_m2_s5: " << axes(o.noise.acceleration)
    << "\n  sea_floor_m2_s: " << shortest(o.noise.sea_floor) << "\n"
    << regimesText(o) << sigmaTimesText(o) << biasesText(o) << "gate: " << gateText(o.gate)
    << "\nlandmarks: {pose: " << (o.landmarks.form == LandmarkOptions::Form::mean ? "mean" : "joint")
    << ", position_sigma_m: " << shortest(o.landmarks.position_sigma_m)
    << ", angle_sigma_deg: " << shortest(degrees(o.landmarks.angle_sigma_rad)) << "}"
    << "\nlost: {position_sigma_m: " << shortest(o.lost.position_sigma_m)
    << ", angle_sigma_deg: " << shortest(degrees(o.lost.angle_sigma_rad))
    << ", contradiction_s: " << shortest(o.lost.contradiction_s) << ", blind_s: " << shortest(o.lost.blind_s)
    << "}\nhistory_s: " << shortest(o.history_s) << "\ngap_s: " << shortest(o.gap_s)
    << "\nalignment_s: " << shortest(o.alignment_s) << "\nfirst_fix_s: " << shortest(o.first_fix_s)
    << "\noutput_rate_hz: " << shortest(o.output_rate_hz) << "\nsmooth: " << (o.smooth ? "true" : "false")
    << "\n";
  return y.str();
}

LocalizationOptions readLocalizationOptions(const std::filesystem::path& file,
                                            const LocalizationOptions& base) {
  return readOnto(base, file, 0);
}

}  // namespace fathom
