#include "planned_dive.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "effects/image_regions.h"
#include "imaging/exposure_time.h"
#include "inputs/batch_recording.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

/// What the generator knows nothing of stays as it is.
bool isMade(std::string_view effect, std::string_view parameter) {
  if (effect == "vignetting") return parameter == "corner_loss";
  if (effect == "flat-port-refraction")
    return parameter != "index_error" && parameter != "slab_m" && parameter != "calibration_per_m";
  if (effect == "turbidity-plume") return parameter != "per_m" && parameter != "middle";
  if (effect == "lamp") return parameter == "irradiance_1m_rel";
  if (effect == "lens-distortion") return parameter != "cx_error_px" && parameter != "cy_error_px";
  return true;
}

/// The generator knows no names of regions.
void addPlace(const ImageRegion& region, nlohmann::json& parameters) {
  parameters["left"] = region.left;
  parameters["right"] = region.right;
  parameters["top"] = region.top;
  parameters["bottom"] = region.bottom;
}

/// By the names that `fathom effects` documents; "marker_id", "time_s" among them.
nlohmann::json parametersOf(const Hidden& hidden, double stated_exposure_s) {
  const EffectInfo& effect = allEffects()[hidden.candidate.effect];
  nlohmann::json json = nlohmann::json::object();
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& parameter : effect.parameters) {
    nlohmann::json values = nlohmann::json::array();
    for (int i = 0; i < parameter.size; ++i, ++scalar)
      values.push_back(asNamed(parameter, wholeOf(scalar, hidden.effects.values[scalar], stated_exposure_s)));
    if (parameter.kind == ParameterKind::marker_id) values = {static_cast<int>(values[0].get<double>())};
    if (parameter.kind == ParameterKind::region) {
      addPlace(kImageRegions.at(static_cast<std::size_t>(values[0].get<double>())), json);
      continue;
    }
    if (isMade(effect.id, parameter.name))
      json[std::string(parameter.name)] = parameter.size == 1 ? values[0] : values;
  }
  return json;
}

}  // namespace

PlannedDive plannedDive(const DivePlan& plan, std::uint64_t seed, double ordinary) {
  PlannedDive dive;
  dive.images = plan.images;
  dive.duration_s = plan.duration_s;
  dive.ordinary = ordinary;
  dive.json = {{"manoeuvre", plan.manoeuvre},
               {"seed", seed},
               {"duration_s", plan.duration_s},
               {"camera", plan.images ? "images" : "corners"},
               {"image_rate_hz", plan.images ? 1.0 : 2.0},
               {"water", plan.water}};
  return dive;
}

nlohmann::json generatorCase(const std::string& name, const PlannedDive& dive, std::uint64_t seed) {
  return {{"name", name},
          {"dive", dive.json},
          {"seed", seed},
          {"noise", true},
          {"rich", false},
          {"ordinary", dive.ordinary},
          {"effects", nlohmann::json::array()},
          {"outside", nlohmann::json::array()}};
}

BatchInput sealedInput(const nlohmann::json& generator_case, const Programs& programs,
                       const fs::path& folder) {
  sealRecording(programs, generator_case, folder / "recording", folder / "truth");
  BatchRecordingOptions options;
  options.rawlog = folder / "recording" / "recording.rawlog";
  options.pixels = true;
  options.folder = folder;
  return readBatchRecording(options, {}).input;
}

const std::vector<EffectInfo>& effectsOfGenerator() {
  static const std::vector<EffectInfo> known = [] {
    const std::set<std::string_view> unknown{"clock-drift", "edge-bias", "panel-shape",
                                             "illumination-gradient", "flat-water-surface"};
    std::vector<EffectInfo> effects = allEffects();
    std::erase_if(effects, [&](const EffectInfo& effect) { return unknown.contains(effect.id); });
    return effects;
  }();
  return known;
}

bool canHide(const EffectInfo& effect, const PlannedDive& dive) {
  const std::vector<EffectInfo>& known = effectsOfGenerator();
  const bool is_known = std::any_of(known.begin(), known.end(),
                                    [&](const EffectInfo& one) { return one.index == effect.index; });
  const bool is_light = effect.text.channel == EffectChannel::image;
  return is_known && effect.id != "earth-rotation" && (dive.images || !is_light) &&
         dive.resolution->canShow(effect.index);
}

Hidden madeEffect(const EffectInfo& effect, const PlannedDive& dive, Random& random) {
  Hidden hidden = test::randomEffect(effect, dive.resolution->markerIds(), dive.duration_s, random);
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& parameter : effect.parameters)
    for (int i = 0; i < parameter.size; ++i, ++scalar)
      if (!isMade(effect.id, parameter.name)) hidden.effects.values[scalar] = 0;
  return hidden;
}

std::optional<Hidden> ofSize(const Hidden& hidden, const PlannedDive& dive, double sqrt_lambda) {
  const double size = dive.resolution->sqrtLambda(hidden);
  if (!(size > 0)) return {};
  const Hidden sized{hidden.candidate, test::scaled(hidden.effects, sqrt_lambda / size)};
  return test::isWithinLimits(sized.effects) ? std::optional(sized) : std::nullopt;
}

nlohmann::json generatorEffect(const Hidden& hidden, const PlannedDive& dive) {
  const double from_s = hidden.candidate.active_s.from_s, to_s = hidden.candidate.active_s.to_s;
  nlohmann::json active = nullptr;
  if (!(hidden.candidate.active_s == Interval{})) active = {from_s, to_s};
  return {{"id", allEffects()[hidden.candidate.effect].id},
          {"parameters", parametersOf(hidden, dive.resolution->exposure_s())},
          {"active_s", active}};
}

ProofCase::Effect describedEffect(const Hidden& hidden, const Resolution& resolution,
                                  const std::function<bool(const Rival&)>& tempts) {
  ProofCase::Effect described;
  described.id = allEffects()[hidden.candidate.effect].id;
  described.name = nameOf(hidden.candidate);
  described.sqrt_lambda = resolution.sqrtLambda(hidden);
  described.nearest = std::numeric_limits<double>::infinity();
  std::map<std::string, double> separations;  // by effect, the least
  for (const Rival& rival : resolution.rivalsOf(hidden)) {
    const std::string id{allEffects()[rival.candidate.effect].id};
    const double separation = std::pow(described.sqrt_lambda, 2) * (1 - rival.alignment);
    const auto [it, is_new] = separations.try_emplace(id, separation);
    it->second = std::min(it->second, separation);
    if (separation >= described.nearest || !tempts(rival)) continue;
    described.nearest = separation;
    described.runner_up = id;
  }
  for (const auto& [id, separation] : separations)
    if (separation < test::kSeparable) described.inseparable.push_back(id);
  return described;
}

}  // namespace fathom::proof
