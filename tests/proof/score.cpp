#include "score.h"

#include <algorithm>
#include <cmath>

namespace fathom::proof {
namespace {

using Json = nlohmann::json;

/// An effect that an answer states, with those it was not told from.
struct Stated {
  Json effect;
  std::vector<Json> set;  ///< candidates, the effect itself the first
};

std::vector<Stated> statedIn(const Json& diagnosis) {
  std::vector<Stated> all;
  for (const Json& effect : diagnosis.at("effects")) {
    Stated stated{effect, {effect}};
    for (const Json& alternatives : diagnosis.at("alternatives")) {
      const Json& candidates = alternatives.at("candidates");
      if (!candidates.empty() && candidates.front().at("name") == effect.at("name"))
        stated.set.assign(candidates.begin(), candidates.end());
    }
    all.push_back(stated);
  }
  return all;
}

std::string described(const Stated& stated) {
  std::string text;
  for (const Json& candidate : stated.set)
    text += (text.empty() ? "" : " | ") + candidate.at("name").get<std::string>();
  return text;
}

std::optional<int> markerOf(const Json& effect) {
  for (const Json* place : {&effect, effect.contains("parameters") ? &effect.at("parameters") : nullptr})
    if (place != nullptr && place->contains("marker_id") && place->at("marker_id").is_number())
      return place->at("marker_id").get<int>();
  return {};
}

/// Onsets and peaks are parameters, no names.
bool isSame(const Json& stated, const Json& hidden) {
  return stated.at("id") == hidden.at("id") && markerOf(stated) == markerOf(hidden);
}

bool hasIt(const Stated& stated, const Json& hidden) {
  return std::any_of(stated.set.begin(), stated.set.end(), [&](const Json& c) { return isSame(c, hidden); });
}

std::vector<double> numbers(const Json& value) {
  return value.is_array() ? value.get<std::vector<double>>() : std::vector{value.get<double>()};
}

void countCovered(const Json& stated, const Json& hidden, Scored& scored) {
  for (const auto& [name, sigma] : stated.at("sigma").items()) {
    if (!hidden.at("parameters").contains(name)) continue;
    const std::vector<double> values = numbers(stated.at("parameters").at(name)), sigmas = numbers(sigma),
                              truth = numbers(hidden.at("parameters").at(name));
    for (std::size_t i = 0; i < std::min({values.size(), sigmas.size(), truth.size()}); ++i) {
      ++scored.scalars;
      if (std::abs(values[i] - truth[i]) <= 1.96 * sigmas[i]) ++scored.covered;
    }
  }
}

/// Beginning and end of an interval, or the time of a step, where the hidden effect has any.
void compareTimes(const Json& stated, const Json& hidden, Scored& scored) {
  std::vector<std::pair<double, double>> pairs;
  if (hidden.at("active_s").is_array() && stated.at("active_s").is_array())
    for (std::size_t k = 0; k < 2; ++k)
      pairs.emplace_back(stated.at("active_s")[k].get<double>(), hidden.at("active_s")[k].get<double>());
  if (hidden.at("parameters").contains("time_s") && stated.at("parameters").contains("time_s"))
    pairs.emplace_back(stated.at("parameters").at("time_s").get<double>(),
                       hidden.at("parameters").at("time_s").get<double>());
  for (const auto& [is, was] : pairs)
    scored.onset_off_s = std::max(scored.onset_off_s.value_or(0), std::abs(is - was));
}

Outcome ofEffects(const std::vector<Stated>& stated, const Json& hidden, const ProofCase& c,
                  std::size_t found) {
  if (found == 0) return Outcome::wrong;
  if (found < hidden.size()) return Outcome::half;
  if (stated.size() > hidden.size()) return Outcome::also_others;
  Outcome outcome = Outcome::right;
  for (const Stated& one : stated) {
    if (one.set.size() < 2) continue;
    const auto own = std::find_if(c.effects.begin(), c.effects.end(), [&](const ProofCase::Effect& e) {
      return std::any_of(one.set.begin(), one.set.end(), [&](const Json& s) { return s.at("id") == e.id; });
    });
    const bool needed = std::all_of(one.set.begin(), one.set.end(), [&](const Json& rival) {
      const std::string id = rival.at("id");
      return id == own->id || std::count(own->inseparable.begin(), own->inseparable.end(), id) > 0;
    });
    if (!needed) return Outcome::needless_set;
    outcome = Outcome::right_set;
  }
  return outcome;
}

}  // namespace

Scored score(const ProofCase& proof_case, const Json& answer) {
  Scored scored;
  scored.proof_case = proof_case;
  const Json& diagnosis = answer.at("diagnosis");
  const Json& hidden = proof_case.generator.at("effects");
  const std::vector<Stated> stated = statedIn(diagnosis);
  std::size_t found = 0;
  for (const Stated& one : stated) {
    scored.stated.push_back(described(one));
    scored.set_size += static_cast<double>(one.set.size()) / static_cast<double>(stated.size());
    for (const Json& effect : hidden) {
      if (hasIt(one, effect)) ++found;
      if (!isSame(one.effect, effect)) continue;
      scored.first_right = scored.first_right || &one == &stated.front();
      countCovered(one.effect, effect, scored);
      compareTimes(one.effect, effect, scored);
    }
  }
  if (!stated.empty()) scored.confidence = stated.front().effect.value("confidence", 0.0);
  scored.in_set = !hidden.empty() && found >= hidden.size();
  const std::string verdict = diagnosis.at("verdict");
  scored.outcome = verdict == "none"           ? Outcome::none
                   : verdict == "unexplained"  ? Outcome::unexplained
                   : verdict == "insufficient" ? Outcome::insufficient
                                               : ofEffects(stated, hidden, proof_case, found);
  return scored;
}

nlohmann::ordered_json toJson(const Scored& s) {
  nlohmann::ordered_json json{
      {"case", toJson(s.proof_case)}, {"outcome", kOutcomes[static_cast<std::size_t>(s.outcome)]},
      {"failure", s.failure},         {"stated", s.stated},
      {"in_set", s.in_set},           {"set_size", s.set_size},
      {"confidence", s.confidence},   {"first_right", s.first_right},
      {"scalars", s.scalars},         {"covered", s.covered},
      {"onset_off_s", nullptr},       {"gains", nullptr}};
  if (s.onset_off_s) json["onset_off_s"] = *s.onset_off_s;
  if (const auto& g = s.gains)
    json["gains"] = {
        {"truth", g->truth}, {"stated", g->stated}, {"runner_up", g->runner_up}, {"black_box", g->black_box}};
  return json;
}

Scored scoredOf(const Json& json) {
  Scored s;
  s.proof_case = caseOf(json.at("case"));
  const auto outcome = std::find(kOutcomes.begin(), kOutcomes.end(), json.at("outcome").get<std::string>());
  s.outcome = static_cast<Outcome>(outcome - kOutcomes.begin());
  s.failure = json.at("failure");
  s.stated = json.at("stated");
  s.in_set = json.at("in_set");
  s.set_size = json.at("set_size");
  s.confidence = json.at("confidence");
  s.first_right = json.at("first_right");
  s.scalars = json.at("scalars");
  s.covered = json.at("covered");
  if (!json.at("onset_off_s").is_null()) s.onset_off_s = json.at("onset_off_s").get<double>();
  if (const Json& g = json.at("gains"); !g.is_null())
    s.gains = Gains{g.at("truth"), g.at("stated"), g.at("runner_up"), g.at("black_box")};
  return s;
}

}  // namespace fathom::proof
