#include "known_effects.h"

#include "batch_recording.h"
#include "commands.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"

namespace fathom {

std::vector<std::string> KnownEffects::ids() const {
  std::vector<std::string> ids;
  for (const EffectInfo& effect : allEffects())
    if (effects.on[effect.index]) ids.emplace_back(effect.id);
  return ids;
}

std::string KnownEffects::inWords() const {
  std::string list;
  for (const std::string& id : ids()) list += (list.empty() ? "" : ", ") + id;
  return "Effects that are on: " + (list.empty() ? "none" : list) + " (" + file + ").";
}

KnownEffects readKnownEffects(const std::string& file) {
  if (file.empty()) return {};
  return {file, inputFile(file).fingerprint, readCalibration(file)};
}

nlohmann::ordered_json toJson(const KnownEffects& known) {
  return {{"file", known.file}, {"fingerprint", known.fingerprint}, {"effects", known.ids()}};
}

CLI::Option* addCalibrationOption(CLI::App& command, std::string& file, const std::string& help) {
  return command.add_option("--calibration", file, help)->type_name(values::kYaml);
}

CLI::Option* addTimeOption(CLI::App& command, double& t_s, CLI::Option* calibration) {
  return command
      .add_option("--at", t_s, "When the views are taken, s since the recording's first entry, for effects")
      ->needs(calibration)
      ->capture_default_str();
}

}  // namespace fathom
