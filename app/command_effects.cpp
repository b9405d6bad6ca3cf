#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/error.h"
#include "core/text.h"
#include "effects/catalogue.h"
#include "report/table.h"

namespace fathom {
namespace {

struct EffectsOptions {
  std::string id;
  bool json = false;
};

std::string unitOf(const Parameter& parameter) {
  return (parameter.size > 1 ? std::to_string(parameter.size) + " x " : "") + std::string(parameter.unit);
}

std::string priorOf(const Parameter& parameter) {
  if (parameter.kind == ParameterKind::continuous) return shortest(asNamed(parameter, parameter.prior_sigma));
  return std::string(nameOf(parameter.kind));
}

nlohmann::ordered_json toJson(const Parameter& parameter) {
  nlohmann::ordered_json json;
  json["name"] = parameter.name;
  json["unit"] = parameter.unit;
  json["size"] = parameter.size;
  json["kind"] = nameOf(parameter.kind);
  json["prior_sigma"] = nullptr;
  if (parameter.kind == ParameterKind::continuous)
    json["prior_sigma"] = asNamed(parameter, parameter.prior_sigma);
  json["limit"] = parameter.limit;
  json["positive"] = parameter.positive;
  json["optional"] = parameter.optional;
  json["usual"] = parameter.usual;
  return json;
}

nlohmann::ordered_json toJson(const EffectInfo& effect) {
  nlohmann::ordered_json json;
  json["id"] = effect.id;
  json["channel"] = nameOf(effect.text.channel);
  json["title"] = effect.text.title;
  json["equation"] = effect.text.equation;
  for (const Parameter& parameter : effect.parameters) json["parameters"].push_back(toJson(parameter));
  json["source"] = effect.text.source;
  json["confused_with"] = effect.confusedWith();
  json["told_apart_by"] = effect.text.told_apart;
  return json;
}

std::string catalogue() {
  Table table{{"effect", "channel", "parameters", "what is other than the nominal model has it"}};
  for (const EffectInfo& effect : allEffects()) {
    std::string names;
    for (const Parameter& p : effect.parameters) names.append(names.empty() ? "" : ", ").append(p.name);
    table.rows.push_back({std::string(effect.id), std::string(nameOf(effect.text.channel)), names,
                          std::string(effect.text.title)});
  }
  return formatTable(table);
}

/// Text under a heading, broken into lines that are indented alike.
std::string section(const std::string& heading, std::string_view text) {
  constexpr std::size_t kIndent = 16, kWidth = 96;
  std::string lines = heading + std::string(kIndent - heading.size(), ' ');
  std::size_t column = kIndent;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    const std::string_view word = text.substr(0, end);
    if (column > kIndent && column + word.size() > kWidth) {
      lines.back() = '\n';  // instead of the space
      lines += std::string(kIndent, ' ');
      column = kIndent;
    }
    lines.append(word);
    column += word.size() + 1;
    const bool new_line = end < text.size() && text[end] == '\n';
    if (end < text.size()) lines += new_line ? "\n" + std::string(kIndent, ' ') : " ";
    if (new_line) column = kIndent;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines + "\n";
}

std::string explanation(const EffectInfo& effect) {
  std::string text = std::string(effect.id) + " (" + std::string(nameOf(effect.text.channel)) + ")\n" +
                     std::string(effect.text.title) + ".\n\n" + section("equation", effect.text.equation);
  Table table{{"parameter", "unit", "prior sigma", "usual"}};
  for (const Parameter& p : effect.parameters)
    table.rows.push_back({std::string(p.name) + (p.optional ? " (optional)" : ""), unitOf(p), priorOf(p),
                          std::string(p.usual)});
  std::string others;
  for (const auto other : effect.confusedWith()) others.append(others.empty() ? "" : ", ").append(other);
  return text + "\n" + formatTable(table) + "\n" + section("source", effect.text.source) +
         section("confused with", others) + section("told apart by", effect.text.told_apart);
}

void showAll(bool json) {
  if (!json) {
    std::cout << catalogue();
    return;
  }
  auto list = nlohmann::ordered_json::array();
  for (const EffectInfo& effect : allEffects()) list.push_back(toJson(effect));
  std::cout << list.dump(2) << "\n";
}

void show(const EffectsOptions& options) {
  if (options.id.empty()) return showAll(options.json);
  const EffectInfo* effect = findEffect(options.id);
  if (effect == nullptr) throw Error("effects", options.id, "unknown effect (known: " + knownEffects() + ")");
  std::cout << (options.json ? toJson(*effect).dump(2) + "\n" : explanation(*effect));
}

}  // namespace

void addEffects(const RunContext& context) {
  auto* command =
      context.root->add_subcommand("effects", "List the physics that the nominal sensor models leave out");
  command->footer(
      "Lists the catalogue, or explains one effect: its equation, its parameters, how large an engineer "
      "would\n"
      "expect them, and which effects look alike. Any of them goes into a calibration file,\n"
      "  effects:\n"
      "    - {id: dvl-scale, scale_error: 0.012}\n"
      "    - {id: water-current, current_m_s: [0.2, 0, 0], active_s: [30, 80]}\n"
      "which `simulate` and `localize` take; active_s is in seconds from the recording's first entry.\n"
      "Where a vehicle has several instruments of a kind, `instance: 2` is of DVL.2 alone, `instance: first` "
      "of "
      "DVL.\n"
      "\n"
      "Examples:\n"
      "  fathom effects\n"
      "  fathom effects flat-port-refraction\n"
      "  fathom effects --json | jq '.[].id'");
  const auto options = std::make_shared<EffectsOptions>();
  command->add_option("ID", options->id, "The effect to explain (default: all are listed)");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { show(*options); });
}

}  // namespace fathom
