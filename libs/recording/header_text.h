#pragma once

#include <string>

#include "recording/samples.h"

/// A recording's header as the INI text that its first comment holds: section [recording], a line a key,
/// where backslashes and ends of lines in a value are escaped.
namespace fathom {

std::string headerText(const RecordingHeader& header);

/// The inverse. Other sections and keys are passed over, what is missing is empty: whatever the text, it is
/// no error.
RecordingHeader parseHeaderText(const std::string& text);

}  // namespace fathom
