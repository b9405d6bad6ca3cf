#include "localization/options.h"

#include "core/yaml.h"

namespace fathom {

std::string nameOf(Channel channel) {
  switch (channel) {
    case Channel::gyro:
      return "gyro";
    case Channel::accelerometer:
      return "accelerometer";
    case Channel::attitude:
      return "attitude";
    case Channel::dvl:
      return "dvl";
    case Channel::altitude:
      return "altitude";
    case Channel::depth:
      return "depth";
    case Channel::usbl:
      return "usbl";
    case Channel::landmark:
      return "landmark";
  }
  return "";
}

namespace {

std::vector<Channel> readChannels(const YamlMap& y) {
  std::vector<Channel> channels;
  for (const std::string& name : y.texts("fuse")) {
    const auto found = std::find_if(kAllChannels.begin(), kAllChannels.end(),
                                    [&](Channel channel) { return nameOf(channel) == name; });
    if (found == kAllChannels.end()) {
      std::string known;
      for (const Channel channel : kAllChannels)
        known.append(known.empty() ? "" : ", ").append(nameOf(channel));
      throw y.error(
          "fuse",
          std::string("unknown channel `").append(name).append("` (known: ").append(known).append(")"));
    }
    channels.push_back(*found);
  }
  return channels;
}

/// A density per axis: one number for all three, or [x, y, z].
void readDensity(const YamlMap& y, const std::string& key, Vector3d& density) {
  if (!y.has(key)) return;
  density = y.isList(key) ? y.vector3(key) : Vector3d::Constant(y.number(key));
  if (density.minCoeff() < 0.0) throw y.error(key, "must not be negative");
}

ProcessNoise readProcessNoise(const YamlMap& y) {
  ProcessNoise noise;
  readDensity(y, "position_m2_s", noise.position);
  readDensity(y, "orientation_rad2_s", noise.orientation);
  readDensity(y, "velocity_m2_s3", noise.velocity);
  readDensity(y, "angular_velocity_rad2_s3", noise.angular_velocity);
  readDensity(y, "acceleration_m2_s5", noise.acceleration);
  if (y.has("sea_floor_m2_s")) noise.sea_floor = y.notNegative("sea_floor_m2_s");
  return noise;
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

LandmarkOptions readLandmarks(const YamlMap& y) {
  LandmarkOptions landmarks;
  if (y.has("pose")) {
    const std::string form = y.text("pose");
    if (form != "mean" && form != "joint") throw y.error("pose", "must be mean or joint");
    landmarks.form = form == "mean" ? LandmarkOptions::Form::mean : LandmarkOptions::Form::joint;
  }
  if (y.has("position_sigma_m")) landmarks.position_sigma_m = y.positive("position_sigma_m");
  if (y.has("angle_sigma_deg")) landmarks.angle_sigma_rad = radians(y.positive("angle_sigma_deg"));
  return landmarks;
}

LostOptions readLost(const YamlMap& y) {
  LostOptions lost;
  if (y.has("position_sigma_m")) lost.position_sigma_m = y.positive("position_sigma_m");
  if (y.has("angle_sigma_deg")) lost.angle_sigma_rad = radians(y.positive("angle_sigma_deg"));
  if (y.has("contradiction_s")) lost.contradiction_s = y.positive("contradiction_s");
  if (y.has("blind_s")) lost.blind_s = y.positive("blind_s");
  return lost;
}

void readPositive(const YamlMap& y, const std::string& key, double& value) {
  if (y.has(key)) value = y.positive(key);
}

}  // namespace

LocalizationOptions readLocalizationOptions(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  LocalizationOptions options;
  y.read("task", options.task);
  if (y.has("fuse")) options.fuse = readChannels(y);
  y.read("bias_states", options.bias_states);
  if (y.has("process_noise")) options.noise = readProcessNoise(y.map("process_noise"));
  if (y.has("gate")) options.gate = readGate(y.map("gate"));
  if (y.has("landmarks")) options.landmarks = readLandmarks(y.map("landmarks"));
  if (y.has("lost")) options.lost = readLost(y.map("lost"));
  if (y.has("history_s")) options.history_s = y.notNegative("history_s");
  readPositive(y, "gap_s", options.gap_s);
  readPositive(y, "alignment_s", options.alignment_s);
  readPositive(y, "output_rate_hz", options.output_rate_hz);
  y.read("smooth", options.smooth);
  yaml.rejectUnknownKeys();
  return options;
}

}  // namespace fathom
