#include "reports/diagnosis_report.h"

#include <algorithm>

#include "core/files.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "environment/water_study.h"
#include "report/html_report.h"
#include "reports/diagnosis_json.h"
#include "reports/diagnosis_mismatch_report.h"
#include "reports/diagnosis_plots.h"

namespace fathom {
namespace {

// ---- what: effects, candidates, alternatives

void addEffects(const DiagnosisStory& story, HtmlReport& report) {
  const std::vector<FoundEffect>& effects = story.diagnosis.effects;
  if (effects.empty()) return;
  report.heading("What is missing");
  for (const FoundEffect& effect : effects)
    report.paragraph(nameOf(effect.candidate) + ": " +
                     std::string(allEffects()[effect.candidate.effect].text.title) + ".");
  report.table(effectTable(story));
  Table evidence{{"effect", "ln odds", "log likelihood", "on held-out stretches", "BIC"}, {}};
  for (const FoundEffect& effect : effects)
    evidence.rows.push_back({nameOf(effect.candidate), fixed(effect.log_odds, 1),
                             fixed(effect.log_likelihood_gain, 1),
                             fixed(effect.heldout_log_likelihood_gain, 1), fixed(effect.bic_gain, 1)});
  report.table(evidence, "Gained over the model without it, all else estimated again.");
  report.paragraph(
      "± is one sigma. Sqrt lambda: an effect's size in units of what this recording could resolve at best.");
}

/// What the mismatch is made of.
void addShares(const Diagnosis& d, HtmlReport& report) {
  if (d.effects.empty()) return;
  report.subheading("What the mismatch is made of");
  std::vector<std::pair<std::string, double>> parts;
  for (const FoundEffect& effect : d.effects) parts.emplace_back(nameOf(effect.candidate), effect.share);
  parts.emplace_back("not explained", d.remainder.share);
  report.shares(parts,
                "Shares of the log likelihood that can be taken away, on stretches that were not fitted.");
  if (d.remainder.share > 0) report.paragraph("What is left: " + d.remainder.where + ".");
}

void addPosterior(const Diagnosis& d, HtmlReport& report) {
  constexpr double kLeast = 0.001;
  Table table{{"hypothesis", "mass"}, {}};
  for (const Hypothesis& hypothesis : d.posterior) {
    std::string name = hypothesis.is_something_else ? "something else, besides or instead"
                       : hypothesis.effects.empty() ? "nothing is missing"
                                                    : "";
    for (const Candidate& effect : hypothesis.effects) name += (name.empty() ? "" : " + ") + nameOf(effect);
    if (hypothesis.mass >= kLeast) table.rows.push_back({name, shareText(hypothesis.mass)});
  }
  report.subheading("How likely each hypothesis is");
  report.table(table, "Of those that were looked at, priors included.");
}

/// The most improbable first.
std::vector<InteractionTest> worstOf(std::vector<InteractionTest> tests, std::size_t count) {
  stableSort(tests,
             [](const InteractionTest& a, const InteractionTest& b) { return a.statistic > b.statistic; });
  tests.resize(std::min(count, tests.size()));
  return tests;
}

void addInteractions(const DiagnosisStory& story, HtmlReport& report) {
  constexpr std::size_t kMost = 4;
  Table table{{"effect", "against", "chi-square of 1", "p", "change [%]", "passed"}, {}};
  for (const FoundEffect& effect : story.diagnosis.effects)
    for (const InteractionTest& test : worstOf(effect.interactions, kMost))
      table.rows.push_back({nameOf(effect.candidate), test.against, fixed(test.statistic, 1),
                            probabilityText(test.log_p), fixed(100 * test.relative_change, 1),
                            test.failed ? "no" : "yes"});
  if (table.rows.empty()) return;
  report.subheading("Is it the same everywhere?");
  report.paragraph(
      "An effect that is really there has the same parameters all over the recording; a stand-in for another "
      "one has not. Each effect's most telling tests; the others are in result.json. Change: of its size "
      "over "
      "one standard deviation of the covariate.");
  report.table(table);
}

void addCandidates(const DiagnosisStory& story, HtmlReport& report) {
  constexpr std::size_t kMostRows = 25;
  const Diagnosis& d = story.diagnosis;
  if (d.tested.empty()) return;
  report.heading("What else was tried");
  Table table{{"candidate", "ln odds", "chi-square", "dof", "p", "kept [%]"}, {}};
  for (const TestedCandidate& t : d.tested) {
    if (table.rows.size() == kMostRows) break;
    table.rows.push_back({nameOf(t.candidate), fixed(t.log_evidence, 1), fixed(t.statistic, 1),
                          std::to_string(t.dof), probabilityText(t.log_p), fixed(100 * t.kept, 1)});
  }
  std::string caption =
      "Each alone against the nominal model, the likeliest first. p: for this candidate alone. Ln odds: that "
      "it "
      "is there, what was expected before and having looked elsewhere accounted for. Kept: what of it the "
      "path, "
      "biases and offsets that are estimated anyway cannot imitate.";
  if (d.tested.size() > table.rows.size())
    caption += print(" %zu more are in result.json.", d.tested.size() - table.rows.size());
  report.table(table, caption);
  report.paragraph("Probability of so good a best one where nothing is missing, having tried them all: " +
                   fixed(d.alarm_p, 4) + ".");
}

void addAlternatives(const DiagnosisStory& story, HtmlReport& report) {
  if (story.diagnosis.alternatives.empty()) return;
  report.heading("What this recording cannot tell apart");
  for (const Alternatives& set : story.diagnosis.alternatives) {
    Table table{{"effect", "ln odds", "alignment", "what tells it apart"}, {}};
    for (std::size_t i = 0; i < set.candidates.size(); ++i)
      table.rows.push_back({nameOf(set.candidates[i]),
                            i < set.log_odds.size() ? fixed(set.log_odds[i], 1) : "-",
                            i < set.alignment.size() ? fixed(set.alignment[i], 3) : "-",
                            std::string(allEffects()[set.candidates[i].effect].text.told_apart)});
    report.table(table, "Ln odds: against the first's. Alignment: 1 is the same to this recording.");
    if (set.advice.separation == 0) continue;  // nothing could be driven
    if (set.advice.manoeuvre.empty())
      report.paragraph(print(
          "No manoeuvre that fathom knows would tell the first from the one most like it in %d minutes.",
          Advice::kMostMinutes));
    else
      report.paragraph(print(
          "A manoeuvre that tells the first from the one most like it: %s, from where the robot was at "
          "%.1f s. A minute of it makes them differ by %.1f times what can be resolved; in this "
          "recording they differ by %.1f.",
          textOf(set.advice).c_str(), set.advice.from_s, set.advice.separation, set.advice.separation_now));
  }
}

// ---- what it looks like

std::string likeness(const SimulatedImage& image) {
  std::string text;
  if (image.fsim) text += print(", FSIM %.4f", *image.fsim);
  if (image.rmse_dn) text += print(", root mean square %.2f DN", *image.rmse_dn);
  return text;
}

void addImages(const DiagnosisStory& story, HtmlReport& report) {
  if (story.images.empty()) return;
  report.heading("Recorded and simulated");
  report.paragraph(
      "From where each image was taken, with the water estimated. Left of the slider is the recorded image, "
      "right of it the simulated one. The maps show recorded less simulated on the panels (what else is "
      "around them is not known, but for open water), red where the recorded image is brighter, on the same "
      "scale without and with what was found.");
  for (const ComparedImage& image : story.images) {
    report.subheading(print("%s, %.1f m from the panel", image.name.c_str(), image.range_m));
    const auto show = [&](const SimulatedImage& simulated, const std::string& which) {
      report.slider(image.recorded_png, simulated.png, "Recorded | " + which + likeness(simulated));
    };
    show(image.before, "simulated with the nominal model");
    if (image.after) show(*image.after, "simulated with what was found");
    const std::string scale = print("Recorded less simulated, full colour at %.1f DN", image.scale_dn);
    if (image.after)
      report.slider(image.before.difference_png, image.after->difference_png,
                    scale + ": nominal model | what was found");
    else
      report.picture(image.before.difference_png, scale);
  }
}

void addBrightness(const DiagnosisStory& story, const BeforeAndAfter& residuals, HtmlReport& report) {
  const std::vector<Plot> plots = brightnessPlots(story, residuals);
  if (plots.empty()) return;
  report.heading("Brightness against range");
  report.paragraph(
      "Each point is what the camera read of one marker's white or black in one image, its response "
      "undone. The lines are what the models say of the same patches, averaged over pieces of range. White "
      "less black has no veil in it; black alone is the veil, and what the camera adds.");
  for (const Plot& plot : plots) report.plot(plot);
}

// ---- does it fit

void addHeldOut(const DiagnosisStory& story, HtmlReport& report) {
  const HeldOutResult& heldout = story.diagnosis.heldout;
  if (heldout.channels.empty()) return;
  report.heading("Does it fit what the fit did not see?");
  report.paragraph(
      "Root mean square on stretches that were held out: there only the effects' parameters are carried "
      "over. "
      "Black box: splines over the covariates in place of physics.");
  report.table(heldOutTable(heldout));
  const HeldOutGain& gain = heldout.gain;
  report.paragraph(print(
      "Log likelihood gained there over the nominal model, all channels together: %.1f (95 %%: %.1f to "
      "%.1f) with the effects, %.1f with the black box (difference, 95 %%: %.1f to %.1f). Where nothing "
      "is missing, the best of all effects gains at most %.1f in 95 of 100 cases.",
      gain.physics, gain.physics_ci95[0], gain.physics_ci95[1], gain.black_box, gain.over_black_box_ci95[0],
      gain.over_black_box_ci95[1], gain.placebo));
  for (const HeldOut& channel : heldout.channels)
    if (!channel.blocks.empty()) report.plot(heldOutPlot(channel));
}

void addElsewhere(const DiagnosisStory& story, HtmlReport& report) {
  if (story.elsewhere.empty()) return;
  report.heading("Does it fit other recordings?");
  report.paragraph(
      "Root mean square of the channel that changes most, and the log likelihood gained over the nominal "
      "model, all channels together: nothing of the effects, nor of the black box, was fitted there. Effects "
      "for a part of the recording are left out.");
  report.table(elsewhereTable(story));
}

std::string burstText(const BudgetEntry& entry) {
  if (entry.outlier_share > 0)
    return print("yes; %.2g %% are outliers, the others %.2g", 100 * entry.outlier_share, entry.others);
  if (entry.apart.empty()) return entry.bursts ? "yes" : "no";
  std::string text = print("%.2g at ", entry.largest_apart);
  for (std::size_t i = 0; i < entry.apart.size(); ++i) text += (i > 0 ? "; " : "") + entry.apart[i];
  return text;
}

void addBudget(const Diagnosis& d, HtmlReport& report) {
  Table table{{"component", "declared", "in this recording", "unit", "bursts", "source"}, {}};
  for (const BudgetEntry& entry : d.budget)
    table.rows.push_back({entry.component, print("%.3g", entry.prior),
                          print("%.2g ± %.1g", entry.estimate, entry.estimate * entry.log_sd), entry.unit,
                          burstText(entry), entry.source});
  report.subheading("The error budget");
  report.table(
      table,
      "What readings may differ by for no reason that has a name: declared (one sigma), and as large as "
      "it is in this recording. A component that would have to be beyond what 99 % of such are bursts: all "
      "of "
      "it, or where single values are not of the others' kind.");
}

void addNoise(const DiagnosisStory& story, HtmlReport& report) {
  const NoiseModel& noise = story.diagnosis.noise;
  Table table{{"channel", "readings' coordinates", "sigma / stated", "correlation of neighbours"}, {}};
  for (const Channel channel : kEveryChannel)
    if (const ChannelNoise& c = noise.of(channel); c.rows > 0)
      table.rows.push_back(
          {nameOf(channel), std::to_string(c.rows), fixed(c.scale, 3), fixed(c.correlation, 3)});
  if (table.rows.empty()) return;
  report.heading("The noise that the recording shows");
  report.table(table);
  addBudget(story.diagnosis, report);
  if (noise.light_scatter > 0)
    report.paragraph(print("Light scatters by %.2g %% of itself besides.", 100 * noise.light_scatter));
  if (noise.parts > 0)
    report.paragraph(print("Half of a place is taken to differ from all of it by %.2g %% of its light.",
                           100 * noise.parts));
}

// ---- with it

/// An option a line, still one command to a shell.
std::string onSeveralLines(std::string command) {
  const std::string before = " --", after = " \\\n    --";
  for (auto at = command.find(before); at != std::string::npos; at = command.find(before, at + after.size()))
    command.replace(at, before.size(), after);
  return command;
}

void addRerun(const DiagnosisStory& story, HtmlReport& report) {
  if (!story.diagnosis.calibration.on.any() && !story.rerun) return;
  report.heading("With what was found");
  report.paragraph(
      "calibration.yaml, beside this report, is taken by `simulate`, `localize`, `smooth`, `sil` and "
      "`diagnose`.");
  report.preformatted(formatCalibration(story.diagnosis.calibration));
  if (const std::string command = simulateCommand(story); !command.empty()) {
    report.paragraph("The dive simulated again with it:");
    report.preformatted(onSeveralLines(command));
  }
  if (!story.rerun) return;
  report.paragraph(
      "Task TL5, improved, without and with it. Mean ± sigma over the sightings; M: the markers' mean pose; "
      "S: "
      "truth; m_A: lag-one autocorrelation of the path's increments.");
  report.table(story.rerun->table);
  for (const std::string& remark : story.rerun->remarks) report.paragraph(remark);
}

void addInputs(const DiagnosisStory& story, HtmlReport& report) {
  const BatchData& data = story.read.input.data;
  report.heading("From what");
  report.paragraph(print("%.1f s; %zu intervals of the gyro, %zu DVL and %zu pressure readings, %zu markers, "
                         "%zu tie points and %zu patches in images. Started from: ",
                         data.last_s - data.first_s, data.of<Gyro>().size(), data.of<Dvl>().size(),
                         data.of<Depth>().size(), data.markers.size(), data.tie_points.size(),
                         data.patches.size()) +
                   story.read.input.start.source + ".");
  Table files{{"input", "fingerprint"}, {}};
  for (const InputFile& input : story.read.files)
    files.rows.push_back({input.file.string(), input.fingerprint});
  report.table(files);
  if (data.left_out.empty()) return;
  Table left{{"readings left out because", "how many"}, {}};
  for (const auto& [why, count] : data.left_out) left.rows.push_back({why, std::to_string(count)});
  report.table(left);
}

void addHeadline(const DiagnosisStory& story, HtmlReport& report) {
  const Diagnosis& d = story.diagnosis;
  report.paragraph(d.why);
  std::vector<std::pair<std::string, std::string>> keys{{"verdict", nameOf(d.verdict)}};
  for (const FoundEffect& effect : d.effects)
    keys.emplace_back("sqrt lambda of " + nameOf(effect.candidate), fixed(effect.sqrt_lambda, 1));
  if (!d.heldout.channels.empty()) {
    const HeldOut& h = d.heldout.channels.front();
    keys.emplace_back("held out, " + h.metric, print("%.3g → %.3g", h.before, h.after));
  }
  report.keyValues(keys);
  for (const std::string& remark : d.remarks) report.warning(remark);
  for (const std::string& remark : story.read.remarks) report.warning(remark);
}

HtmlReport reportOf(const DiagnosisStory& story) {
  const BeforeAndAfter residuals(story);
  HtmlReport report("Diagnosis of " + story.recording.filename().string());
  addHeadline(story, report);
  addEffects(story, report);
  addShares(story.diagnosis, report);
  addPosterior(story.diagnosis, report);
  addInteractions(story, report);
  addAlternatives(story, report);
  addImages(story, report);
  addBrightness(story, residuals, report);
  addMismatch(story, report);
  addCandidates(story, report);
  addHeldOut(story, report);
  addElsewhere(story, report);
  addResiduals(story, residuals, report);
  addNoise(story, report);
  addRerun(story, report);
  addInputs(story, report);
  report.footer(story.run);
  return report;
}

}  // namespace

void writeDiagnosis(const DiagnosisStory& story) {
  const HtmlReport report = reportOf(story);
  const Diagnosis& d = story.diagnosis;
  writePath(story.folder / "trajectory.tum", story.read.input.data, d.after);
  writeTextFile(story.folder / "calibration.yaml", formatCalibration(d.calibration));
  if (hasWater(story))
    writeTextFile(story.folder / "water.yaml",
                  formatEnvironment(environmentOf(d.after.state.water),
                                    "Of " + story.recording.filename().string() + ", by fathom diagnose"));
  report.write(story.folder / "report.html");
  writeJson(story.folder / "result.json", toJson(story));
}

}  // namespace fathom
