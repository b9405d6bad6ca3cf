#pragma once

#include <vector>

#include "localization/odom_frame.h"
#include "localization/setup.h"
#include "recording/samples.h"

namespace fathom {

/// What a sample says of where the robot is in odom, at a time `t_s` and at the state that is believed then:
/// panels whose pose is known, poses by markers, USBL, GNSS, pressure; whether the filter fuses them or not.
std::vector<PoseFix> poseFixes(const LocalizationSetup& setup, const Sample& sample, double t_s,
                               const KinematicState<double>& state);

/// Whether it says where the robot is in the plane: panels, markers, USBL, GNSS.
bool tellsPosition(const Sample& sample);

/// A pose by markers as the options have its covariance.
UncertainPose markersPose(const LocalizationSetup& setup, const PoseSample& markers);

}  // namespace fathom
