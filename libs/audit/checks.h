#pragma once

#include <filesystem>
#include <vector>

#include "audit/finding.h"
#include "audit/streams.h"
#include "sensors/vehicle.h"

/// The checks of an audit, by what they look at. Each appends what it found.
namespace fathom {

/// Specific force against gravity in length and direction; the gyro against how the attitude, or gravity,
/// turns; the attitude against gravity; turn rates against the vehicle's limit.
void checkIns(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

/// Pressure against the air's and the vehicle's deepest; its unit by the DVL's way up and down, or by its
/// noise.
void checkDepth(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

/// Velocity against the acceleration (unit, axes), the pressure (up or down) and the vehicle's limit. What
/// the INS or the depth sensor is already found to have wrong is no witness.
void checkDvl(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

/// Stamps: missing, equal, stepping back, of arrival, at another rate than the vehicle file's.
void checkClocks(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

/// Images: size against the camera, blank, the same again. Some are read, at most kMostImagesRead of each
/// camera, evenly.
void checkImages(const Streams& streams, const std::filesystem::path& image_folder,
                 std::vector<Finding>& findings);
inline constexpr std::size_t kMostImagesRead = 40;

/// "NAME" of the first instance, "NAME.2" of another.
Finding finding(const std::string& name, std::string_view label, const Instance& instance,
                Finding::Certainty certainty, std::string what);
/// The same with what would correct it. `axes`: "x,-y,-z", where the correction is one of axes.
Finding correctable(Finding found, std::string corrected, const std::string& axes = {});
bool hasFinding(const std::vector<Finding>& findings, std::string_view label, const Instance& instance);

}  // namespace fathom
