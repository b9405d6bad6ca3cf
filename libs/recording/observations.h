#pragma once

#include <cstdint>
#include <span>
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

/// The reading in a serialized observation of class `mrpt_class` whose layout was checked.
/// Throws ConventionBreach, and std::exception where MRPT finds fault with the bytes.
Reading decodeReading(const std::string& mrpt_class, const std::string& label,
                      std::span<const std::uint8_t> object);

/// Appends the sample's serialized observation. Throws std::logic_error, see RawlogWriter::write.
void encodeSample(const Sample& sample, std::vector<std::uint8_t>& bytes);
/// The same for the first comment.
void encodeHeader(const RecordingHeader& header, Time time, std::vector<std::uint8_t>& bytes);

}  // namespace fathom
