#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"
#include "recording/byte_stream.h"

/// How long a serialized MRPT object is, found without MRPT. Used by the rawlog reader only.
///
/// MRPT believes every length it reads and makes room for it first, so that one damaged byte can cost
/// gigabytes. Its format, in little-endian bytes, is a tree of objects, each
///     0x80 | length of the class name, class name, version, fields ..., 0x88
/// without a length of its own. So the fields of each class must be known: a table of those that the
/// recording convention names, in the versions of MRPT 2.5.8, says what follows what. A test serializes them
/// with the installed MRPT and compares.
namespace fathom {

struct ObjectExtent {
  enum class Kind {
    kKnown,    ///< laid out as the table says; may be handed to MRPT
    kSkipped,  ///< an observation the table does not have: taken to end where the next observation begins
    kForeign,  ///< an MRPT object that is no observation, as in rawlogs of the actions-and-frames format
    kDamaged,
  };
  Kind kind = Kind::kDamaged;
  std::string mrpt_class;
  std::size_t bytes = 0;    ///< whole length, kKnown and kSkipped
  Time time;                ///< kKnown
  std::string label;        ///< kKnown: sensorLabel
  bool has_pixels = false;  ///< kKnown: an image lies in the object itself, not in a file
  std::string reason;       ///< kDamaged: one line
};

/// The object that begins `offset` bytes after the stream's position; the position stays.
ObjectExtent measureObject(ByteStream& in, std::size_t offset = 0);

/// The time of the last whole object of the convention anywhere behind the stream's position, which moves to
/// the end. Time{} where there is none.
Time findLastTime(ByteStream& in);

}  // namespace fathom
