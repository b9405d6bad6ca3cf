#pragma once

#include <string>
#include <vector>

#include "localization/navigation_state.h"
#include "localization/odom_frame.h"
#include "localization/setup.h"
#include "recording/samples.h"

namespace fathom {

/// The filter's first state and the sigma of each of its 23 coordinates.
struct InitialState {
  double t_s = 0.0;
  NavigationState<double> state;
  Eigen::Matrix<double, kFullSize, 1> sigma;
  FrameCoordinates defined;  ///< which no sensor told
  std::string source;        ///< one line: where position and orientation came from
};

/// Initial alignment from the samples of the first seconds: roll and pitch from the mean specific force (or
/// the INS's attitude), heading from the INS's attitude, position from USBL and pressure, velocity from the
/// DVL, the sea floor from its beams: by the sensors' models, calibrated effects included. What no sensor
/// tells is zero, and with it odom is defined by the start, until a fix tells (OdomFrame). A given start pose
/// replaces position and orientation.
InitialState alignInitially(const LocalizationSetup& setup, const std::vector<Sample>& first);

}  // namespace fathom
