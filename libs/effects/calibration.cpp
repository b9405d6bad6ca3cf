#include "effects/calibration.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace fathom {
namespace {

/// Reads one effect's parameters where the entry's id is its id; false where it is another effect's.
template <class Effect>
bool readEffect(const YamlMap& entry, const std::string& id, EffectParameters<double>& result) {
  if (id != Effect::id) return false;
  if (result.has<Effect>()) throw entry.error("id", "effect `" + id + "` is given twice");
  result.on.set(kEffectIndex<Effect>);
  double* value = result.of<Effect>();
  for (const Parameter& parameter : Effect::parameters) {
    const std::string name(parameter.name);
    const auto numbers = parameter.size == 1 ? std::vector<double>{entry.number(name)} : entry.numbers(name);
    if (static_cast<int>(numbers.size()) != parameter.size)
      throw entry.error(name, "must have " + std::to_string(parameter.size) + " numbers");
    for (const double number : numbers) {
      if (std::abs(number) > parameter.limit)
        throw entry.error(name, "is beyond " + shortest(parameter.limit) + " " + std::string(parameter.unit));
      *value++ = number;
    }
  }
  return true;
}

}  // namespace

EffectParameters<double> parseCalibration(const YamlMap& map) {
  EffectParameters<double> result;
  for (const YamlMap& entry : map.maps("effects")) {
    const std::string id = entry.text("id");
    bool found = false;
    forEachEffect([&]<class Effect>() { found = found || readEffect<Effect>(entry, id, result); });
    if (found) continue;
    std::string known;
    for (const EffectInfo& effect : allEffects()) known.append(known.empty() ? "" : ", ").append(effect.id);
    throw entry.error(
        "id", std::string("unknown effect `").append(id).append("` (known: ").append(known).append(")"));
  }
  return result;
}

EffectParameters<double> readCalibration(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  auto result = parseCalibration(yaml.root());
  yaml.rejectUnknownKeys();
  return result;
}

std::string formatCalibration(const EffectParameters<double>& parameters) {
  std::string text = "effects:";
  forEachEffect([&]<class Effect>() {
    if (!parameters.has<Effect>()) return;
    text += "\n  - {id: " + std::string(Effect::id);
    const double* value = parameters.of<Effect>();
    for (const Parameter& parameter : Effect::parameters) {
      text += ", " + std::string(parameter.name) + ": " + (parameter.size > 1 ? "[" : "");
      for (int i = 0; i < parameter.size; ++i) text += (i ? ", " : "") + shortest(*value++);
      text += parameter.size > 1 ? "]" : "";
    }
    text += "}";
  });
  return text + (parameters.on.any() ? "\n" : " []\n");
}

std::vector<EffectInfo> allEffects() {
  std::vector<EffectInfo> effects;
  forEachEffect([&]<class Effect>() {
    effects.push_back({Effect::id, {Effect::parameters.begin(), Effect::parameters.end()}});
  });
  return effects;
}

}  // namespace fathom
