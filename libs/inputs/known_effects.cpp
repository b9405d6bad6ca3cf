#include "inputs/known_effects.h"

#include <nlohmann/json.hpp>

#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "inputs/batch_recording.h"

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

}  // namespace fathom
