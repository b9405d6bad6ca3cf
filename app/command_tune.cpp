#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "report/html_report.h"
#include "tasks/task_run.h"
#include "tuning/tune.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct TuneCommand {
  ChainOptions chain;
  std::vector<std::string> recordings;
  std::string task = "TL5", improved = "config/improved.yaml", folder;
  bool paper_only = false;
  double longest_s = 600.0, block_s = 20.0;
};

/// What the filter fuses, and no more than the longest stretch that is asked for.
std::vector<Sample> samplesOf(SampleSource& source, double longest_s) {
  std::vector<Sample> samples;
  std::optional<Time> begin;
  while (auto sample = source.next()) {
    if (std::holds_alternative<ImageSample>(sample->reading) ||
        std::holds_alternative<StereoSample>(sample->reading))
      continue;
    if (!begin) begin = sample->time;
    if (secondsBetween(*begin, sample->time) > longest_s) break;
    samples.push_back(std::move(*sample));
  }
  return samples;
}

std::string remark(const TunedParameter& p) {
  constexpr double kOpen = 0.1;  // an interval that begins there is one from above
  if (!p.is_told || p.low < kOpen * p.after) return "hardly told";
  return p.is_constant ? "" : "not constant";
}

Table parameterTable(const Tuning& tuning) {
  Table table{.header = {"noise", "unit", "before", "after", "95 % from", "to", ""}, .rows = {}};
  for (const TunedParameter& p : tuning.parameters)
    table.rows.push_back({p.name, p.unit, print("%.3g", p.before), print("%.3g", p.after),
                          print("%.3g", p.low), print("%.3g", p.high), remark(p)});
  return table;
}

std::string gainText(const Tuning& tuning) {
  const auto gain = tuning.judgedGain();
  return gain ? fixed(*gain, 3) : "nothing that could be judged";
}

/// What was found is worse than what it began with, where it had not looked; or nothing tells.
std::string warningOf(const Tuning& tuning) {
  if (!tuning.judgedGain()) return "no stretch is left to judge by: what was found is untried";
  if (*tuning.judgedGain() < 0.0)
    return "what was found is worse on stretches that were not fitted: keep the noise as it was, or give "
           "longer recordings, of one vehicle";
  return {};
}

/// Mean NIS by its degrees of freedom, over all recordings.
Table nisTable(const Tuning& tuning) {
  Table table{
      .header = {"channel", "NIS / dof before, fitted", "judged", "after, fitted", "judged", "readings"},
      .rows = {}};
  std::map<Channel, std::array<ChannelScore, 4>> all;
  const auto add = [&all](const InnovationScore& score, std::size_t column) {
    for (const auto& [channel, seen] : score.channels) {
      ChannelScore& sum = all[channel][column];
      sum.degrees_of_freedom = seen.degrees_of_freedom;
      sum.count += seen.count;
      sum.nis_sum += seen.nis_sum;
    }
  };
  for (std::size_t i = 0; i < tuning.scores_before.size(); ++i) {
    add(tuning.scores_before[i].fit, 0);
    add(tuning.scores_before[i].judged, 1);
    add(tuning.scores_after[i].fit, 2);
    add(tuning.scores_after[i].judged, 3);
  }
  for (const auto& [channel, columns] : all) {
    std::vector<std::string> row{nameOf(channel)};
    for (const ChannelScore& seen : columns)
      row.push_back(seen.count == 0 ? "-" : fixed(seen.nisMean() / seen.degrees_of_freedom, 2));
    row.push_back(std::to_string(columns[2].count + columns[3].count));
    table.rows.push_back(row);
  }
  return table;
}

nlohmann::ordered_json toJson(const Tuning& tuning) {
  nlohmann::ordered_json json;
  json["parameters"] = nlohmann::ordered_json::array();
  for (const TunedParameter& p : tuning.parameters)
    json["parameters"].push_back({{"name", p.name},
                                  {"unit", p.unit},
                                  {"before", p.before},
                                  {"after", p.after},
                                  {"interval95", {p.low, p.high}},
                                  {"told", p.is_told},
                                  {"constant", p.is_constant}});
  json["warning"] = warningOf(tuning);
  json["judged_gain_per_innovation"] = nullptr;
  if (const auto gain = tuning.judgedGain()) json["judged_gain_per_innovation"] = *gain;
  return json;
}

void writeOutputs(const TuneCommand& command, const Tuning& tuning, const Vehicle& vehicle,
                  const RunInfo& info) {
  const fs::path folder = command.folder;
  fs::create_directories(folder);
  writeTextFile(folder / "localize.yaml", "# By fathom tune: fathom localize --config takes it.\n" +
                                              formatLocalizationOptions(tuning.after));
  writeTextFile(folder / "robot_localization.yaml", robotLocalizationYaml(tuning, vehicle));
  HtmlReport report("Noise by the innovations");
  report.paragraph(
      "The sizes of process and measurement noise under which the filter's own innovations are likeliest, on "
      "every "
      "other stretch of " +
      fixed(command.block_s, 0) +
      " s; the stretches between judge. On them each innovation's log likelihood gains " + gainText(tuning) +
      " by what was found.");
  if (const std::string warning = warningOf(tuning); !warning.empty()) report.warning(warning);
  report.table(parameterTable(tuning),
               "Standard deviations; of a drive the square root of its density. Hardly told: the interval is "
               "mostly that "
               "of the prior, one decade. Not constant: the innovations scatter more in some seconds than in "
               "others by more than chance, as where the robot is pushed by fits and starts. What was found "
               "suits the filter, but is not the sensor's own noise.");
  report.table(nisTable(tuning), "A consistent filter has 1 everywhere.");
  report.heading("As options of fathom localize");
  report.preformatted(formatLocalizationOptions(tuning.after));
  report.footer(info);
  report.write(folder / "report.html");
  nlohmann::ordered_json json = toJson(tuning);
  json["run"] = toJson(info);
  writeJson(folder / "result.json", json);
}

void tuneNoise(const TuneCommand& command, const RunContext& context) {
  TaskSpec task{readTask(command.task), false};
  if (!command.paper_only)
    task = {readLocalizationOptions(shippedFile(command.improved), task.options), true};
  task.options.smooth = false;
  std::vector<TunedRecording> recordings;
  for (const std::string& rawlog : command.recordings) {
    ChainOptions options = command.chain;
    options.rawlog = rawlog;
    const SampleChain chain(options, task.fusesLandmarks());
    for (const std::string& remark : chain.remarks())
      std::cout << "note: " << rawlog << ": " << remark << "\n";
    recordings.push_back({chain.setup(), samplesOf(*chain.open(), command.longest_s)});
  }
  Progress progress("tuning");
  const Tuning tuning = tune(recordings, task.options, {.blocks = {.block_s = command.block_s}},
                             [&](double fraction) { progress.update(fraction); });
  writeOutputs(command, tuning, recordings.front().setup.vehicle, {.command_line = context.command_line});
  if (const std::string warning = warningOf(tuning); !warning.empty())
    std::cout << "warning: " << warning << "\n\n";
  std::cout << formatTable(parameterTable(tuning)) << "\n"
            << formatTable(nisTable(tuning))
            << "\non stretches that were not fitted an innovation's log likelihood gains " << gainText(tuning)
            << "\n\nwrote " << (fs::path(command.folder) / "report.html").string()
            << ", result.json, localize.yaml and robot_localization.yaml beside it\n";
}

}  // namespace

void addTune(const RunContext& context) {
  auto* command = context.root->add_subcommand("tune", "Find a filter's noise from recordings");
  command->footer(
      "Finds process noise (of each regime: station keeping, transit, turning), the sigma of each sensor and "
      "the\n"
      "INS's biases under which the filter's own innovations are likeliest, without any truth, on every "
      "other\n"
      "stretch of the recordings; judges them on the stretches between. Writes localize.yaml, which\n"
      "`fathom localize --config` takes, the same as parameters for robot_localization, and a report with "
      "the\n"
      "intervals. All recordings are of one vehicle.\n"
      "\n"
      "Examples:\n"
      "  fathom tune rawlogs/trial/trial.rawlog --out out/tune\n"
      "  fathom tune dives/*.rawlog --task TL2 --out out/tune\n"
      "  fathom localize trial.rawlog --config out/tune/localize.yaml --out out/tuned");
  const auto options = std::make_shared<TuneCommand>();
  command->add_option("RECORDING", options->recordings, "The recordings")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where the results go")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--task", options->task, "A name stands for config/NAME.yaml")->capture_default_str();
  command->add_option("--improved", options->improved, "What is changed in the task")
      ->capture_default_str()
      ->type_name(values::kYaml);
  command->add_flag("--paper-only", options->paper_only, "The task as it is");
  command->add_option("--longest", options->longest_s, "No more than so many seconds of each recording")
      ->capture_default_str()
      ->check(positive());
  command->add_option("--block", options->block_s, "Length of a stretch, s")
      ->capture_default_str()
      ->check(positive());
  addChainOptions(*command, options->chain);
  command->callback([options, &context] { tuneNoise(*options, context); });
}

}  // namespace fathom
