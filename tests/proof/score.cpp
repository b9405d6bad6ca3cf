#include "score.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

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

void compareParameters(const Json& stated, const Json& hidden, Scored& scored) {
  double off = 0, size = 0;  // in sigmas, squared
  for (const auto& [name, sigma] : stated.at("sigma").items()) {
    if (!hidden.at("parameters").contains(name)) continue;
    const std::vector<double> values = numbers(stated.at("parameters").at(name)), sigmas = numbers(sigma),
                              truth = numbers(hidden.at("parameters").at(name));
    for (std::size_t i = 0; i < std::min({values.size(), sigmas.size(), truth.size()}); ++i) {
      ++scored.scalars;
      if (std::abs(values[i] - truth[i]) <= 1.96 * sigmas[i]) ++scored.covered;
      if (!(sigmas[i] > 0)) continue;
      off += std::pow((values[i] - truth[i]) / sigmas[i], 2);
      size += std::pow(truth[i] / sigmas[i], 2);
    }
  }
  if (size > 0 && !scored.parameters_off) scored.parameters_off = std::sqrt(off / size);
}

std::optional<OwnStretches> ownStretchesIn(const Json& diagnosis) {
  const auto gain = diagnosis.find("heldout_log_likelihood_gain");
  if (gain == diagnosis.end() || diagnosis.at("effects").empty()) return {};
  return OwnStretches{gain->at("physics"), gain->at("black_box"), gain->at("over_black_box_ci95").at(0),
                      gain->at("placebo")};
}

/// When an effect acts within its recording: of a step or a cloud just its time.
struct When {
  double from_s = 0;
  std::optional<double> to_s;
};
When whenOf(const Json& effect, double duration_s) {
  if (const Json& parameters = effect.at("parameters"); parameters.contains("time_s"))
    return {parameters.at("time_s"), {}};
  const Json& active_s = effect.at("active_s");
  if (active_s.is_null()) return {0, duration_s};
  return {std::max(0.0, active_s.at(0).get<double>()), std::min(duration_s, active_s.at(1).get<double>())};
}

void compareTimes(const Json& stated, const Json& hidden, double duration_s, Scored& scored) {
  const When is = whenOf(stated, duration_s), was = whenOf(hidden, duration_s);
  scored.onset_off_s = std::abs(is.from_s - was.from_s);
  if (is.to_s && was.to_s) scored.end_off_s = std::abs(*is.to_s - *was.to_s);
}

bool names(const Stated& stated, const std::string& id) {
  return std::any_of(stated.set.begin(), stated.set.end(), [&](const Json& c) { return c.at("id") == id; });
}

Outcome ofEffects(const std::vector<Stated>& stated, const Json& hidden, const ProofCase& c,
                  std::size_t found) {
  if (found == 0) return Outcome::wrong;
  if (found < hidden.size()) return Outcome::half;
  if (stated.size() > hidden.size()) return Outcome::also_others;
  Outcome outcome = Outcome::right;
  for (const Stated& one : stated) {
    if (one.set.size() < 2) continue;
    const auto own = std::find_if(c.effects.begin(), c.effects.end(),
                                  [&](const ProofCase::Effect& e) { return names(one, e.id); });
    const bool needed = std::all_of(one.set.begin(), one.set.end(), [&](const Json& rival) {
      const std::string id = rival.at("id");
      return id == own->id || std::count(own->inseparable.begin(), own->inseparable.end(), id) > 0;
    });
    if (!needed) return Outcome::needless_set;
    outcome = Outcome::right_set;
  }
  return outcome;
}

/// Of what the generator counts as outside the catalogue, what has a name of its own there since.
bool namesOutsider(const std::vector<Stated>& stated, const Json& generator) {
  static const std::map<std::string, std::string> own_names{{"panel-folded", "panel-shape"}};
  for (const Json& outsider : generator.value("outside", Json::array()))
    if (const auto own = own_names.find(outsider.at("kind")); own != own_names.end())
      return stated.size() == 1 && names(stated[0], own->second);
  return false;
}

}  // namespace

bool isTimed(const Json& hidden_effect) {
  return !hidden_effect.at("active_s").is_null() || hidden_effect.at("parameters").contains("time_s");
}

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
    for (const ProofCase::Effect& effect : proof_case.effects)
      scored.rival_in_set = scored.rival_in_set || names(one, effect.runner_up);
    for (const Json& effect : hidden) {
      if (hasIt(one, effect)) ++found;
      if (!isSame(one.effect, effect)) continue;
      scored.first_right = scored.first_right || &one == &stated.front();
      compareParameters(one.effect, effect, scored);
      if (isTimed(effect))
        compareTimes(one.effect, effect, proof_case.generator.at("dive").at("duration_s"), scored);
    }
  }
  if (!stated.empty()) scored.confidence = stated.front().effect.value("confidence", 0.0);
  scored.own = ownStretchesIn(diagnosis);
  scored.in_set = !hidden.empty() && found >= hidden.size();
  const std::string verdict = diagnosis.at("verdict");
  scored.outcome = verdict == "none"           ? Outcome::none
                   : verdict == "unexplained"  ? Outcome::unexplained
                   : verdict == "insufficient" ? Outcome::insufficient
                   : namesOutsider(stated, proof_case.generator)
                       ? Outcome::right
                       : ofEffects(stated, hidden, proof_case, found);
  return scored;
}

namespace {

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
std::optional<double> numberOf(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

Outcome outcomeOf(const Json& json) {
  const auto outcome = std::find(kOutcomes.begin(), kOutcomes.end(), json.get<std::string>());
  return static_cast<Outcome>(outcome - kOutcomes.begin());
}

Json toJson(const std::optional<OwnStretches>& own) {
  if (!own) return nullptr;
  return {{"physics", own->physics},
          {"black_box", own->black_box},
          {"over_black_box", own->over_black_box},
          {"placebo", own->placebo}};
}
std::optional<OwnStretches> ownStretchesOf(const Json& own) {
  if (own.is_null()) return {};
  return OwnStretches{own.at("physics"), own.at("black_box"), own.at("over_black_box"), own.at("placebo")};
}

Json toJson(const std::optional<Gains>& g) {
  if (!g) return nullptr;
  return {
      {"truth", g->truth}, {"stated", g->stated}, {"runner_up", g->runner_up}, {"black_box", g->black_box}};
}
std::optional<Gains> gainsIn(const Json& g) {
  if (g.is_null()) return {};
  return Gains{g.at("truth"), g.at("stated"), g.at("runner_up"), g.at("black_box")};
}

Json toJson(const std::optional<Advised>& a) {
  if (!a) return nullptr;
  return {{"manoeuvre", a->manoeuvre},     {"minutes", a->minutes}, {"from_s", a->from_s},
          {"outcome", nameOf(a->outcome)}, {"stated", a->stated},   {"failure", a->failure}};
}
std::optional<Advised> advisedIn(const Json& a) {
  if (a.is_null()) return {};
  return Advised{a.at("manoeuvre"),          a.at("minutes"), a.at("from_s"),
                 outcomeOf(a.at("outcome")), a.at("stated"),  a.at("failure")};
}

}  // namespace

nlohmann::ordered_json toJson(const Scored& s) {
  return {{"case", toJson(s.proof_case)},
          {"outcome", nameOf(s.outcome)},
          {"failure", s.failure},
          {"stated", s.stated},
          {"in_set", s.in_set},
          {"set_size", s.set_size},
          {"confidence", s.confidence},
          {"first_right", s.first_right},
          {"scalars", s.scalars},
          {"covered", s.covered},
          {"parameters_off", orNull(s.parameters_off)},
          {"rival_in_set", s.rival_in_set},
          {"onset_off_s", orNull(s.onset_off_s)},
          {"end_off_s", orNull(s.end_off_s)},
          {"own", toJson(s.own)},
          {"gains", toJson(s.gains)},
          {"advised", toJson(s.advised)}};
}

Scored scoredOf(const Json& json) {
  Scored s;
  s.proof_case = caseOf(json.at("case"));
  s.outcome = outcomeOf(json.at("outcome"));
  s.failure = json.at("failure");
  s.stated = json.at("stated");
  s.in_set = json.at("in_set");
  s.set_size = json.at("set_size");
  s.confidence = json.at("confidence");
  s.first_right = json.at("first_right");
  s.scalars = json.at("scalars");
  s.covered = json.at("covered");
  s.parameters_off = numberOf(json.at("parameters_off"));
  s.rival_in_set = json.at("rival_in_set");
  s.onset_off_s = numberOf(json.at("onset_off_s"));
  s.end_off_s = numberOf(json.at("end_off_s"));
  s.own = ownStretchesOf(json.at("own"));
  s.gains = gainsIn(json.at("gains"));
  s.advised = advisedIn(json.at("advised"));
  return s;
}

}  // namespace fathom::proof
