#pragma once

#include <string>
#include <vector>

#include "diagnosis/whitened_model.h"

/// What is said of residuals, held out or of another recording: names and units.
namespace fathom {

/// "dvl_rms_mm_s", …
std::string metricOf(BatchChannel channel);
/// What a whitened residual of 1 is in the unit of metricOf().
double printedUnit(const Linearization& linear, const NoiseModel& noise, BatchChannel channel);
/// All channels, the one that a change of the model's readings (whitened) shows most in first: the estimate
/// follows some of it.
std::vector<BatchChannel> channelsOf(const WhitenedModel& model, const Eigen::VectorXd& change);

}  // namespace fathom
