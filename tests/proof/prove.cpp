// The proof: seals recordings that hide an effect, two, none, or what no effect describes; has `fathom`
// diagnose them without the truth; scores what it says. Beside them, what it says of real recordings.
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "advised.h"
#include "batch/share.h"
#include "core/child_process.h"
#include "core/error.h"
#include "core/files.h"
#include "core/for_each.h"
#include "core/text.h"
#include "effects/calibration.h"
#include "gains.h"
#include "inputs/batch_recording.h"
#include "plan.h"
#include "proof_measures.h"
#include "proof_report.h"
#include "real_recordings.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

struct Options {
  fs::path out = "proof";
  Programs programs{fs::path(FATHOM_BINARY_DIR) / "tests/sealed/fathom-seal",
                    fs::path(FATHOM_BINARY_DIR) / "app/fathom"};
  bool quick = false, keep = false;
  std::uint64_t first_seed = 1;
  double ordinary = 0;
  std::optional<std::size_t> nulls;
  std::vector<std::string> kinds;  ///< empty: all, and real recordings
  std::string share = "1/1";
  fs::path expect;  ///< a result.json before; empty: none

  std::set<ProofCase::Kind> askedKinds() const {
    std::set<ProofCase::Kind> asked;
    for (std::size_t k = 0; k < kKinds.size(); ++k)
      if (std::find(kinds.begin(), kinds.end(), kKinds[k]) != kinds.end())
        asked.insert(static_cast<ProofCase::Kind>(k));
    return asked;
  }

  /// Of the real world, beside the checkout: no licence to ship it.
  static fs::path realData() { return fs::path(FATHOM_SOURCE_DIR) / ".." / "shared" / "data"; }
};

/// A case's folders. What was done remains when the work is interrupted.
struct Places {
  fs::path recording, judge, truth, answer, score;
};
Places placesOf(const fs::path& out, const std::string& name) {
  return {out / "recordings" / name, out / "judges" / name, out / "truth" / name, out / "answers" / name,
          out / "scores" / (name + ".json")};
}

std::vector<ProofCase> readPlan(const fs::path& file) {
  std::vector<ProofCase> cases;
  for (const nlohmann::json& json : nlohmann::json::parse(readTextFile(file))) cases.push_back(caseOf(json));
  return cases;
}

std::vector<ProofCase> planOf(const Options& options) {
  const fs::path file = options.out / "plan.json";
  if (fs::exists(file)) return readPlan(file);
  Extent extent = options.quick ? quickProof() : wholeProof();
  extent.first_seed = options.first_seed;
  extent.ordinary = options.ordinary;
  if (options.nulls) extent.nulls = *options.nulls;
  extent.kinds = options.askedKinds();
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ProofCase& c : planProof(extent, options.programs, options.out / "plan"))
    json.push_back(toJson(c));
  writeTextFile(file, json.dump(1) + "\n");
  if (!options.keep) fs::remove_all(options.out / "plan");
  return readPlan(file);
}

/// Many recordings at a time are quicker than many threads on one.
void stayOnOwnCore() {
  thread_local bool done = false;
  if (!done) stayOnOneCore(static_cast<std::size_t>(tbb::this_task_arena::current_thread_index()));
  done = true;
}

BatchInput inputOf(const fs::path& recording, const fs::path& folder) {
  BatchRecordingOptions reading;
  reading.rawlog = recording / "recording.rawlog";
  reading.pixels = true;
  reading.folder = folder;
  return readBatchRecording(reading, {}).input;
}

/// Whether the answer can be judged on another dive.
bool isJudged(const ProofCase& c) { return c.kind == ProofCase::Kind::effect && c.stratum >= 8; }

/// The same vehicle in the same water on another dive.
nlohmann::json judgeCase(const ProofCase& c) {
  nlohmann::json other = c.generator;
  other["dive"]["seed"] = other["dive"]["seed"].get<std::uint64_t>() + 500;
  other["dive"]["manoeuvre"] = other["dive"]["manoeuvre"] == "rich" ? "approach" : "rich";
  other["seed"] = other["seed"].get<std::uint64_t>() + 1;
  return other;
}

/// Drives what the answer advises, where it is a set, and diagnoses that.
void followAdvice(const nlohmann::json& answer, const Places& places, const Options& options,
                  Scored& scored) {
  scored.advised = adviceIn(scored, answer);
  if (!scored.advised) return;
  ProofCase c = scored.proof_case;
  c.name += "-advised";
  const Places again = placesOf(options.out, c.name);
  try {
    fs::path path = again.truth;
    path += ".tum";
    c.generator = advisedCase(c, *scored.advised, places.recording, places.answer, path);
    sealRecording(options.programs, c.generator, again.recording, again.truth);
    diagnoseBlind(options.programs, again.recording, {}, again.answer, options.out / "truth");
    const Scored then = score(c, nlohmann::json::parse(readTextFile(again.answer / "result.json")));
    scored.advised->outcome = then.outcome;
    scored.advised->stated = then.stated;
  } catch (const Error& error) {
    scored.advised->failure = error.what();
  }
  if (!options.keep) fs::remove_all(again.recording);
}

Scored scoredCase(const ProofCase& c, const Places& places, const Options& options) {
  sealRecording(options.programs, c.generator, places.recording, places.truth);
  std::vector<fs::path> judges;
  if (isJudged(c)) {
    sealRecording(options.programs, judgeCase(c), places.judge, places.truth.string() + "-judge");
    judges.push_back(places.judge);
  }
  diagnoseBlind(options.programs, places.recording, judges, places.answer, options.out / "truth");
  const nlohmann::json answer = nlohmann::json::parse(readTextFile(places.answer / "result.json"));
  Scored scored = score(c, answer);
  if (isJudged(c) && !scored.stated.empty())
    scored.gains = gainsOf(c, inputOf(places.recording, places.answer), inputOf(places.judge, places.answer),
                           readCalibration(places.answer / "calibration.yaml"), answer);
  followAdvice(answer, places, options, scored);
  return scored;
}

void runCase(const ProofCase& c, const Options& options) {
  const Places places = placesOf(options.out, c.name);
  if (fs::exists(places.score)) return;
  stayOnOwnCore();
  tbb::task_arena alone(1);
  Scored scored;
  try {
    scored = alone.execute([&] { return scoredCase(c, places, options); });
  } catch (const Error& error) {
    scored.proof_case = c;
    scored.outcome = Outcome::failed;
    scored.failure = error.what();
  }
  if (!options.keep)
    for (const fs::path& folder : {places.recording, places.judge}) fs::remove_all(folder);
  writeTextFile(places.score, toJson(scored).dump(1) + "\n");
}

fs::path realAnswer(const Options& options, const RealRecording& recording) {
  return options.out / "real" / (recording.name + ".json");
}

void runReal(const RealRecording& recording, const Options& options) {
  const fs::path file = realAnswer(options, recording);
  if (fs::exists(file)) return;
  stayOnOwnCore();
  writeTextFile(file,
                answerTo(recording, options.programs, options.out / "real" / recording.name).dump(1) + "\n");
}

/// What there is to do.
struct Work {
  std::vector<ProofCase> cases;
  std::vector<RealRecording> real;
};

ProofResults resultsSoFar(const Work& work, const Options& options) {
  ProofResults results;
  for (const ProofCase& c : work.cases)
    if (const fs::path file = placesOf(options.out, c.name).score; fs::exists(file))
      results.scored.push_back(scoredOf(nlohmann::json::parse(readTextFile(file))));
  for (const RealRecording& recording : work.real)
    if (const fs::path file = realAnswer(options, recording); fs::exists(file))
      results.real.push_back(nlohmann::json::parse(readTextFile(file)));
  return results;
}

void writeResults(const Work& work, const Options& options, const std::string& command_line) {
  const ProofResults results = resultsSoFar(work, options);
  const RunInfo run{.command_line = command_line, .seed = options.first_seed};
  nlohmann::ordered_json json = toJson(run);
  for (const auto& row : measureTable(results.scored).rows)
    json["measures"][row[0]] = {{"target", row[1]}, {"reached", row[2]}};
  for (const Scored& s : results.scored) json["outcomes"][s.proof_case.name] = nameOf(s.outcome);
  json["recordings"] = results.scored.size();
  json["planned"] = work.cases.size();
  json["real"] = results.real;
  writeJson(options.out / "result.json", json);
  writeProofReport(results, run, options.out / "report.html");
  for (const Table& table : tablesOf(results)) std::cout << formatTable(table) << "\n";
  std::cout << results.scored.size() << " of " << work.cases.size() << " sealed and " << results.real.size()
            << " of " << work.real.size() << " real recordings; wrote "
            << (options.out / "report.html").string() << "\n";
}

/// Whether all is answered as it was before; says what is not.
bool isAsExpected(const Options& options) {
  if (options.expect.empty()) return true;
  const auto outcomesIn = [](const fs::path& file) {
    return nlohmann::json::parse(readTextFile(file)).at("outcomes").get<std::map<std::string, std::string>>();
  };
  const std::map<std::string, std::string> before = outcomesIn(options.expect),
                                           now = outcomesIn(options.out / "result.json");
  for (const auto& [name, outcome] : before)
    if (const auto found = now.find(name); found == now.end() || found->second != outcome)
      std::cout << name << ": " << (found == now.end() ? "not there" : found->second)
                << ", before: " << outcome << "\n";
  return before == now;
}

void run(Options options, const std::string& command_line) {
  options.out = fs::absolute(options.out);
  fs::create_directories(options.out);
  const Share share = shareOf("--share", options.share);
  Work work{planOf(options), realRecordings(Options::realData(), options.quick)};
  if (work.real.empty()) std::cout << "no real recordings: ../shared/data is not there\n";
  if (!options.kinds.empty()) {
    // A plan that was made before may have more.
    std::erase_if(work.cases,
                  [asked = options.askedKinds()](const ProofCase& c) { return !asked.contains(c.kind); });
    work.real.clear();
  }
  const std::size_t sealed = work.cases.size();
  try {
    forEachIndex(sealed + work.real.size(), "recordings", [&](std::size_t i) {
      if (!share.has(i)) return;
      if (i < sealed)
        runCase(work.cases[i], options);
      else
        runReal(work.real[i - sealed], options);
    });
  } catch (const Interrupted&) {
    writeResults(work, options, command_line);  // of what is done
    throw;
  }
  writeResults(work, options, command_line);
}

}  // namespace
}  // namespace fathom::proof

int main(int argc, char** argv) {
  fathom::proof::Options options;
  CLI::App app(
      "Proves `fathom diagnose` on sealed recordings. What is done remains: the same command goes on.");
  app.add_option("--out", options.out, "Folder")->capture_default_str();
  app.add_flag("--quick", options.quick, "A sample: a few minutes");
  app.add_option("--first-seed", options.first_seed, "Another proof of the same kind")->capture_default_str();
  app.add_option("--ordinary", options.ordinary,
                 "Imperfections within the error budget in every recording, in units of the generator's")
      ->capture_default_str();
  app.add_option("--nulls", options.nulls, "So many recordings that hide nothing");
  app.add_option("--kind", options.kinds, "Only these")->check(CLI::IsMember(fathom::proof::kKinds));
  app.add_option("--share", options.share, "Of the recordings, on one of several machines: 2/5")
      ->capture_default_str();
  app.add_option("--fathom", options.programs.fathom, "The program to be proved")->capture_default_str();
  app.add_flag("--keep", options.keep, "Keep the recordings");
  app.add_option("--expect", options.expect,
                 "A result.json: exit status 1 where an outcome is not as it has it");
  CLI11_PARSE(app, argc, argv);
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  fathom::catchInterrupts();
  try {
    fathom::proof::run(options, command_line);
    return fathom::proof::isAsExpected(options) ? 0 : 1;
  } catch (const fathom::Error& error) {
    std::cerr << "fathom-prove: " << error.what() << "\n";
    return 2;
  } catch (const fathom::Interrupted&) {
    return 130;
  }
}
