// How good the diagnosis is, measured: recordings that hide an effect of a size, nothing, something outside
// the catalogue, or are no recordings; diagnosed, scored, counted.
//
//     build/release/tests/diagnosis_campaign                  all of it
//     build/release/tests/diagnosis_campaign --effects dvl-scale,marker-moved --sqrt-lambda 16 --nulls 0
//     --outside 0
//     build/release/tests/diagnosis_campaign --images --duration 24 --no-wrong-input
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/for_each.h"
#include "core/text.h"
#include "report/table.h"
#include "support/diagnosis_score.h"
#include "support/flawed_runs.h"
#include "support/stopwatch.h"

namespace fathom {
namespace {

using test::Answer;
using test::Outcome;

struct CampaignOptions {
  std::string effects = "all";
  std::vector<double> sqrt_lambda{8, 16, 32};
  std::size_t seeds = 5, nulls = 60, outside = 12;
  bool no_wrong_input = false, images = false, verbose = false;
  std::uint64_t first_seed = 1;
  double duration_s = 80;
  std::string out;
};

enum class Kind { effect, null, rich_null, outside, wrong_input };
constexpr std::array kKinds{"effect", "null", "richer null", "outside the catalogue", "wrong input"};

/// One recording to come, and what became of it.
struct Case {
  Kind kind = Kind::null;
  std::size_t number = 0;  ///< effect in the registry, or in a list
  double asked = 0;        ///< sqrt(lambda)
  std::uint64_t seed = 1;
  test::DiagnosisRun run;
  Answer answer{};
  double seconds = 0;

  std::string label() const {
    std::string text = run.truth ? nameOf(*run.truth) : run.name;
    if (asked > 0) text += print(" at %g", asked);
    return text + print(" (seed %llu)", static_cast<unsigned long long>(seed));
  }
};

std::string joined(const std::vector<std::string>& parts, const char* separator) {
  std::string text;
  for (const std::string& part : parts) text.append(text.empty() ? "" : separator).append(part);
  return text;
}

/// All: of light where there are images, the others where there are only the markers in them.
std::vector<std::size_t> chosenEffects(const std::string& list, bool images) {
  std::vector<std::size_t> chosen;
  if (list == "none") return chosen;
  for (const EffectInfo& effect : allEffects())
    if (list == "all" && (effect.text.channel == EffectChannel::image) == images)
      chosen.push_back(effect.index);
  if (list == "all") return chosen;
  for (const std::string& id : CLI::detail::split(list, ',')) {
    const EffectInfo* effect = findEffect(id);
    if (effect == nullptr) throw Error("--effects", id, "is none of " + knownEffects());
    chosen.push_back(effect->index);
  }
  return chosen;
}

std::vector<Case> casesOf(const CampaignOptions& options, const test::BatchRun& nominal) {
  std::vector<Case> cases;
  const auto add = [&](Kind kind, std::size_t number, double asked, std::uint64_t seed) {
    cases.push_back({kind, number, asked, seed, {"", nominal, {}, {}, 0, nullptr, {}}});
  };
  const std::uint64_t first = options.first_seed;
  for (const std::size_t effect : chosenEffects(options.effects, options.images))
    for (const double size : options.sqrt_lambda)
      for (std::uint64_t s = 0; s < options.seeds; ++s) add(Kind::effect, effect, size, first + s);
  for (std::size_t i = 0; i < options.nulls; ++i)
    add(i % 2 == 0 ? Kind::null : Kind::rich_null, i, 0, first + i / 2);
  for (std::size_t i = 0; i < options.outside; ++i) add(Kind::outside, i, 0, first);
  if (!options.no_wrong_input)
    for (std::size_t i = 0; i < test::wrongInputs(nominal).size(); ++i) add(Kind::wrong_input, i, 0, first);
  return cases;
}

test::DiagnosisRun runOf(const Case& c, const test::BatchRun& nominal, const test::Excitation& excitation) {
  switch (c.kind) {
    case Kind::effect:
      return test::effectOfSize(nominal, excitation, allEffects()[c.number], c.asked, c.seed);
    case Kind::null:
      return test::plainNull(nominal, c.seed);
    case Kind::rich_null:
      return test::richNull(nominal, c.seed);
    case Kind::outside:
      return nominal.pixels ? test::outsideLight(nominal, c.number, c.seed)
                            : test::outsideCatalogue(nominal, c.number, c.seed);
    case Kind::wrong_input:
      break;
  }
  return test::wrongInputs(nominal)[c.number];
}

/// Each recording on one thread, so many at a time.
void diagnoseAll(std::vector<Case>& cases, const test::BatchRun& nominal, const test::Excitation& excitation,
                 bool verbose) {
  forEachIndex(cases.size(), "diagnosing", [&](std::size_t i) {
    tbb::task_arena alone(1);
    alone.execute([&] {
      Case& c = cases[i];
      c.run = runOf(c, nominal, excitation);
      c.seconds = test::seconds([&] { c.answer = test::answerOf(c.run, excitation); });
      if (verbose)
        std::fprintf(stderr, "%s: %s; %s; best tested %s, alarm p %.2g; %.1f s; %s\n", c.label().c_str(),
                     nameOf(c.answer.outcome).c_str(),
                     joined(c.answer.named.empty() ? c.answer.nearest : c.answer.named, ", ").c_str(),
                     c.answer.best_tested.c_str(), c.answer.alarm_p, c.seconds, c.answer.why.c_str());
    });
  });
}

/// Whether a recording was answered as is asked of its kind.
bool isGood(const Case& c) {
  switch (c.kind) {
    case Kind::effect:
      return test::namesTheEffect(c.answer);
    case Kind::null:
    case Kind::rich_null:
      return c.answer.outcome == Outcome::none;
    case Kind::outside:
      return test::ownsUp(c.answer);
    case Kind::wrong_input:
      break;
  }
  return test::isCautious(c.answer);
}

struct Count {
  std::size_t runs = 0, good = 0, first = 0, alarms = 0, intervals_off = 0;
  int scalars = 0, covered = 0;
  double seconds = 0;
  std::map<Outcome, std::size_t> outcomes;

  void add(const Case& c) {
    ++runs;
    good += isGood(c) ? 1 : 0;
    first += c.answer.rank == 1 ? 1 : 0;
    alarms += c.answer.alarm_p < 0.05 ? 1 : 0;
    intervals_off += c.answer.interval_off ? 1 : 0;
    scalars += c.answer.scalars;
    covered += c.answer.covered;
    seconds += c.seconds;
    ++outcomes[c.answer.outcome];
  }
  std::string of(Outcome outcome) const {
    const auto found = outcomes.find(outcome);
    return found == outcomes.end() ? "" : std::to_string(found->second);
  }
};

std::string percent(double part, double whole) {
  return whole > 0 ? print("%.0f %%", 100.0 * part / whole) : "-";
}

std::vector<std::string> effectRow(const std::string& name, double asked, const Count& n) {
  return {name,
          print("%g", asked),
          std::to_string(n.runs),
          n.of(Outcome::right),
          n.of(Outcome::right_set),
          percent(static_cast<double>(n.good), static_cast<double>(n.runs)),
          n.of(Outcome::needless_set),
          n.of(Outcome::also_others),
          n.of(Outcome::wrong),
          n.of(Outcome::unexplained),
          n.of(Outcome::none),
          n.of(Outcome::insufficient),
          percent(static_cast<double>(n.first), static_cast<double>(n.runs)),
          n.intervals_off > 0 ? std::to_string(n.intervals_off) : "",
          print("%d/%d", n.covered, n.scalars)};
}

Table effectTable(const std::vector<Case>& cases) {
  std::map<std::pair<std::size_t, double>, Count> single;
  std::map<double, Count> all;
  for (const Case& c : cases)
    if (c.kind == Kind::effect) {
      single[{c.number, c.asked}].add(c);
      all[c.asked].add(c);
    }
  Table table{{"effect", "sqrt lambda", "runs", "right", "set", "good", "needless set", "also others",
               "wrong", "unexplained", "none", "insufficient", "first of all", "interval off", "95 % cover"}};
  for (const auto& [key, count] : single)
    table.rows.push_back(effectRow(std::string(allEffects()[key.first].id), key.second, count));
  for (const auto& [asked, count] : all) table.rows.push_back(effectRow("all", asked, count));
  return table;
}

Table otherTable(const std::vector<Case>& cases) {
  Table table{{"recordings", "runs", "good", "named", "unexplained", "none", "insufficient", "refused",
               "alarm p < 0.05", "s each"}};
  for (std::size_t k = 1; k < kKinds.size(); ++k) {
    Count n;
    for (const Case& c : cases)
      if (static_cast<std::size_t>(c.kind) == k) n.add(c);
    if (n.runs == 0) continue;
    table.rows.push_back({kKinds[k], std::to_string(n.runs), std::to_string(n.good), n.of(Outcome::wrong),
                          n.of(Outcome::unexplained), n.of(Outcome::none), n.of(Outcome::insufficient),
                          n.of(Outcome::refused), std::to_string(n.alarms),
                          fixed(n.seconds / static_cast<double>(n.runs), 1)});
  }
  return table;
}

/// What was taken for what: of all that was not good.
Table confusionTable(const std::vector<Case>& cases) {
  std::map<std::pair<std::string, std::string>, std::size_t> times;
  for (const Case& c : cases) {
    if (isGood(c)) continue;
    const std::string answer =
        c.answer.named.empty() ? nameOf(c.answer.outcome) : joined(c.answer.named, " + ");
    ++times[{
        (c.run.truth ? nameOf(*c.run.truth) : c.run.name) + (c.asked > 0 ? print(" at %g", c.asked) : ""),
        answer}];
  }
  Table table{{"hidden", "answer", "times"}};
  for (const auto& [pair, count] : times)
    table.rows.push_back({pair.first, pair.second, std::to_string(count)});
  return table;
}

nlohmann::json toJson(const Case& c) {
  nlohmann::json json{{"kind", kKinds[static_cast<std::size_t>(c.kind)]},
                      {"hidden", c.run.truth ? nameOf(*c.run.truth) : c.run.name},
                      {"seed", c.seed},
                      {"outcome", nameOf(c.answer.outcome)},
                      {"good", isGood(c)},
                      {"named", c.answer.named},
                      {"alarm_p", c.answer.alarm_p},
                      {"nearest", c.answer.nearest},
                      {"best_tested", c.answer.best_tested},
                      {"why", c.answer.why}};
  if (c.kind != Kind::effect) return json;
  json["sqrt_lambda"] = {{"asked", c.asked}, {"reached", c.run.sqrt_lambda}};
  json["rank"] = c.answer.rank;
  json["interval_off"] = c.answer.interval_off;
  json["scalars"] = c.answer.scalars;
  json["covered"] = c.answer.covered;
  const EffectInfo& effect = allEffects()[c.number];
  const auto& values = c.run.run.effects.values;
  for (std::size_t i = 0; i < effect.scalars; ++i) json["true"].push_back(values[effect.first_scalar + i]);
  return json;
}

void run(const CampaignOptions& options) {
  test::BatchRun nominal = test::richRun(1, options.duration_s);
  nominal.pixels = options.images;
  const test::Excitation excitation(nominal);
  std::vector<Case> cases = casesOf(options, nominal);
  diagnoseAll(cases, nominal, excitation, options.verbose);
  for (const Table& table : {effectTable(cases), otherTable(cases), confusionTable(cases)})
    if (!table.rows.empty()) std::printf("%s\n", formatTable(table).c_str());
  if (options.out.empty()) return;
  nlohmann::json json = nlohmann::json::array();
  for (const Case& c : cases) json.push_back(toJson(c));
  writeTextFile(options.out, json.dump(1) + "\n");
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) {
  fathom::CampaignOptions options;
  CLI::App app("Diagnoses recordings of which it is known what they hide, and counts.");
  app.add_option("--effects", options.effects, "all, none, or ids separated by commas")
      ->capture_default_str();
  app.add_option("--sqrt-lambda", options.sqrt_lambda, "sizes")->delimiter(',')->capture_default_str();
  app.add_option("--seeds", options.seeds, "of each effect and size")->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "")->capture_default_str();
  app.add_option("--nulls", options.nulls, "half of them richer than the model")->capture_default_str();
  app.add_option("--outside", options.outside, "outside the catalogue")->capture_default_str();
  app.add_flag("--images", options.images, "with the markers' black and white: effects on light");
  app.add_flag("--no-wrong-input", options.no_wrong_input, "leave those out");
  app.add_option("--duration", options.duration_s, "of a recording, s")->capture_default_str();
  app.add_flag("-v,--verbose", options.verbose, "a line for each recording when it is done");
  app.add_option("--out", options.out, "JSON, an entry a recording");
  CLI11_PARSE(app, argc, argv);
  fathom::catchInterrupts();
  try {
    fathom::run(options);
  } catch (const fathom::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const fathom::Interrupted&) {
    return 130;
  }
}
