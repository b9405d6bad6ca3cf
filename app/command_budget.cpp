#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/files.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "diagnosis/budget_file.h"
#include "diagnosis/budget_learning.h"
#include "diagnosis/diagnosis.h"
#include "report/run_info.h"
#include "report/table.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct BudgetCommand {
  BatchRecordingOptions recording;
  std::vector<std::string> recordings;
  std::string budget = "config/error_budget.yaml";
  DiagnosisOptions diagnosis;
};

struct Learnt {
  ErrorBudget before, after;
  std::vector<std::string> quiet;
  std::vector<std::pair<std::string, std::string>> left_out;  ///< recordings, and why
};

/// Nothing where a budget can be learnt from it.
std::string reasonAgainst(const Diagnosis& diagnosis) {
  if (diagnosis.verdict == Verdict::none) return {};
  return nameOf(diagnosis.verdict) + ": " + diagnosis.why;
}

Learnt learn(const BudgetCommand& command) {
  Learnt learnt;
  DiagnosisOptions options = command.diagnosis;
  options.budget = readErrorBudget(shippedFile(command.budget));
  std::vector<std::vector<EstimatedScale>> scales;
  for (const std::string& rawlog : command.recordings) {
    BatchRecordingOptions reading = command.recording;
    reading.rawlog = rawlog;
    reading.pixels = true;
    const Diagnosis diagnosis = diagnose(readBatchRecording(reading, options.calibration).input, options);
    if (const std::string why = reasonAgainst(diagnosis); !why.empty()) {
      learnt.left_out.emplace_back(rawlog, why);
      continue;
    }
    learnt.quiet.push_back(rawlog);
    learnt.before = diagnosis.noise.budget;
    scales.push_back(diagnosis.noise.scales);
  }
  if (scales.empty())
    throw Error(learnt.left_out.front().first, "",
                "in none of the recordings is nothing missing: " + learnt.left_out.front().second);
  learnt.after = learntBudget(learnt.before, scales);
  learnt.after.name = "vehicle";
  return learnt;
}

Table componentTable(const Learnt& learnt) {
  Table table{.header = {"component", "unit", "sigma before", "learnt", "99 % from", "to"}, .rows = {}};
  for (std::size_t k = 0; k < learnt.after.components.size(); ++k) {
    const VarianceComponent &before = learnt.before.components[k], &after = learnt.after.components[k];
    table.rows.push_back({after.name, after.unit, print("%.3g", before.sigma), print("%.3g", after.sigma),
                          print("%.3g", after.sigma / after.factor),
                          print("%.3g", after.sigma * after.factor)});
  }
  return table;
}

nlohmann::ordered_json toJson(const Learnt& learnt, const RunInfo& run) {
  nlohmann::ordered_json json{{"quiet", learnt.quiet},
                              {"left_out", nlohmann::ordered_json::array()},
                              {"components", nlohmann::ordered_json::array()}};
  for (const auto& [recording, why] : learnt.left_out)
    json["left_out"].push_back({{"recording", recording}, {"why", why}});
  for (std::size_t k = 0; k < learnt.after.components.size(); ++k)
    json["components"].push_back({{"component", learnt.after.components[k].name},
                                  {"unit", learnt.after.components[k].unit},
                                  {"before", learnt.before.components[k].sigma},
                                  {"sigma", learnt.after.components[k].sigma},
                                  {"factor", learnt.after.components[k].factor}});
  json["run"] = toJson(run);
  return json;
}

void learnBudget(const BudgetCommand& command, const RunContext& context) {
  const Learnt learnt = learn(command);
  const fs::path folder = command.recording.folder, file = folder / "error_budget.yaml";
  fs::create_directories(folder);
  writeTextFile(file, formatErrorBudget(learnt.after,
                                        "By fathom budget, for fathom diagnose --budget: ordinary for one "
                                        "vehicle, as its quiet recordings show it."));
  writeJson(folder / "result.json", toJson(learnt, {.command_line = context.command_line}));
  std::cout << formatTable(componentTable(learnt)) << "\n";
  for (const auto& [recording, why] : learnt.left_out)
    std::cout << "note: " << recording << " is left out; " << why << "\n";
  std::cout << "learnt from " << learnt.quiet.size() << " of " << command.recordings.size()
            << " recordings\nwrote " << file.string() << ", result.json beside it\n";
}

}  // namespace

void addBudget(const RunContext& context) {
  auto* command =
      context.root->add_subcommand("budget", "Learn a vehicle's error budget from its quiet recordings");
  command->footer(
      "What readings of this vehicle differ by for no reason that has a name, for `fathom diagnose "
      "--budget`:\n"
      "each recording is diagnosed, and where nothing is missing the sizes of the budget's components are\n"
      "taken together. What a recording tells nothing of stays as --budget has it; half of the factor's\n"
      "variance there is taken to be between vehicles, half between recordings of one. Recordings in which\n"
      "something is missing are left out, which is said. All recordings are of one vehicle.\n"
      "\n"
      "Examples:\n"
      "  fathom budget quiet/*.rawlog --out out/budget\n"
      "  fathom diagnose dive.rawlog --budget out/budget/error_budget.yaml --out out/dive");
  const auto options = std::make_shared<BudgetCommand>();
  command->add_option("RECORDING", options->recordings, "The recordings")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->recording.folder, "Where the results go")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--budget", options->budget, "What is known beforehand")
      ->type_name(values::kYaml)
      ->capture_default_str();
  command->add_option("--seed", options->diagnosis.seed, "Of what each recording is compared with")
      ->capture_default_str();
  addBatchInputOptions(*command, options->recording);
  command->callback([options, &context] { learnBudget(*options, context); });
}

}  // namespace fathom
