#include "effects/calibration.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/text.h"
#include "effects/catalogue.h"
#include "effects/parameter_words.h"

namespace fathom {
namespace {

double readWord(const YamlMap& entry, const std::string& name, std::span<const std::string_view> words) {
  const std::string word = entry.text(name);
  if (const auto found = std::find(words.begin(), words.end(), word); found != words.end())
    return static_cast<double>(found - words.begin());
  std::string known;
  for (const std::string_view one : words) known.append(known.empty() ? "" : ", ").append(one);
  throw entry.error(name, "no such " + name + ": `" + word + "` (known: " + known + ")");
}

void readParameter(const YamlMap& entry, const Parameter& parameter, double* values) {
  const std::string name(parameter.name);
  if (parameter.optional && !entry.has(name)) return;
  if (const auto words = wordsOf(parameter.kind); !words.empty()) {
    *values = readWord(entry, name, words);
    return;
  }
  const auto numbers = parameter.size == 1 ? std::vector<double>{entry.number(name)} : entry.numbers(name);
  if (static_cast<int>(numbers.size()) != parameter.size)
    throw entry.error(name, "must have " + std::to_string(parameter.size) + " numbers");
  for (const double number : numbers) {
    if (std::abs(number) > parameter.limit)
      throw entry.error(name, "is beyond " + shortest(parameter.limit) + " " + std::string(parameter.unit));
    if (!isPossible(parameter, number)) throw entry.error(name, "must be 0 or more");
    if (parameter.kind == ParameterKind::marker_id && (number < 0 || number != std::floor(number)))
      throw entry.error(name, "must be a whole number, 0 or more");
    if (parameter.at_zero > 0 && !(number > 0)) throw entry.error(name, "must be greater than 0");
    *values++ = asHeld(parameter, number);
  }
}

void readInterval(const YamlMap& entry, Interval& active_s) {
  const std::string name = "active_s";
  if (!entry.has(name)) return;
  const std::vector<double> times = entry.matrix(name);
  const bool is_rising =
      std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) == times.end();
  if (times.size() < 2 || times.size() > 2 + 2 * active_s.pauses.size() || times.size() % 2 != 0 ||
      !is_rising)
    throw entry.error(
        name,
        "must be [from, to], s, to being later, or up to three of these, each later than the one before");
  active_s = {times.front(), times.back()};
  for (std::size_t k = 1; k + 1 < times.size(); k += 2) active_s.pauses[k / 2] = {times[k], times[k + 1]};
}

void readInstance(const YamlMap& entry, std::optional<Instance>& only) {
  const std::string key = "instance";
  if (!entry.has(key)) return;
  const std::string name = entry.text(key);
  only = name == Instance::kFirst ? Instance() : Instance::named(name);
  if (!only)
    throw entry.error(key, "must be `first` or what stands behind the dot of a label, as 2 of DVL.2");
}

std::string formatNumbers(const double* values, int size, const Parameter& parameter = {}) {
  if (const auto words = wordsOf(parameter.kind); !words.empty())
    return std::string(words[static_cast<std::size_t>(*values)]);
  std::string text = size > 1 ? "[" : "";
  for (int i = 0; i < size; ++i) text += (i > 0 ? ", " : "") + shortest(asNamed(parameter, values[i]));
  return text + (size > 1 ? "]" : "");
}

/// One entry of a calibration.
struct Entry {
  std::vector<double> values;
  Interval active_s;
  std::optional<Instance> only;
};

Entry readEntry(const YamlMap& entry, const EffectInfo& effect) {
  Entry read{std::vector<double>(effect.scalars), {}, {}};
  double* value = read.values.data();
  for (const Parameter& parameter : effect.parameters) {
    readParameter(entry, parameter, value);
    value += parameter.size;
  }
  readInterval(entry, read.active_s);
  readInstance(entry, read.only);
  if (read.only && !effect.is_of_instrument)
    throw entry.error("instance", "`" + std::string(effect.id) + "` is of the world, not of an instrument");
  return read;
}

/// Whether an effect may be on this instrument besides those that it is on already.
bool isFurther(const EffectParameters<double>& parameters, std::size_t effect,
               const std::optional<Instance>& only) {
  if (!only || !parameters.only[effect] || *parameters.only[effect] == *only) return false;
  return std::none_of(parameters.further.begin(), parameters.further.end(),
                      [&](const auto& f) { return f.effect == effect && f.instance == *only; });
}

std::string formatEntry(const EffectInfo& effect, const double* value, const Interval& active_s,
                        const std::optional<Instance>& only) {
  std::string text = "{id: " + std::string(effect.id);
  for (const Parameter& parameter : effect.parameters) {
    text += ", " + std::string(parameter.name) + ": " + formatNumbers(value, parameter.size, parameter);
    value += parameter.size;
  }
  if (active_s != Interval{}) {
    std::string times;
    const auto parts = active_s.parts();
    for (const auto& part : parts) times += (times.empty() ? "" : ", ") + formatNumbers(part.data(), 2);
    text += ", active_s: " + (parts.size() > 1 ? "[" + times + "]" : times);
  }
  if (only) text += ", instance: " + std::string(only->isFirst() ? Instance::kFirst : only->name());
  return text + "}";
}

}  // namespace

EffectParameters<double> parseCalibration(const YamlMap& map) {
  EffectParameters<double> result;
  for (const YamlMap& entry : map.maps("effects")) {
    const std::string id = entry.text("id");
    const EffectInfo* effect = findEffect(id);
    if (effect == nullptr)
      throw entry.error("id", "unknown effect `" + id + "` (known: " + knownEffects() + ")");
    Entry read = readEntry(entry, *effect);
    if (!result.on[effect->index]) {
      result.on.set(effect->index);
      std::copy(read.values.begin(), read.values.end(),
                result.values.begin() + static_cast<std::ptrdiff_t>(effect->first_scalar));
      result.active_s[effect->index] = read.active_s;
      result.only[effect->index] = read.only;
    } else if (isFurther(result, effect->index, read.only)) {
      result.further.push_back({effect->index, *read.only, std::move(read.values), read.active_s});
    } else {
      throw entry.error("id",
                        "effect `" + id + "` is given twice; only on another `instance` each it may be");
    }
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
  for (const EffectInfo& effect : allEffects()) {
    if (!parameters.on[effect.index]) continue;
    text += "\n  - " + formatEntry(effect, parameters.values.data() + effect.first_scalar,
                                   parameters.active_s[effect.index], parameters.only[effect.index]);
    for (const auto& f : parameters.further)
      if (f.effect == effect.index)
        text += "\n  - " + formatEntry(effect, f.values.data(), f.active_s, f.instance);
  }
  return text + (parameters.on.any() ? "\n" : " []\n");
}

}  // namespace fathom
