#include "reports/diagnosis_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "effects/catalogue.h"
#include "recording/samples.h"

namespace fathom {
namespace {
using Json = nlohmann::ordered_json;

std::string_view idOf(const Candidate& candidate) { return allEffects()[candidate.effect].id; }

Json optionalJson(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json intervalJson(const std::optional<Interval>& interval) {
  if (!interval) return nullptr;
  const auto parts = interval->parts();
  return parts.size() == 1 ? Json(parts.front()) : Json(parts);
}

/// A scalar as a number, else a list.
Json numbersJson(const std::vector<double>& numbers) {
  return numbers.size() == 1 ? Json(numbers[0]) : Json(numbers);
}

Json candidateJson(const Candidate& candidate, const BatchData& data) {
  return {{"id", idOf(candidate)},
          {"name", nameOf(candidate)},
          {"marker_id", candidate.marker_id ? Json(*candidate.marker_id) : Json(nullptr)},
          {"instance", candidate.only ? Json(candidate.only->name()) : Json(nullptr)},
          {"time_s", optionalJson(candidate.time_s)},
          {"active_s", intervalJson(activeIn(candidate, data))}};
}

Json mismatchJson(const Mismatch& m, const BatchData& data) {
  const Interval when = within(m.when_s, data).value_or(Interval{data.first_s, data.last_s});
  return {{"channel", textOf(m.channel).label},
          {"sensor", sensorOf(m)},
          {"statistic", m.statistic},
          {"against", m.against},
          {"size_sigma", m.size_sigma},
          {"size_raw", m.size_raw},
          {"raw_unit", m.raw_unit},
          {"p_value", m.p_value},
          {"log_p", m.log_p},
          {"chi_square", m.statistic_value},
          {"dof", m.dof},
          {"when_s", {when.from_s, when.to_s}},
          {"where", m.where},
          {"material", m.material}};
}

template <class Choose>
Json mismatchesJson(const std::vector<Mismatch>& all, const BatchData& data, Choose choose) {
  Json list = Json::array();
  for (const Mismatch& mismatch : all)
    if (choose(mismatch)) list.push_back(mismatchJson(mismatch, data));
  return list;
}

Json interactionsJson(const std::vector<InteractionTest>& tests) {
  Json list = Json::array();
  for (const InteractionTest& test : tests)
    list.push_back({{"against", test.against},
                    {"chi_square", test.statistic},
                    {"p_value", std::exp(test.log_p)},
                    {"log_p", test.log_p},
                    {"relative_change", test.relative_change},
                    {"failed", test.failed}});
  return list;
}

Json effectJson(const FoundEffect& effect, const DiagnosisStory& story) {
  Json json{{"id", idOf(effect.candidate)}, {"name", nameOf(effect.candidate)}};
  for (const char* key : {"parameters", "sigma", "unit"}) json[key] = Json::object();
  for (const FoundParameter& parameter : parametersOf(effect, story)) {
    json["parameters"][parameter.name] =
        parameter.word.empty() ? numbersJson(parameter.value) : Json(parameter.word);
    json["unit"][parameter.name] = parameter.unit;
    if (!parameter.sigma.empty()) json["sigma"][parameter.name] = numbersJson(parameter.sigma);
  }
  if (const auto& id = effect.candidate.marker_id) json["parameters"]["marker_id"] = *id;
  json["active_s"] = intervalJson(activeIn(effect.candidate, story.read.input.data));
  json["sqrt_lambda"] = effect.sqrt_lambda;
  json["confidence"] = effect.confidence;
  json["share"] = effect.share;
  json["evidence"] = {{"heldout_log_likelihood_gain", effect.heldout_log_likelihood_gain},
                      {"bic_gain", effect.bic_gain},
                      {"log_odds", effect.log_odds},
                      {"log_likelihood_gain", effect.log_likelihood_gain}};
  json["interactions"] = interactionsJson(effect.interactions);
  return json;
}

Json effectsJson(const std::vector<FoundEffect>& effects, const DiagnosisStory& story) {
  Json list = Json::array();
  for (const FoundEffect& effect : effects) list.push_back(effectJson(effect, story));
  return list;
}

Json adviceJson(const Advice& advice) {
  if (advice.manoeuvre.empty()) return nullptr;
  return {{"manoeuvre", advice.manoeuvre},
          {"minutes", advice.minutes},
          {"from_s", advice.from_s},
          {"separation", advice.separation},
          {"separation_now", advice.separation_now}};
}

Json alternativesJson(const DiagnosisStory& story) {
  Json list = Json::array();
  for (const Alternatives& set : story.diagnosis.alternatives) {
    Json ids = Json::array(), candidates = Json::array();
    for (const Candidate& candidate : set.candidates) {
      ids.push_back(idOf(candidate));
      candidates.push_back(candidateJson(candidate, story.read.input.data));
    }
    list.push_back({{"effects", ids},
                    {"candidates", candidates},
                    {"log_odds", set.log_odds},
                    {"alignment", set.alignment},
                    {"advice", adviceJson(set.advice)}});
  }
  return list;
}

Json blocksJson(const HeldOut& heldout) {
  Json list = Json::array();
  for (const HeldOut::Block& block : heldout.blocks)
    list.push_back({{"from_s", block.from_s},
                    {"to_s", block.to_s},
                    {"before", block.before},
                    {"after", block.after},
                    {"black_box", block.black_box}});
  return list;
}

/// The contract's keys; null where nothing was held out.
Json headlineJson(const std::vector<HeldOut>& heldout) {
  if (heldout.empty())
    return {{"metric", nullptr},     {"before", nullptr},    {"after", nullptr},
            {"after_ci95", nullptr}, {"black_box", nullptr}, {"noise_floor", nullptr}};
  const HeldOut& h = heldout.front();
  return {{"metric", h.metric},         {"before", h.before},       {"after", h.after},
          {"after_ci95", h.after_ci95}, {"black_box", h.black_box}, {"noise_floor", h.noise_floor}};
}

Json heldOutJson(const std::vector<HeldOut>& heldout) {
  Json list = Json::array();
  for (const HeldOut& h : heldout) {
    Json json = headlineJson({h});
    json["channel"] = textOf(h.channel).label;
    json["blocks"] = blocksJson(h);
    list.push_back(json);
  }
  return list;
}

Json gainJson(const HeldOutGain& gain) {
  return {{"physics", gain.physics},
          {"physics_ci95", gain.physics_ci95},
          {"black_box", gain.black_box},
          {"over_black_box_ci95", gain.over_black_box_ci95},
          {"placebo", gain.placebo}};
}

Json testedJson(const DiagnosisStory& story) {
  Json list = Json::array();
  for (const TestedCandidate& tested : story.diagnosis.tested) {
    Json json = candidateJson(tested.candidate, story.read.input.data);
    json["chi_square"] = tested.statistic;
    json["dof"] = tested.dof;
    json["p_value"] = std::exp(tested.log_p);
    json["log_p"] = tested.log_p;
    json["log_odds"] = tested.log_evidence;
    json["kept"] = tested.kept;
    json["one_step"] = Json::object();
    for (const EffectEstimate& e : tested.one_step)
      json["one_step"][nameOfScalar(e)] = {{"value", asNamed(parameterOf(e.scalar), e.value)},
                                           {"sigma", sigmaAsNamed(parameterOf(e.scalar), e.value, e.sigma)}};
    list.push_back(json);
  }
  return list;
}

Json noiseJson(const NoiseModel& noise) {
  Json json = Json::object();
  for (const Channel channel : kEveryChannel) {
    const ChannelNoise& c = noise.channels[indexOf(channel)];
    if (c.rows > 0)
      json[nameOf(channel)] = {{"rows", c.rows}, {"scale", c.scale}, {"correlation", c.correlation}};
  }
  json["light_scatter"] = noise.light_scatter;
  json["parts"] = noise.parts;
  return json;
}

Json remainderJson(const Remainder& remainder) {
  return {{"share", remainder.share},
          {"where", remainder.where},
          {"size", remainder.size},
          {"unit", remainder.unit},
          {"material", remainder.material}};
}

Json budgetJson(const std::vector<BudgetEntry>& budget) {
  Json list = Json::array();
  for (const BudgetEntry& entry : budget)
    list.push_back({{"component", entry.component},
                    {"unit", entry.unit},
                    {"prior", entry.prior},
                    {"estimate", entry.estimate},
                    {"sigma", entry.estimate * entry.log_sd},
                    {"bursts", entry.bursts},
                    {"apart", entry.apart},
                    {"outlier_share", entry.outlier_share},
                    {"source", entry.source}});
  return list;
}

Json posteriorJson(const std::vector<Hypothesis>& posterior) {
  Json list = Json::array();
  for (const Hypothesis& hypothesis : posterior) {
    Json ids = Json::array();
    for (const Candidate& effect : hypothesis.effects) ids.push_back(nameOf(effect));
    if (hypothesis.is_something_else) ids.push_back("something else");
    list.push_back({{"hypothesis", ids}, {"mass", hypothesis.mass}});
  }
  return list;
}

Json diagnosisJson(const DiagnosisStory& story) {
  const Diagnosis& d = story.diagnosis;
  const BatchData& data = story.read.input.data;
  const auto significant = [&](const Mismatch& m) { return isSignificant(m, story.false_alarm); };
  const auto all = [](const Mismatch&) { return true; };
  return {{"verdict", nameOf(d.verdict)},
          {"why", d.why},
          {"mismatch", mismatchesJson(d.mismatch, data, significant)},
          {"effects", effectsJson(d.effects, story)},
          {"alternatives", alternativesJson(story)},
          {"heldout", headlineJson(d.heldout.channels)},
          {"heldout_metrics", heldOutJson(d.heldout.channels)},
          {"heldout_log_likelihood_gain", gainJson(d.heldout.gain)},
          {"remainder", remainderJson(d.remainder)},
          {"budget", budgetJson(d.budget)},
          {"posterior", posteriorJson(d.posterior)},
          {"alarm_p", d.alarm_p},
          {"false_alarm", story.false_alarm},
          {"tested", testedJson(story)},
          {"noise", noiseJson(d.noise)},
          {"mismatch_map", mismatchesJson(d.mismatch, data, all)},
          {"mismatch_remaining", mismatchesJson(d.remaining, data, all)},
          {"remarks", d.remarks}};
}

Json elsewhereJson(const DiagnosisStory& story) {
  Json list = Json::array();
  for (const auto& [recording, judged] : story.elsewhere) {
    Json channels = Json::array();
    for (const ElsewhereChannel& c : judged.channels)
      channels.push_back(
          {{"metric", c.metric}, {"before", c.before}, {"after", c.after}, {"black_box", c.black_box}});
    list.push_back({{"recording", recording.string()},
                    {"failure", judged.failure},
                    {"metrics", channels},
                    {"log_likelihood_gain", {{"physics", judged.physics}, {"black_box", judged.black_box}}}});
  }
  return list;
}

Json inputsJson(const DiagnosisStory& story) {
  Json list = Json::array();
  for (const InputFile& input : story.read.files)
    list.push_back({{"file", input.file.string()}, {"fingerprint", input.fingerprint}});
  return list;
}

}  // namespace

Json toJson(const DiagnosisStory& story) {
  Json json = toJson(story.run);
  json["recording"] = story.recording.string();
  json["inputs"] = inputsJson(story);
  json["diagnosis"] = diagnosisJson(story);
  if (!story.elsewhere.empty()) json["elsewhere"] = elsewhereJson(story);
  json["start"] = story.read.input.start.source;
  json["left_out"] = story.read.input.data.left_out;
  json["remarks"] = story.read.remarks;
  json["simulate"] = simulateCommand(story);
  if (story.rerun)
    json["rerun"] = {{"columns", story.rerun->table.header},
                     {"rows", story.rerun->table.rows},
                     {"remarks", story.rerun->remarks}};
  return json;
}

}  // namespace fathom
