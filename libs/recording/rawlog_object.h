#pragma once

#include <mrpt/obs/CObservation.h>
#include <mrpt/serialization/CSerializable.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/time.h"
#include "recording/byte_stream.h"

/// The objects of a rawlog, taken apart by MRPT's own serialization. Used by the rawlog reader only.
///
/// MRPT's format, in little-endian bytes, is a tree of objects, each
///     0x80 | length of the class name, class name, version, fields ..., 0x88
/// without a length of its own. MRPT believes every length that it reads and makes room for it first, so that
/// one damaged byte could cost gigabytes: what it may allocate for one object is limited, and the data end
/// for it where an object of any use must have ended.
namespace fathom {

/// The reason where the data are too few for an entry: they are cut off, or a length in it is damaged.
inline constexpr std::string_view kDataEnd = "the data end inside an entry";

struct RawlogObject {
  enum class Kind {
    kRead,     ///< an observation, or observations or actions in a row, as in the actions-and-frames format
    kSkipped,  ///< an observation of a class or version that the installed MRPT does not know, taken to end
               ///< where the next object begins; or an MRPT object between them that is none of a rawlog's
    kForeign,  ///< such a one at the beginning: the file is no rawlog
    kDamaged,
  };
  Kind kind = Kind::kDamaged;
  std::string mrpt_class;
  std::size_t bytes = 0;                                       ///< whole length, kRead and kSkipped
  std::shared_ptr<mrpt::serialization::CSerializable> object;  ///< kRead
  std::string reason;                                          ///< kSkipped and kDamaged: one line
};

/// Those of a frame, or the object itself.
void forEachObservation(const mrpt::serialization::CSerializable& object,
                        const std::function<void(const mrpt::obs::CObservation&)>& visit);

/// The object that begins `offset` bytes after the stream's position; the position stays.
RawlogObject readObject(ByteStream& in, std::size_t offset = 0);

/// The time of the last whole observation anywhere behind the stream's position, which moves to the end.
/// Time{} where there is none.
Time findLastTime(ByteStream& in);

}  // namespace fathom
