#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "report/html_report.h"
#include "simulation/read_trajectory.h"
#include "tasks/sample_chain.h"
#include "tasks/start_pose.h"
#include "tasks/stress_runs.h"
#include "tasks/task_run.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct StressOptions {
  ChainOptions chain;
  std::string faults = "config/stress.yaml", task = "TL5", improved = "config/improved.yaml", start = "auto",
              folder;
  bool paper_only = false;
};

std::string strengthText(const StressRun& run) {
  return run.vary.empty() ? "-" : run.vary + " " + shortest(run.strength);
}

std::string saidText(const StressRun& run) {
  std::string text;
  for (const Event& event : run.events) {
    if (event.kind == "found" || text.size() > 120) continue;
    text.append(text.empty() ? "" : "; ").append(fixed(event.t_s, 0) + " s " + event.kind);
  }
  return text.empty() ? "-" : text;
}

Table stressTable(const std::vector<StressRun>& runs) {
  Table table{.header = {"fault", "strength", "outcome", "position error: mean [m]", "largest", "at the end",
                         "largest while not lost", "said lost [s]", "outside in silence [s]",
                         "what it said"}};
  for (const StressRun& run : runs) {
    std::vector<double> errors;
    for (const PoseError& error : run.errors) errors.push_back(error.position_m.norm());
    const bool any = !errors.empty();
    table.rows.push_back({run.fault, strengthText(run), nameOf(run.outcome),
                          any ? fixed(meanAndSigma(errors).mean, 3) : "-",
                          any ? fixed(*std::max_element(errors.begin(), errors.end()), 2) : "-",
                          fixed(run.final_error_m, 3), fixed(run.largest_unflagged_m, 2),
                          fixed(run.lost_s, 0), fixed(run.longest_silent_s, 0), saidText(run)});
  }
  return table;
}

/// Error over time under one fault: a line for each strength, and one without the fault.
Plot faultPlot(const std::string& fault, const std::vector<StressRun>& runs) {
  Plot plot{.title = fault, .x_label = "time [s]", .y_label = "position error [m]"};
  plot.log_y = true;
  for (const StressRun& run : runs) {
    if (run.fault != fault && run.fault != "none") continue;
    Series series{.name = run.fault == "none" ? "no fault" : strengthText(run)};
    for (const PoseError& error : run.errors) {
      series.x.push_back(error.t_s);
      series.y.push_back(error.position_m.norm());
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

/// The sweep: what each strength did, all faults of one kind of quantity cannot share an axis, so one plot
/// each.
Plot sweepPlot(const std::string& fault, const std::vector<StressRun>& runs) {
  Plot plot{.title = fault + ": sweep", .x_label = "strength", .y_label = "position error [m]"};
  plot.log_y = true;
  plot.height_px = 260;
  Series mean{.name = "mean"}, largest{.name = "largest"};
  for (const StressRun& run : runs) {
    if (run.fault != fault || run.errors.empty()) continue;
    plot.x_label = run.vary;
    double sum = 0, most = 0;
    for (const PoseError& error : run.errors) {
      sum += error.position_m.norm();
      most = std::max(most, error.position_m.norm());
    }
    mean.x.push_back(run.strength);
    largest.x.push_back(run.strength);
    mean.y.push_back(sum / static_cast<double>(run.errors.size()));
    largest.y.push_back(most);
  }
  plot.series = {mean, largest};
  return plot;
}

nlohmann::ordered_json toJson(const StressRun& run) {
  nlohmann::ordered_json json{{"fault", run.fault},
                              {"vary", run.vary},
                              {"strength", run.strength},
                              {"outcome", nameOf(run.outcome)},
                              {"final_error_m", run.final_error_m},
                              {"largest_error_while_not_lost_m", run.largest_unflagged_m},
                              {"longest_silence_s", run.longest_silent_s},
                              {"lost_s", run.lost_s}};
  if (run.summary.lost_since_s) json["lost_since_s"] = *run.summary.lost_since_s;
  json["events"] = nlohmann::ordered_json::array();
  for (const Event& event : run.events)
    json["events"].push_back({{"t_s", event.t_s}, {"kind", event.kind}, {"text", event.text}});
  return json;
}

void writeOutputs(const StressOptions& options, const TaskSpec& task, const std::vector<StressRun>& runs,
                  const std::vector<StressFault>& faults, const RunInfo& info) {
  const fs::path folder = options.folder;
  const Table table = stressTable(runs);
  HtmlReport report("Faults and what they do to " + task.name());
  report.paragraph(
      "Each fault acts on the recording's samples on their way to the filter. Unharmed: the pose stays "
      "inside its "
      "own bounds (NEES below " +
      fixed(kStressBound, 1) +
      ", once in ten thousand by chance). Recovered: it left them, or said that it was lost, and found back. "
      "Wrong in silence: it is outside at the end and does not say so. Between sightings nothing can tell a "
      "small "
      "fault of the odometry; how long the pose was outside without saying so is listed.");
  report.table(table);
  for (const StressFault& fault : faults) {
    report.subheading(fault.name);
    report.plot(faultPlot(fault.name, runs));
    report.plot(sweepPlot(fault.name, runs));
  }
  report.footer(info);
  report.write(folder / "report.html");
  nlohmann::ordered_json json{{"run", toJson(info)}, {"task", task.name()}};
  json["runs"] = nlohmann::ordered_json::array();
  for (const StressRun& run : runs) json["runs"].push_back(toJson(run));
  writeJson(folder / "result.json", json);
}

void stress(const StressOptions& options, const RunContext& context) {
  const std::vector<StressFault> faults = readStress(shippedFile(options.faults));
  TaskSpec task{readTask(options.task), false};
  if (!options.paper_only)
    task = {readLocalizationOptions(shippedFile(options.improved), task.options), true};
  task.options.smooth = false;
  const SampleChain chain(options.chain, task.fusesLandmarks());
  for (const std::string& remark : chain.remarks()) std::cout << "note: " << remark << "\n";
  const std::vector<StampedPose> truth = readRecordedPoses(options.chain.rawlog);
  LocalizationSetup setup = chain.setup();
  setup.options = task.options;
  setup.start = startPose(options.start, options.chain.rawlog, truth);
  const auto runs = runStress(
      setup, [&] { return chain.open(); }, truth, faults);
  writeOutputs(options, task, runs, faults, {.command_line = context.command_line});
  std::cout << formatTable(stressTable(runs)) << "\nwrote "
            << (fs::path(options.folder) / "report.html").string() << " and result.json beside it\n";
}

}  // namespace

void addStress(const RunContext& context) {
  auto* command = context.root->add_subcommand("stress", "See what faults of the sensors do to a task");
  command->footer(
      "Runs a task on a recording with TRUTH, once as it is and once for each fault at each strength: "
      "samples\n"
      "that are dropped, late, noisy, biased, doubled, out of order, garbage, or not there for a while. "
      "Says\n"
      "of each whether the estimate bore it, recovered, said that it is lost, or was wrong in silence.\n"
      "\n"
      "Examples:\n"
      "  fathom stress rawlogs/trial/trial.rawlog --out out/stress\n"
      "  fathom stress trial.rawlog --task TL2 --faults my_faults.yaml --out out/stress");
  const auto options = std::make_shared<StressOptions>();
  command->add_option("RECORDING", options->chain.rawlog, "The recording")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where the results go")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--faults", options->faults, "Which faults, and how strong")
      ->capture_default_str()
      ->type_name(values::kYaml);
  command->add_option("--task", options->task, "A name stands for config/NAME.yaml")->capture_default_str();
  command->add_option("--improved", options->improved, "What is changed in the task")
      ->capture_default_str()
      ->type_name(values::kYaml);
  command->add_flag("--paper-only", options->paper_only, "Run the task as it is");
  command->add_option("--start", options->start, "auto, reference or X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]")
      ->capture_default_str();
  addChainOptions(*command, options->chain);
  command->callback([options, &context] { stress(*options, context); });
}

}  // namespace fathom
