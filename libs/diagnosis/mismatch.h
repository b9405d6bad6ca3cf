#pragma once

#include <string>
#include <vector>

#include "diagnosis/noise.h"

namespace fathom {

/// A mean of residuals in one bin of a covariate.
struct MismatchBin {
  double low = 0, high = 0;  ///< of the covariate
  std::size_t rows = 0;
  double mean_sigma = 0, mean_error_sigma = 0;  ///< whitened residual, and what it scatters by
  double mean_raw = 0;                          ///< in the reading's unit (px, m/s, rad/s, m/s², Pa, m)
};

/// How a channel's residuals depend on one covariate: what the model leaves out shows here.
struct Mismatch {
  BatchChannel channel = BatchChannel::prior;
  int component = -1;     ///< axis; of markers 0 radial, 1 tangential in the image …; -1: all
  std::string statistic;  ///< "mean residual", "excess scatter", "spectrum"
  std::string against;    ///< "marker id", "time", "range", "image radius", "speed", …
  std::string unit;       ///< of the covariate
  double size_sigma = 0;  ///< sqrt of the score statistic over its degrees of freedom
  double size_raw = 0;    ///< rms of the structure, in raw_unit
  std::string raw_unit;
  double statistic_value = 0;
  int dof = 0;
  double p_value = 1, log_p = 0;  ///< for having looked at all maps: by Bonferroni
  Interval when_s;                ///< where most of it sits
  std::string where;              ///< the worst bin, e.g. "id 14"
  bool material = false;          ///< large enough to matter, in px, mm, mm/s
  std::vector<MismatchBin> bins;
};

}  // namespace fathom
