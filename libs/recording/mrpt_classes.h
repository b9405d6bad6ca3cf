#pragma once

#include <mrpt/rtti/CObject.h>

#include <string>

/// MRPT's classes by the names that rawlogs have for them.
namespace fathom {

/// Loads MRPT's libraries of maps and of vision, which have observations of their own (point clouds, rotating
/// scans, visual landmarks), where they are installed. Linked they would cost every command the time to load
/// them, of OpenCV's windows too; few rawlogs need them. True the first time only, where that gave classes
/// that were not there before.
bool loadFurtherMrptClasses();

/// Of any namespace where the name has none, as MRPT before 2.0 wrote it. Null where the installed MRPT has
/// no such class; its further libraries are loaded to find out.
const mrpt::rtti::TRuntimeClassId* findMrptClass(const std::string& name);

}  // namespace fathom
