#pragma once

#include "sea_trial/sea_trial.h"

/// What the columns of a sea trial's navigation solution hold.
namespace fathom {

/// Whether the columns of longitude and latitude have each other's names: how far positions are off the
/// integrated velocity tells.
void settlePositionColumns(const SeaTrialData& data, SeaTrialConventions& c);

/// Whether the altitude is one or a depth: its slope against the velocity down tells.
void settleAltitude(const SeaTrialData& data, SeaTrialConventions& c);

}  // namespace fathom
