#pragma once

#include <string>
#include <vector>

#include "diagnosis/covariate.h"
#include "diagnosis/whitened_model.h"

/// Where a model and a recording differ, whatever the cause: residuals against everything that a mismatch may
/// depend on.
namespace fathom {

/// How far readings are off in one bin of a covariate.
struct MismatchBin {
  double low = 0, high = 0;  ///< of the covariate, in its unit
  std::string label;         ///< "id 14", "2.1 to 2.4 m"
  std::size_t rows = 0;
  double mean_raw = 0;  ///< in the reading's unit as people read it (ChannelText::unit), along the direction;
                        ///< without one, the length of the mean over all components
  double sigma = 0;     ///< of it, by the readings' own scatter
  double size_sigma = 0;  ///< root of its score statistic, nuisances projected off
};

/// How a channel's residuals depend on one covariate.
struct Mismatch {
  Channel channel = kChannel<Prior>;
  std::string statistic;  ///< "mean residual", "shift of an image", "spectrum", …
  std::string direction;  ///< axis, or way in the image; empty: all
  std::string against;    ///< "marker id", "time", "range", …
  std::string unit;       ///< of the covariate
  double size_sigma = 0;  ///< the worst bin's
  double size_raw = 0;    ///< what of the residuals it makes up, root mean square beyond chance
  std::string raw_unit;
  double statistic_value = 0;  ///< chi-square of dof where nothing is missing
  int dof = 0;
  double log_p = 0, p_value = 1;  ///< of the statistic, times the number of maps looked at
  Interval when_s;                ///< the worst bin's readings
  std::string where;              ///< the worst bin
  bool material = false;          ///< large enough to matter: see ChannelText::material
  std::vector<MismatchBin> bins;
};

/// All maps, the most improbable first.
std::vector<Mismatch> mismatchMaps(const WhitenedModel& model, std::uint64_t seed);

}  // namespace fathom
