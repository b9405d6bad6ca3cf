#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording_info.h"
#include "sensors/vehicle.h"

/// The files that go with a recording, and whether they agree with it.
namespace fathom {

/// The vehicle file: `option` where it is not empty, else the one that the recording's first comment names,
/// relative to the rawlog's folder; nothing where neither does. Throws Error where the comment names a file
/// that is not there.
std::optional<std::filesystem::path> vehicleFile(const std::string& option,
                                                 const std::filesystem::path& rawlog,
                                                 const RecordingHeader& header);
/// The panel map, likewise.
std::optional<std::filesystem::path> panelMapFile(const std::string& option,
                                                  const std::filesystem::path& rawlog,
                                                  const RecordingHeader& header);

/// The same, where there must be one. Throw Error that names the option too.
std::filesystem::path neededVehicleFile(const std::string& option, const std::filesystem::path& rawlog,
                                        const RecordingHeader& header);
std::filesystem::path neededPanelMapFile(const std::string& option, const std::filesystem::path& rawlog,
                                         const RecordingHeader& header);

/// Where mountings and camera intrinsics in a recording and in the vehicle file differ, and sensors that the
/// vehicle file lacks; one line each. The recording's values are the nominal ones of that recording.
std::vector<std::string> disagreements(const RecordingInfo& recording, const Vehicle& vehicle);

}  // namespace fathom
