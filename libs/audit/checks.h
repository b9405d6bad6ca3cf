#pragma once

#include <filesystem>
#include <vector>

#include "audit/finding.h"
#include "audit/streams.h"
#include "sensors/vehicle.h"

/// The checks of an audit, by what they look at. Each appends what it found.
namespace fathom {

/// Specific force against gravity in length; an attitude that never changes, an axis of a gyro that is dead.
void checkIns(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

/// Readings that are the same for long, of any instrument.
void checkFrozen(const Streams& streams, std::vector<Finding>& findings);

/// Pressure against the air's and the vehicle's deepest; its unit by the DVL's way up and down, or by its
/// noise.
void checkDepth(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

/// Gyro, accelerometer, attitude, DVL and pressure against each other: which fault of drivers (axes, units,
/// signs, conventions, a clock) makes all of them agree, see assumption.h and agreement.h. What is already
/// found to be wrong is no witness.
/// `clocks_agree`: nothing is found of clocks, so that one may be looked for.
void checkAgreement(const Streams& streams, const Vehicle& vehicle, bool clocks_agree,
                    std::vector<Finding>& findings);

/// Turn rates and speeds against the vehicle's limits, of what nothing else is wrong with.
void checkLimits(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings);

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
/// Of entries of this label; of this name.
bool hasFinding(const std::vector<Finding>& findings, std::string_view label, const Instance& instance);
bool isFound(const std::vector<Finding>& findings, std::string_view name, const Instance& instance);

}  // namespace fathom
