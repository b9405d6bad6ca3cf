#include "sealed_case.h"

#include <algorithm>

#include "core/files.h"
#include "strict_json.h"

namespace fathom::sealed {
namespace {

struct ParameterKind {
  std::string name;
  std::size_t count = 1;
  bool needed = true;
  bool positive = false;  ///< cannot be negative
};

struct EffectKind {
  std::string id;
  bool light = false;  ///< changes images only, not where corners are
  std::vector<ParameterKind> parameters;
  bool of_a_sensor = false;  ///< has the parameter `sensor`, can be there once for each, and is always on
};

/// The catalogue, as diagnosis.md and `fathom effects` name it.
const std::vector<EffectKind>& effectKinds() {
  static const std::vector<EffectKind> kinds{
      {"dvl-scale", false, {{"scale_error"}}},
      {"dvl-misalignment", false, {{"rotation_deg", 3}}},
      {"dvl-lever-arm", false, {{"offset_m", 3}}},
      {"dvl-latency", false, {{"latency_s"}}},
      {"water-current", false, {{"current_m_s", 3}}},
      {"gyro-bias", false, {{"bias_rad_s", 3}}},
      {"gyro-scale", false, {{"scale_error"}}},
      {"accelerometer-bias", false, {{"bias_m_s2", 3}}},
      {"ins-misalignment", false, {{"rotation_deg", 3}}},
      {"ins-latency", false, {{"latency_s"}}},
      {"earth-rotation", false, {{"rate_rad_s", 3}}},
      {"pressure-density", false, {{"density_error_kg_m3"}}},
      {"pressure-offset", false, {{"offset_pa"}}},
      {"flat-port-refraction",
       false,
       {{"distance_m", 1, true, true},
        {"glass_m", 1, true, true},
        {"tilt_deg", 1, false},
        {"tilt_y_deg", 1, false},
        {"index_error", 1, false}}},
      {"focal-scale", false, {{"scale_error"}}},
      {"lens-distortion",
       false,
       {{"k1_error"}, {"k2_error"}, {"p1_error", 1, false}, {"p2_error", 1, false}}},
      {"camera-misalignment", false, {{"rotation_deg", 3}}},
      {"camera-latency", false, {{"latency_s"}}},
      {"rolling-shutter", false, {{"readout_s"}}},
      {"marker-moved", false, {{"marker_id", 1, true, true}, {"offset_m", 3}, {"rotation_deg", 1, false}}},
      {"marker-size", false, {{"scale_error"}}},
      {"panel-moved", false, {{"time_s"}, {"offset_m", 3}, {"rotation_deg", 3}}},
      {"separate-backscatter", true, {{"backscatter_difference_per_m", 3}}},
      {"slant-range", true, {{"slant_share"}}},
      // How water scatters its light (phase_function.h): scattering_asymmetry g, Henyey & Greenstein's mean
      // cosine, 0 alike in all directions; or Fournier & Forand's; or, where it is 1, petzold. beam_exponent:
      // a beam that goes with the cosine's power.
      {"lamp",
       true,
       {{"irradiance_1m_rel", 1, true, true},
        {"scattering_asymmetry", 1, false},
        {"fournier_forand_index", 1, false, true},
        {"fournier_forand_slope", 1, false, true},
        {"petzold", 1, false, true},
        {"beam_exponent", 1, false, true}}},
      {"forward-scatter", true, {{"scattered_fraction", 1, true, true}}},
      {"vignetting", true, {{"corner_loss"}}},
      {"gamma", true, {{"exponent_error"}}},
      {"auto-exposure", true, {{"log_gain_sd", 1, true, true}}},
      {"dark-offset", true, {{"offset_share"}}},
      {"motion-blur", true, {{"exposure_s", 1, true, true}}},
      // With cloud_m, the standard deviation of a ball of murky water, the plume is a cloud in space that
      // drifts across the view and is before the panel's middle at time_s. Else all water changes alike.
      {"turbidity-plume",
       true,
       {{"peak_extra_attenuation_per_m", 1, true, true},
        {"time_s"},
        {"log_width", 1, false},
        {"cloud_m", 1, false, true}}},
      {"marine-snow", true, {{"particles_per_m3", 1, true, true}}},
      {"sun-flicker", true, {{"log_light_sd", 1, true, true}}},
      // stamp = true time (1 + rate), since the recording's first entry.
      {"clock-drift", false, {{"rate_ppm"}}, true},
      // White grows over black by so much on each edge; black over white where it is negative.
      {"edge-bias", false, {{"offset_px"}}},
      // x' = x (1 + stretch_x) + shear y, y' = y (1 + stretch_y), markers included; fold_deg about the
      // upright middle line; heights: twist_m x y at the corners, bend_m at the middle before the sides.
      {"panel-shape",
       false,
       {{"stretch_x", 1, false},
        {"stretch_y", 1, false},
        {"shear", 1, false},
        {"fold_deg", 1, false},
        {"twist_m", 1, false},
        {"bend_m", 1, false}}},
      // Of the logarithm of daylight, along the panel's x and y.
      {"illumination-gradient", true, {{"gradient_per_m", 2}}},
      {"pressure-lever-arm", false, {{"offset_m", 3}}},
      // Standard deviations of the logarithm of each colour's gain, drawn for each image.
      {"white-balance", true, {{"log_gain_sd", 3, true, true}}},
      // r + bend r (1 - r) of each colour, r being what the power of the light is.
      {"response-curve", true, {{"bend", 3}}},
      // Of the logarithm of light, by the tangent to the right and down.
      {"flat-field", true, {{"slope", 2}}},
      {"veiling-glare", true, {{"glare_share", 1, true, true}}},
      // Standard deviation, to either side, of the disc to which a point is spread.
      {"defocus", true, {{"blur_px", 1, true, true}}},
      {"sharpening", true, {{"amount", 1, true, true}}},
      // Share in which a pixel has its other two colours from its neighbours.
      {"demosaicing", true, {{"interpolated", 1, true, true}}},
      // Times the tables that the JPEG standard suggests.
      {"image-compression", true, {{"table_scale", 1, true, true}}},
      // Share of its speed that a beam does not tell.
      {"beam-missing",
       false,
       {{"missing_1", 1, false, true},
        {"missing_2", 1, false, true},
        {"missing_3", 1, false, true},
        {"missing_4", 1, false, true}}},
      // Of the first three beams.
      {"beam-bias", false, {{"bias_m_s", 3}}},
      // A film of algae: so much of a marker's area, unevenly, and its albedo.
      {"biofouling",
       true,
       {{"marker_id", 1, true, true}, {"covered", 1, true, true}, {"growth_albedo", 3, false, true}}},
      // Something out of focus right before a part of the view, from and to shares of width and height.
      {"occlusion",
       true,
       {{"left", 1, true, true},
        {"right", 1, true, true},
        {"top", 1, true, true},
        {"bottom", 1, true, true},
        {"covered", 1, true, true},
        {"brightness", 1, true, true}}},
      {"dome-port", false, {{"offset_m", 3}, {"radius_m", 1, false, true}, {"thickness_m", 1, false, true}}}};
  return kinds;
}

struct OutsiderKind {
  std::string kind;  ///< its size's unit
  bool light = false;
};
const std::vector<OutsiderKind>& outsiderKinds() {
  static const std::vector<OutsiderKind> kinds{
      {"panel-folded"},              // deg between the panel's halves
      {"panel-bowed"},               // mm, the middle before the sides
      {"dvl-quadratic"},             // s/m: v (1 + size |v|)
      {"gyro-g-sensitivity"},        // (rad/s) / (m/s²)
      {"mount-shake"},               // deg, amplitude
      {"dvl-outliers"},              // fraction of measurements that are 0.1 to 0.5 m/s off in any direction
      {"markers-wide"},              // fraction by which each marker is wider than high, upright
      {"manipulator"},               // fraction of the time that an arm is before the panel
      {"growth", true},              // so many markers are overgrown: darker, greenish, of low contrast
      {"port-blotch", true},         // share of the light lost in its middle
      {"response-by-colour", true},  // more exponent in red, less in blue
      {"bubbles", true}};            // so many an image
  return kinds;
}

template <class Kind>
const Kind& kindNamed(JsonObject& object, const std::string& key, std::string Kind::*name,
                      const std::vector<Kind>& kinds) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds) names.push_back(kind.*name);
  const std::string word = object.oneOf(key, names);
  return *std::find_if(kinds.begin(), kinds.end(), [&](const Kind& kind) { return kind.*name == word; });
}

void requireImages(bool light, bool images, const JsonObject& object, const std::string& key) {
  if (light && !images) throw object.error(key, "changes light only: needs camera `images`");
}

/// Files beside the case are named by their place from `folder`.
DiveCase readDive(JsonObject object, const std::filesystem::path& folder) {
  DiveCase dive;
  dive.manoeuvre =
      object.oneOf("manoeuvre", {"rich", "survey", "station", "approach", "closing", "turns", "given"});
  if (dive.manoeuvre == "given") dive.path = folder / object.text("path");
  dive.seed = object.seed("seed");
  dive.duration_s = object.number("duration_s");
  if (dive.duration_s < 5 || dive.duration_s > 600) throw object.error("duration_s", "must be 5 to 600");
  dive.images = object.oneOf("camera", {"corners", "images"}) == "images";
  dive.image_rate_hz = object.number("image_rate_hz");
  if (dive.image_rate_hz < 0.1 || dive.image_rate_hz > 20)
    throw object.error("image_rate_hz", "must be 0.1 to 20");
  dive.water = object.oneOf("water", {"clear", "moderate", "turbid"});
  dive.panel_with_squares = object.has("panel") && object.oneOf("panel", {"plain", "squares"}) == "squares";
  object.rejectUnknownKeys();
  return dive;
}

/// One [from, to] or a list of them; null or nothing: always on.
std::vector<std::pair<double, double>> readIntervals(JsonObject& object) {
  if (object.isNull("active_s")) return {};
  std::vector<std::pair<double, double>> intervals;
  for (const std::vector<double>& interval : object.numberLists("active_s", 2)) {
    if (interval[0] >= interval[1]) throw object.error("active_s", "must be [from, to]");
    intervals.emplace_back(interval[0], interval[1]);
  }
  return intervals;
}

HiddenEffect readEffect(JsonObject object, bool images) {
  const EffectKind& kind = kindNamed(object, "id", &EffectKind::id, effectKinds());
  requireImages(kind.light, images, object, "id");
  HiddenEffect effect;
  effect.id = kind.id;
  JsonObject parameters = object.object("parameters");
  for (const ParameterKind& parameter : kind.parameters) {
    if (!parameter.needed && !parameters.has(parameter.name)) continue;
    const auto values = parameters.numbers(parameter.name, parameter.count);
    if (parameter.positive && *std::min_element(values.begin(), values.end()) < 0)
      throw parameters.error(parameter.name, "must not be negative");
    effect.parameters[parameter.name] = values;
  }
  if (kind.of_a_sensor) effect.sensor = parameters.oneOf("sensor", {"INS", "DVL", "DEPTH", "CAMERA"});
  parameters.rejectUnknownKeys();
  effect.active_s = readIntervals(object);
  if (kind.of_a_sensor && !effect.active_s.empty()) throw object.error("active_s", "a clock always drifts");
  object.rejectUnknownKeys();
  return effect;
}

Outsider readOutsider(JsonObject object, bool images) {
  const OutsiderKind& kind = kindNamed(object, "kind", &OutsiderKind::kind, outsiderKinds());
  requireImages(kind.light, images, object, "kind");
  Outsider outsider{kind.kind, object.number("size")};
  object.rejectUnknownKeys();
  return outsider;
}

}  // namespace

SealedCase parseSealedCase(const std::string& text, const std::string& name) {
  SealedCase sealed;
  sealed.document = parseStrictJson(text, name);
  JsonObject root(sealed.document, name, "");
  sealed.name = root.text("name");
  sealed.dive = readDive(root.object("dive"), std::filesystem::path(name).parent_path());
  sealed.seed = root.seed("seed");
  sealed.noise = root.flag("noise");
  sealed.rich = root.flag("rich");
  if (root.has("ordinary")) sealed.ordinary = root.number("ordinary");
  if (sealed.ordinary < 0) throw root.error("ordinary", "must not be negative");
  for (JsonObject& object : root.objects("effects")) {
    sealed.effects.push_back(readEffect(object, sealed.dive.images));
    const HiddenEffect& latest = sealed.effects.back();
    const auto same = [&](const HiddenEffect& e) { return e.id == latest.id && e.sensor == latest.sensor; };
    if (std::count_if(sealed.effects.begin(), sealed.effects.end(), same) > 1)
      throw object.error("id", "is there twice");
  }
  for (const JsonObject& object : root.objects("outside"))
    sealed.outsiders.push_back(readOutsider(object, sealed.dive.images));
  root.rejectUnknownKeys();
  return sealed;
}

SealedCase readSealedCase(const std::filesystem::path& file) {
  return parseSealedCase(readTextFile(file), file.string());
}

const HiddenEffect* SealedCase::find(std::string_view id, double t_s) const {
  for (const HiddenEffect& effect : effects)
    if (effect.id == id && effect.activeAt(t_s)) return &effect;
  return nullptr;
}

double SealedCase::number(std::string_view id, std::string_view parameter, double t_s) const {
  const HiddenEffect* effect = find(id, t_s);
  if (!effect) return 0.0;
  const auto found = effect->parameters.find(parameter);
  return found == effect->parameters.end() ? 0.0 : found->second.front();
}

Vector3d SealedCase::vector(std::string_view id, std::string_view parameter, double t_s) const {
  const HiddenEffect* effect = find(id, t_s);
  if (!effect) return Vector3d::Zero();
  return Eigen::Map<const Vector3d>(effect->parameters.find(parameter)->second.data());
}

Matrix3d SealedCase::rotation(std::string_view id, std::string_view parameter_deg, double t_s) const {
  return expSO3<double>(vector(id, parameter_deg, t_s) * radians(1.0));
}

double SealedCase::trueTime_s(std::string_view sensor, double stamp_s) const {
  for (const HiddenEffect& effect : effects)
    if (effect.id == "clock-drift" && effect.sensor == sensor)
      return stamp_s / (1 + 1e-6 * effect.parameters.find("rate_ppm")->second.front());
  return stamp_s;
}

double SealedCase::outsideSize(std::string_view kind) const {
  double size = 0;
  for (const Outsider& outsider : outsiders)
    if (outsider.kind == kind) size += outsider.size;
  return size;
}

}  // namespace fathom::sealed
