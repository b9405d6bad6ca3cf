#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/plot.h"
#include "reports/diagnosis_story.h"

namespace fathom {

/// How a channel's residuals depend on one covariate, of the nominal model and of the final one. Null: the
/// final one was not tested so.
Plot covariatePlot(const Mismatch& before, const Mismatch* after);

/// Held-out stretches one by one: before, after, black box, and what noise alone makes.
Plot heldOutPlot(const HeldOut& heldout);

/// Residuals of the nominal model's estimate and, where they differ, of the final one's; nothing of one that
/// has not succeeded.
struct BeforeAndAfter {
  std::optional<Linearization> before, after;

  explicit BeforeAndAfter(const DiagnosisStory& story);
};

/// White and black of the markers against range, as recorded and as the nominal model and the final one have
/// them: a plot a colour. None without patches.
std::vector<Plot> brightnessPlots(const DiagnosisStory& story, const BeforeAndAfter& residuals);

/// Raw residuals of each channel over time, of the nominal model's estimate and, where they differ, of the
/// final one's: two plots of the same scale.
std::vector<Plot> residualPlots(const DiagnosisStory& story, const BeforeAndAfter& residuals);

}  // namespace fathom
