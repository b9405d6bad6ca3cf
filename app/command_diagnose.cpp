#include <iostream>
#include <memory>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/files.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "diagnosis/budget_file.h"
#include "effects/calibration.h"
#include "reports/diagnosis_report.h"
#include "reports/diagnosis_rerun.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct DiagnoseOptions {
  BatchRecordingOptions recording;
  std::string calibration, budget = "config/error_budget.yaml";
  DiagnosisOptions diagnosis;
  std::vector<std::filesystem::path> judge;
  bool rerun = false;
};

/// Adds to the story what that which was found is worth on the other recordings.
void judgeOthers(const DiagnoseOptions& options, const std::vector<BatchRecording>& others,
                 DiagnosisStory& story) {
  if (others.empty()) return;
  if (lastingEffects(story.diagnosis).empty()) {
    story.diagnosis.remarks.emplace_back(
        "nothing was found that lasts, so nothing was judged on other recordings");
    return;
  }
  const JudgeElsewhere judge(story.diagnosis, story.read.input);
  for (std::size_t i = 0; i < others.size(); ++i)
    story.elsewhere.push_back({options.judge[i], judge.judge(others[i].input)});
}

/// A fault of a driver is no physics, however well an effect fits it.
void doubtFaults(DiagnosisStory& story) {
  if (story.read.accepted_faults.empty() || story.diagnosis.verdict != Verdict::explained) return;
  std::string names;
  for (const std::string& name : story.read.accepted_faults) names += (names.empty() ? "" : ", ") + name;
  story.diagnosis.verdict = Verdict::unexplained;
  story.diagnosis.why = "the recording has a fault that was accepted (" + names +
                        "): what fits it need be no physics; " + story.diagnosis.why;
}

void printStory(const DiagnosisStory& story) {
  const Diagnosis& d = story.diagnosis;
  std::cout << nameOf(d.verdict) << ": " << d.why << "\n";
  if (!d.effects.empty()) std::cout << "\n" << formatTable(effectTable(story));
  if (!d.heldout.channels.empty()) {
    const HeldOut& h = d.heldout.channels.front();
    std::cout << print(
        "\nHeld out, %s: %.4g before, %.4g after (95 %%: %.4g to %.4g), %.4g with a black box, %.4g by noise "
        "alone\n",
        h.metric.c_str(), h.before, h.after, h.after_ci95[0], h.after_ci95[1], h.black_box, h.noise_floor);
  }
  if (!story.elsewhere.empty())
    std::cout << "\nOn other recordings, nothing fitted there:\n" << formatTable(elsewhereTable(story));
  for (const std::string& remark : d.remarks) std::cout << "note: " << remark << "\n";
  for (const std::string& remark : story.read.remarks) std::cout << "note: " << remark << "\n";
  if (story.rerun) std::cout << "\n" << formatTable(story.rerun->table);
  if (const std::string command = simulateCommand(story); d.calibration.on.any() && !command.empty())
    std::cout << "\nThe dive simulated with it:\n  " << command << "\n";
  std::cout << "\nwrote " << (story.folder / "report.html").string() << ", result.json, calibration.yaml"
            << (hasWater(story) ? ", water.yaml" : "") << " and trajectory.tum beside it\n";
}

void runDiagnosis(DiagnoseOptions options, const RunContext& context) {
  DiagnosisStory story;
  story.run = {.command_line = context.command_line, .seed = options.diagnosis.seed};
  story.recording = options.recording.rawlog;
  story.folder = options.recording.folder;
  story.false_alarm = options.diagnosis.false_alarm;
  std::optional<RecordingJob> again;  // read before the long work, so that a mistake shows at once
  if (options.rerun) again = rerunJob(options.recording, context.command_line);
  if (!options.calibration.empty()) options.diagnosis.calibration = readCalibration(options.calibration);
  options.diagnosis.budget = readErrorBudget(shippedFile(options.budget));
  options.recording.pixels = true;
  story.read = readBatchRecording(options.recording, options.diagnosis.calibration);
  if (!options.calibration.empty()) story.read.files.push_back(inputFile(options.calibration));

  std::vector<BatchRecording> others;
  for (const fs::path& other : options.judge) {
    BatchRecordingOptions reading = options.recording;
    reading.rawlog = other;
    others.push_back(readBatchRecording(reading, options.diagnosis.calibration));
    story.read.files.insert(story.read.files.end(), others.back().files.begin(), others.back().files.end());
  }

  story.diagnosis = diagnose(story.read.input, options.diagnosis);
  doubtFaults(story);
  judgeOthers(options, others, story);
  story.images = compareImages(story.read, story.diagnosis, options.diagnosis.calibration);
  if (again && story.diagnosis.calibration.on.any()) {
    writeTextFile(options.recording.folder / "calibration.yaml",
                  formatCalibration(story.diagnosis.calibration));
    story.rerun = rerunTasks(*again, options.calibration, options.recording.folder);
  }
  writeDiagnosis(story);
  printStory(story);
}

void addFitOptions(CLI::App& command, DiagnoseOptions& options) {
  command
      .add_option("--false-alarm", options.diagnosis.false_alarm,
                  "How often something may be found where nothing is missing")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  command
      .add_option("--budget", options.budget,
                  "Error budget: what readings may differ by for no reason that has a name")
      ->type_name(values::kYaml)
      ->capture_default_str();
  command
      .add_option("--max-effects", options.diagnosis.max_effects, "So many effects are looked for at most")
      ->check(CLI::Range(1, 10))
      ->capture_default_str();
  command
      .add_option("--seed", options.diagnosis.seed,
                  "Of the simulated recordings in which nothing is missing, which results are compared with")
      ->capture_default_str();
}

}  // namespace

void addDiagnose(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "diagnose", "Find out which physics the sensor models leave out, from a recording");
  command->footer(
      "Where do recording and nominal model differ, which effect is missing (`fathom effects`), with which\n"
      "parameters, and does the recording then fit where the fit did not look? The verdict is one of\n"
      "  none          nothing that matters is missing\n"
      "  explained     effects of the catalogue are missing, and take away 95 % of what can be taken away\n"
      "  unexplained   something is missing besides what was found, or instead; it says where\n"
      "  insufficient  the recording could not show it either way\n"
      "Effects that the recording cannot tell apart are named together. Images count by the markers'\n"
      "corners and, where they are exact (PNG), by their light: recorded against rendered, where a panel\n"
      "is in view, and open water above the horizon.\n"
      "\n"
      "Writes report.html, result.json, calibration.yaml (what was found, for `simulate` and `localize`),\n"
      "water.yaml (where light is compared: the water with it, for `simulate` and `sil`) and trajectory.tum\n"
      "(with it in the model). Without INS and DVL each image has a pose by itself; without images the\n"
      "navigation sensors are judged by each other. A reference or TRUTH is never looked at. Detections are\n"
      "kept beside the recording.\n"
      "\n"
      "Examples:\n"
      "  fathom diagnose dive.rawlog --out out/dive\n"
      "  fathom diagnose dive.rawlog --calibration known.yaml --out out/dive\n"
      "  fathom diagnose dive.rawlog --rerun --out out/dive\n"
      "  fathom diagnose monday.rawlog --judge tuesday.rawlog --judge friday.rawlog --out out/dive\n"
      "  fathom localize dive.rawlog --calibration out/dive/calibration.yaml --out out/localized");
  const auto options = std::make_shared<DiagnoseOptions>();
  addBatchRecordingOptions(*command, options->recording);
  command->add_option("--calibration", options->calibration, "Effects known to be there already")
      ->type_name(values::kYaml);
  command->add_flag(
      "!--no-open-water", options->recording.open_water,
      "What is above the horizon, beside the panels, is not endless water: a tank's wall, a ship's hull");
  command
      ->add_option(
          "--light-images", options->recording.most_lit,
          "Images in which light is compared, at most, spread evenly over the recording; corners count "
          "in all")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  addFitOptions(*command, *options);
  command
      ->add_option("--judge", options->judge,
                   "Another recording of the vehicle: judge on it what was found, fitting nothing there; any "
                   "number of times")
      ->allow_extra_args(false)
      ->type_name(values::kRawlog);
  command->add_flag(
      "--rerun", options->rerun,
      "Then localize by task TL5 (config/TL5.yaml, config/improved.yaml), without and with what "
      "was found, and compare");
  command->callback([options, &context] { runDiagnosis(*options, context); });
}

}  // namespace fathom
