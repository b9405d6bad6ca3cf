#pragma once

#include <string>
#include <vector>

#include "diagnosis/whitened_model.h"

/// What is said of residuals, held out or of another recording: names and units.
namespace fathom {

/// What a whitened residual of 1 is in the unit of ChannelText::metric.
double printedUnit(const Linearization& linear, const NoiseModel& noise, Channel channel);
/// All channels, the one that a change of the model's readings (whitened) shows most in first: the estimate
/// follows some of it.
std::vector<Channel> channelsOf(const WhitenedModel& model, const Eigen::VectorXd& change);

}  // namespace fathom
