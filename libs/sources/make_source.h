#pragma once

#include <filesystem>
#include <memory>

#include "core/yaml.h"
#include "recording/sample_source.h"

namespace fathom {

/// A file that says where each sensor's samples come from:
///
///   default: recording            # or simulation, or a rawlog; may be left out
///   from: {DVL: simulation, DVL_BEAMS: simulation, CAMERA: other.rawlog}
///   simulation:                   # where it is named above
///     trajectory: recording       # its TRUTH; or another rawlog's, or TUM text
///     vehicle: rov.yaml           # may be left out where the recording names one
///     calibration: dvl_bad.yaml   # optional: effects to switch on
///     seed: 1
///     noise: true                 # false: no white noise, no random biases
///     sea_floor_z_m: -6
///
/// `recording` is the one the program is run on. Files are relative to this file's folder. The simulation
/// begins and ends with the recording, as far as the trajectory reaches. All sources must tell the same
/// absolute time. Images cannot be simulated on the way: simulate a recording and name it here.
///
/// Throws Error, beside what reading the files throws: an unknown sensor, a source without the sensor that is
/// wanted from it, one that has no time in common with the recording. Reads the recordings named once
/// beforehand, to see what is in them.
std::unique_ptr<SampleSource> makeSource(const std::filesystem::path& file,
                                         const std::filesystem::path& recording);
/// The same from a map in a file that lies in `folder`; unknown keys are left to the caller.
std::unique_ptr<SampleSource> makeSource(const YamlMap& map, const std::filesystem::path& folder,
                                         const std::filesystem::path& recording);

}  // namespace fathom
