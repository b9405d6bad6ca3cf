#include "reports/diagnosis_mismatch_report.h"

#include <algorithm>

#include "core/text.h"

namespace fathom {
namespace {

/// The same of another model; null: it was not tested.
const Mismatch* find(const std::vector<Mismatch>& all, const Mismatch& like) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Mismatch& m) {
    return m.channel == like.channel && m.direction == like.direction && m.statistic == like.statistic &&
           m.against == like.against;
  });
  return found == all.end() ? nullptr : &*found;
}

/// All values of a text field, in the order of their first appearance.
template <class Text>
std::vector<std::string> distinct(const std::vector<Mismatch>& all, Text text) {
  std::vector<std::string> values;
  for (const Mismatch& mismatch : all)
    if (std::find(values.begin(), values.end(), text(mismatch)) == values.end())
      values.push_back(text(mismatch));
  return values;
}

/// Covariates down, sensors across: the largest size, coloured where it is not chance.
Table heatTable(const std::vector<Mismatch>& all, double false_alarm) {
  constexpr double kDarkest_sigma = 8.0;
  const auto channelOf = [](const Mismatch& m) { return nameOf(m.channel); };
  const auto covariateOf = [](const Mismatch& m) { return m.against; };
  auto channels = distinct(all, channelOf);
  std::sort(channels.begin(), channels.end());
  Table table{{"against"}, {}};
  table.header.insert(table.header.end(), channels.begin(), channels.end());
  for (const std::string& covariate : distinct(all, covariateOf)) {
    table.rows.push_back({covariate});
    table.shades.push_back({0});
    for (const std::string& channel : channels) {
      double size_sigma = 0;
      bool any = false, significant = false;
      for (const Mismatch& m : all) {
        if (channelOf(m) != channel || covariateOf(m) != covariate) continue;
        size_sigma = std::max(size_sigma, m.size_sigma);
        significant = significant || isSignificant(m, false_alarm);
        any = true;
      }
      table.rows.back().push_back(any ? fixed(size_sigma, 1) : "-");
      table.shades.back().push_back(significant ? 0.1 + size_sigma / kDarkest_sigma : 0.0);
    }
  }
  return table;
}

/// "speed", "marker id (mean corner residual)": most are mean residuals.
std::string structureOf(const Mismatch& m) {
  return m.statistic == "mean residual" ? m.against : m.against + " (" + m.statistic + ")";
}

Table mismatchTable(const DiagnosisStory& story) {
  constexpr std::size_t kMostRows = 20;
  const BatchData& data = story.read.input.data;
  Table table{{"sensor", "against", "sigma", "size", "p", "where", "when", "matters", "left"}, {}};
  for (const Mismatch& m : story.diagnosis.mismatch) {
    if (table.rows.size() == kMostRows || !isSignificant(m, story.false_alarm)) continue;
    const Mismatch* left = find(story.diagnosis.remaining, m);
    table.rows.push_back({sensorOf(m), structureOf(m), fixed(m.size_sigma, 1),
                          print("%.3g %s", m.size_raw, m.raw_unit.c_str()), probabilityText(m.log_p), m.where,
                          textOf(within(m.when_s, data)), m.material ? "yes" : "no",
                          left != nullptr ? fixed(left->size_sigma, 1) : "-"});
  }
  return table;
}

/// The worst first; where nothing stands out, a few that show so.
std::vector<const Mismatch*> worthPlotting(const DiagnosisStory& story) {
  constexpr std::size_t kMost = 12, kFew = 3;
  std::vector<const Mismatch*> chosen;
  for (const Mismatch& m : story.diagnosis.mismatch) {
    if (m.bins.size() < 2) continue;
    if (chosen.size() < kFew || (chosen.size() < kMost && isSignificant(m, story.false_alarm)))
      chosen.push_back(&m);
  }
  return chosen;
}

}  // namespace

void addMismatch(const DiagnosisStory& story, HtmlReport& report) {
  const Diagnosis& d = story.diagnosis;
  report.heading("Where the nominal model and the recording differ");
  if (d.mismatch.empty()) return report.paragraph("No residuals were tested.");
  report.paragraph(print(
      "How far each sensor's residuals are off against each covariate: the worst bin, in sigma. Coloured: "
      "more than chance explains at %g %%, having looked at all.",
      100 * story.false_alarm));
  report.table(heatTable(d.mismatch, story.false_alarm));
  if (const Table table = mismatchTable(story); !table.rows.empty()) {
    report.paragraph(
        "The most improbable, with the probability of as much by chance. Matters: large enough in pixels, "
        "millimetres, millimetres per second. Left: sigma with what was found in the model.");
    report.table(table);
  }
  if (d.effects.empty()) return;
  report.paragraph("The same, with what was found in the model:");
  report.table(heatTable(d.remaining, story.false_alarm));
}

void addResiduals(const DiagnosisStory& story, const BeforeAndAfter& residuals, HtmlReport& report) {
  const bool changed = !story.diagnosis.effects.empty();
  report.heading(changed ? "Residuals before and after" : "Residuals");
  for (const Mismatch* mismatch : worthPlotting(story))
    report.plot(covariatePlot(*mismatch, changed ? find(story.diagnosis.remaining, *mismatch) : nullptr),
                print("Structure of %.3g %s, %.1f sigma at its worst%s.", mismatch->size_raw,
                      mismatch->raw_unit.c_str(), mismatch->size_sigma, changed ? ", before" : ""));
  for (const Plot& plot : residualPlots(story, residuals)) report.plot(plot);
}

}  // namespace fathom
