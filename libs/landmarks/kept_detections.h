#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fiducials/detection.h"

/// The file in which detections are kept. Used within this room only.
namespace fathom {

/// Detections by a fingerprint of the image.
using KeptDetections = std::map<std::string, std::vector<Detection>>;

/// `inputs` is a text that differs where detections of the same image would. Empty where the file is missing,
/// damaged or of other inputs.
KeptDetections readKept(const std::filesystem::path& file, const std::string& inputs);

/// Every number is kept to the last bit. The same detections give the same bytes. Throws Error.
void writeKept(const std::filesystem::path& file, const std::string& inputs, const KeptDetections& kept);

}  // namespace fathom
