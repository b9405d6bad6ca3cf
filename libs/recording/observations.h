#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <string>
#include <vector>

#include "recording/samples.h"

/// Samples to and from MRPT's observations: the one place that knows which field holds what. Used by the
/// rawlog reader and writer only.
namespace fathom {

/// Thrown where an entry breaks the recording convention; the reader adds file and byte.
struct ConventionBreach {
  std::string why;
};

/// Throws ConventionBreach.
Reading decodeReading(const mrpt::obs::CObservation& observation);

/// Appends the sample's serialized observation. Throws std::logic_error, see RawlogWriter::write.
void encodeSample(const Sample& sample, std::vector<std::uint8_t>& bytes);
/// The same for the first comment.
void encodeHeader(const RecordingHeader& header, Time time, std::vector<std::uint8_t>& bytes);

}  // namespace fathom
