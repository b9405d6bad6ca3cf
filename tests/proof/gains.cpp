#include "gains.h"

#include <nlohmann/json.hpp>

#include "diagnosis/budget_file.h"
#include "diagnosis/nominal.h"
#include "effects/drawn.h"
#include "imaging/exposure_time.h"

namespace fathom::proof {
namespace {

/// The hidden effects as the program's calibration.
EffectParameters<double> truthOf(const ProofCase& proof_case) {
  EffectParameters<double> truth;
  for (const nlohmann::json& hidden : proof_case.generator.at("effects")) {
    const EffectInfo& effect = *findEffect(hidden.at("id").get<std::string>());
    truth.on.set(effect.index);
    if (const nlohmann::json& active = hidden.at("active_s"); !active.is_null())
      truth.active_s[effect.index] = {active[0], active[1]};
    std::size_t scalar = effect.first_scalar;
    for (const Parameter& parameter : effect.parameters)
      for (int i = 0; i < parameter.size; ++i, ++scalar) {
        const auto value = hidden.at("parameters").find(parameter.name);
        if (value == hidden.at("parameters").end()) continue;
        const double named =
            parameter.size == 1 ? value->get<double>() : value->at(static_cast<std::size_t>(i)).get<double>();
        truth.values[scalar] = asHeld(parameter, named);
      }
  }
  return truth;
}

bool lasts(const EffectParameters<double>& effects) {
  for (const EffectInfo& effect : allEffects())
    if (effects.on[effect.index] &&
        (isDrawn(effect.index) || hasPeak(effect) || effect.has(ParameterKind::time) ||
         !(effects.active_s[effect.index] == Interval{})))
      return false;
  return effects.on.any();
}

/// The likelihood that a calibration gains on the other dive.
double gainOn(const BatchInput& judge, const NominalFit& nominal,
              const EffectParameters<double>& calibration) {
  if (calibration.on.none()) return 0;
  BatchOptions options = nominal.options;
  options.calibration = calibration;
  const Refit with = refit(judge.data, nominal.fit, options, {}, nominal.noise);
  return with.succeeded ? with.weight.log_evidence - nominal.fit.weight.log_evidence : 0;
}

/// The effect most like the hidden one, fitted.
EffectParameters<double> runnerUpOf(const ProofCase& proof_case, const BatchInput& recording) {
  const EffectInfo* effect = findEffect(proof_case.effects.front().runner_up);
  const NominalFit nominal = nominalFit(recording.data, recording.start, {}, fieldBudget(), 1);
  Candidate candidate;
  if (effect == nullptr || !nominal.failure.empty()) return {};
  if (effect->has(ParameterKind::marker_id) || effect->has(ParameterKind::time) || hasPeak(*effect) ||
      isDrawn(effect->index))
    return {};
  candidate.effect = effect->index;
  const Refit fitted = refit(recording.data, nominal.fit, nominal.options, {candidate}, nominal.noise);
  return fitted.succeeded ? fitted.estimate.state.effects : EffectParameters<double>{};
}

}  // namespace

std::optional<Gains> gainsOf(const ProofCase& proof_case, const BatchInput& recording,
                             const BatchInput& judge, const EffectParameters<double>& stated,
                             const nlohmann::json& answer) {
  const EffectParameters<double> truth = truthOf(proof_case);
  if (!lasts(truth)) return {};
  const NominalFit nominal = nominalFit(judge.data, judge.start, {}, fieldBudget(), 1);
  if (!nominal.failure.empty()) return {};
  const double exposure_s = statedExposure_s(judge.data.vehicle);
  Gains gains;
  gains.truth = gainOn(judge, nominal, beyondStated(truth, exposure_s));
  gains.stated = gainOn(judge, nominal, beyondStated(stated, exposure_s));
  gains.runner_up = gainOn(judge, nominal, runnerUpOf(proof_case, recording));
  for (const nlohmann::json& elsewhere : answer.value("elsewhere", nlohmann::json::array()))
    gains.black_box = elsewhere.at("log_likelihood_gain").at("black_box");
  return gains;
}

}  // namespace fathom::proof
