#include "recording/object_layout.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/gnss_messages.h>
#include <mrpt/rtti/CObject.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace fathom {
namespace {

constexpr std::uint8_t kEndFlag = 0x88;
constexpr std::size_t kMaxObjectBytes = std::size_t{64} << 20;  // a raw colour image of 20 megapixels
constexpr std::size_t kMaxNameBytes = 256;
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;
constexpr std::uint32_t kMaxElements = 100000;
// MRPT counts 100 ns ticks from 1601. Observations are from 1970 to 2500, or have no time at all: 0.
constexpr std::uint64_t kTicksPerYear = 10'000'000ULL * 86400 * 365;
constexpr std::uint64_t kEarliestTicks = 116'444'736'000'000'000ULL;
constexpr std::uint64_t kLatestTicks = kEarliestTicks + 530 * kTicksPerYear;

struct Damage {
  std::string reason;
};

struct Header {
  std::string class_name;
  std::uint8_t version = 0;
};

/// With its namespace: MRPT before 2.0 wrote names without.
std::string canonicalName(const std::string& name) {
  if (name.find("::") != std::string::npos) return name;
  const auto* id = mrpt::rtti::findRegisteredClass(name, true);
  return id != nullptr ? id->className : name;
}

/// Walks over an object's bytes. Every step throws Damage where the bytes are not what they must be.
class Walker {
 public:
  Walker(ByteStream& in, std::size_t offset) : in_(in), begin_(offset), at_(offset) {}

  std::size_t walked() const { return at_ - begin_; }

  const std::uint8_t* take(std::size_t size) {
    if (walked() + size > kMaxObjectBytes) throw Damage{"an entry is impossibly long"};
    const auto ahead = in_.peek(at_, size);
    if (ahead.size() < size) throw Damage{"the data end inside an entry"};
    at_ += size;
    return ahead.data();
  }
  template <class T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
    return value;
  }
  void doubles(std::size_t count) { take(count * sizeof(double)); }
  void floats(std::size_t count) { take(count * sizeof(float)); }

  bool flag() {
    const auto value = number<std::uint8_t>();
    if (value > 1) throw Damage{"a flag is neither 0 nor 1"};
    return value == 1;
  }
  std::uint32_t count(std::uint32_t limit) {
    const auto value = number<std::uint32_t>();
    if (value > limit) throw Damage{"a length of " + std::to_string(value) + " is impossible"};
    return value;
  }
  std::string text(std::size_t limit) {
    const std::size_t size = count(static_cast<std::uint32_t>(limit));
    const auto* bytes = take(size);
    return {bytes, bytes + size};
  }

  Header header() {
    const auto length = number<std::uint8_t>();
    if (!(length & 0x80U)) throw Damage{"no object begins where one should"};
    const std::size_t size = length & 0x7fU;
    const auto* name = take(size);
    const auto is_name = [](std::uint8_t c) { return std::isalnum(c) || c == ':' || c == '_'; };
    if (size == 0 || !std::all_of(name, name + size, is_name))
      throw Damage{"no object begins where one should"};
    Header header{canonicalName({name, name + size}), 0};
    header.version = number<std::uint8_t>();
    return header;
  }
  void end() {
    if (number<std::uint8_t>() != kEndFlag) throw Damage{"an entry does not end where it should"};
  }
  /// A nested object, which must be of this class.
  void object(std::string_view class_name);

  void time() {
    const auto ticks = number<std::uint64_t>();
    if (ticks != 0 && (ticks < kEarliestTicks || ticks > kLatestTicks))
      throw Damage{"a time stamp is impossible"};
    found.time = Time(Time::duration(static_cast<Time::rep>(ticks)));
  }
  void label() { found.label = text(kMaxNameBytes); }

  ObjectExtent found;

 private:
  ByteStream& in_;
  std::size_t begin_, at_;
};

void walkImage(Walker& w) {
  if (w.flag()) {  // external
    w.text(4096);
    return;
  }
  w.found.has_pixels = true;
  const bool has_color = w.flag();
  const auto width = w.number<std::int32_t>(), height = w.number<std::int32_t>();
  if (!has_color) {
    w.number<std::int32_t>();  // origin
    const std::size_t bytes = w.number<std::uint32_t>();
    w.number<std::int32_t>();  // depth
    const bool zipped = w.flag();
    w.take(zipped ? w.number<std::uint32_t>() : bytes);
  } else if (width > 0 && height > 0) {
    w.take(w.number<std::uint32_t>());  // JPEG
  } else if (width < 0 && height < 0) {
    w.take(3 * static_cast<std::size_t>(-std::int64_t{width}) *
           static_cast<std::size_t>(-std::int64_t{height}));
  }
}

void walkMatrix(Walker& w) {
  const std::size_t rows = w.count(kMaxElements), columns = w.count(kMaxElements);
  w.doubles(rows * columns);
}

/// Of a message of a GNSS receiver. MRPT tries again later, but what it has made of one that it then finds
/// damaged it never frees.
void requireReadable(std::int32_t kind, std::span<const std::uint8_t> fields) {
  using mrpt::obs::gnss::gnss_message;
  // What is beyond the largest kind MRPT makes nothing of, and no value of its enumeration.
  if (kind < 0 || kind > mrpt::obs::gnss::NV_OEM6_GENERIC_SHORT_FRAME) return;
  const auto type = static_cast<mrpt::obs::gnss::gnss_message_type_t>(kind);
  const std::unique_ptr<gnss_message> message(gnss_message::Factory(type));
  std::vector<std::uint8_t> bytes(2 * sizeof(std::uint32_t));
  const auto size = static_cast<std::uint32_t>(fields.size());
  std::memcpy(bytes.data(), &kind, sizeof(kind));
  std::memcpy(bytes.data() + sizeof(kind), &size, sizeof(size));
  bytes.insert(bytes.end(), fields.begin(), fields.end());
  mrpt::io::CMemoryStream stream(bytes.data(), bytes.size());
  auto archive = mrpt::serialization::archiveFrom(stream);
  try {
    if (message) message->readFromStream(archive);
  } catch (const std::exception&) {
    throw Damage{"a message of a GNSS receiver is not what its kind says"};
  }
}

struct Layout {
  std::string_view class_name;
  std::uint8_t version;
  void (*walk)(Walker&);
  bool others_skipped = false;  ///< of other versions its fields are not known, which is no damage
};

constexpr std::string_view kPose = "mrpt::poses::CPose3D";
constexpr std::string_view kPoseQuat = "mrpt::poses::CPose3DQuat";
constexpr std::string_view kPosePdf = "mrpt::poses::CPose3DPDFGaussian";
constexpr std::string_view kCamera = "mrpt::img::TCamera";
constexpr std::string_view kImage = "mrpt::img::CImage";
constexpr std::string_view kMatrix = "mrpt::math::CMatrixD";

const Layout kParts[] = {
    {kPose, 3, [](Walker& w) { w.doubles(3 + 9); }},
    {kPoseQuat, 0, [](Walker& w) { w.doubles(3 + 4); }},
    {kPosePdf, 1,
     [](Walker& w) {
       w.object(kPose);
       w.doubles(6 + 15);  // diagonal, then the rest of the upper triangle
     }},
    {kCamera, 6,
     [](Walker& w) {
       w.doubles(1 + 8 + 4);  // focal length, distortion, fx fy cx cy
       w.take(2 * sizeof(std::uint32_t));
       w.text(kMaxNameBytes);
       w.take(1);  // distortion model
     }},
    {kImage, 9, walkImage},
    {kMatrix, 0, walkMatrix},
};

/// As before MRPT 1.9.9: lists of fields bear their lengths.
void walkCountedImu(Walker& w) {
  constexpr std::uint32_t kMostFields = 64;
  w.object(kPose);
  for (auto flags = w.count(kMostFields); flags > 0; --flags) w.flag();
  w.time();
  w.doubles(w.count(kMostFields));
  w.label();
}

const Layout kObservations[] = {
    {"mrpt::obs::CObservationComment", 0,
     [](Walker& w) {
       w.text(kMaxTextBytes);
       w.time();
     }},
    {"mrpt::obs::CObservationIMU", 4,
     [](Walker& w) {
       constexpr std::size_t kFields = 31;
       w.object(kPose);
       for (std::size_t i = 0; i < kFields; ++i) w.flag();
       w.time();
       w.doubles(kFields);
       w.label();
     }},
    {"mrpt::obs::CObservationIMU", 3, walkCountedImu},
    {"mrpt::obs::CObservationIMU", 2, walkCountedImu},
    {"mrpt::obs::CObservationRange", 3,
     [](Walker& w) {
       w.floats(3);
       for (auto beams = w.count(kMaxElements); beams > 0; --beams) {
         w.number<std::uint16_t>();
         w.object(kPose);
         w.floats(1);
       }
       w.label();
       w.time();
     }},
    {"mrpt::obs::CObservationGPS", 11,
     [](Walker& w) {
       w.time();
       w.take(sizeof(std::uint64_t));  // when it was received
       w.label();
       w.object(kPose);
       w.flag();  // whether the time is the satellites'
       for (auto messages = w.count(kMaxElements); messages > 0; --messages) {
         const auto kind = w.number<std::int32_t>();
         const auto size = w.number<std::uint32_t>();
         requireReadable(kind, {w.take(size), size});
       }
     },
     true},
    {"mrpt::obs::CObservationRobotPose", 1,
     [](Walker& w) {
       w.object(kPosePdf);
       w.label();
       w.time();
       w.object(kPose);
     }},
    {"mrpt::obs::CObservationImage", 4,
     [](Walker& w) {
       w.object(kPose);
       w.object(kCamera);
       w.object(kImage);
       w.time();
       w.label();
     }},
    {"mrpt::obs::CObservationStereoImages", 6,
     [](Walker& w) {
       w.object(kPoseQuat);
       w.object(kCamera);
       w.object(kCamera);
       w.object(kImage);
       const bool has_disparity = w.flag(), has_right = w.flag();
       for (int images = int{has_disparity} + int{has_right}; images > 0; --images) w.object(kImage);
       w.time();
       w.object(kPoseQuat);
       w.label();
     }},
    {"mrpt::obs::CObservationBearingRange", 3,
     [](Walker& w) {
       w.floats(4);
       w.object(kPose);
       w.time();
       const bool has_covariances = w.flag();
       if (!has_covariances) w.floats(3);
       for (auto marks = w.count(kMaxElements); marks > 0; --marks) {
         w.floats(3);
         w.number<std::int32_t>();
         if (has_covariances) w.object(kMatrix);
       }
       w.label();
     }},
    {"mrpt::obs::CObservation6DFeatures", 0,
     [](Walker& w) {
       w.floats(2);
       w.object(kPose);
       for (auto features = w.count(kMaxElements); features > 0; --features) {
         w.object(kPose);
         w.number<std::int32_t>();
         w.object(kMatrix);
       }
       w.label();
       w.time();
     }},
};

/// Of this version, or else the newest; null where the table has none of the class.
template <std::size_t size>
const Layout* findLayout(const Layout (&table)[size], const Header& header) {
  const Layout* newest = nullptr;
  for (const Layout& layout : table) {
    if (layout.class_name != header.class_name) continue;
    if (layout.version == header.version) return &layout;
    if (newest == nullptr) newest = &layout;
  }
  return newest;
}

void requireVersion(const Layout& layout, std::uint8_t version) {
  if (version == layout.version) return;
  throw Damage{std::string(layout.class_name) + " of version " + std::to_string(version) +
               ", where MRPT 2.5 writes version " + std::to_string(layout.version)};
}

void Walker::object(std::string_view class_name) {
  const Header nested = header();
  if (nested.class_name != class_name) throw Damage{"an entry lacks its " + std::string(class_name)};
  const Layout& layout = *findLayout(kParts, nested);
  requireVersion(layout, nested.version);
  layout.walk(*this);
  end();
}

bool isObservation(const std::string& class_name) {
  const auto* id = mrpt::rtti::findRegisteredClass(class_name);
  return id != nullptr && id->derivedFrom(CLASS_ID(mrpt::obs::CObservation));
}

/// What the names of all of MRPT's observations begin with, behind their namespace.
constexpr std::string_view kObservationMark = "CObservation", kNamespace = "mrpt::obs::";

/// Whether the bytes from the second one on are the name of an observation.
bool namesObservation(std::string_view bytes) {
  bytes.remove_prefix(std::min<std::size_t>(1, bytes.size()));
  if (bytes.starts_with(kNamespace)) bytes.remove_prefix(kNamespace.size());
  return bytes.starts_with(kObservationMark);
}

bool beginsObservation(ByteStream& in, std::size_t offset) {
  // Looked at first: an exception at every byte that could end an entry would take minutes.
  const auto ahead = in.peek(offset, 1 + kNamespace.size() + kObservationMark.size());
  if (!namesObservation({reinterpret_cast<const char*>(ahead.data()), ahead.size()})) return false;
  try {
    const Header header = Walker(in, offset).header();
    const Layout* layout = findLayout(kObservations, header);
    return layout && !layout->others_skipped ? header.version == layout->version
                                             : isObservation(header.class_name);
  } catch (const Damage&) {
    return false;
  }
}

/// Whether the table has the observation that begins there.
bool beginsKnown(ByteStream& in, std::size_t offset) {
  try {
    const Header header = Walker(in, offset).header();
    const Layout* layout = findLayout(kObservations, header);
    return layout != nullptr && (!layout->others_skipped || layout->version == header.version);
  } catch (const Damage&) {
    return false;
  }
}

/// The length of an observation whose fields are not known: its end flag is followed by the file's end or by
/// another observation. MRPT's observations hold no observations, so nothing within looks like that.
std::size_t measureToNextObservation(ByteStream& in, std::size_t offset) {
  for (std::size_t size = 1; size <= kMaxObjectBytes; ++size) {
    const auto ahead = in.peek(offset + size - 1, 2);
    if (ahead.empty()) break;
    const bool at_end = ahead.size() == 1 && in.damage().empty();
    if (ahead[0] == kEndFlag && (at_end || beginsObservation(in, offset + size))) return size;
  }
  throw Damage{"the end of an entry cannot be found"};
}

ObjectExtent measure(ByteStream& in, std::size_t offset) {
  Walker walker(in, offset);
  const Header header = walker.header();
  ObjectExtent& extent = walker.found;
  extent.mrpt_class = header.class_name;
  const Layout* layout = findLayout(kObservations, header);
  if (layout != nullptr && layout->others_skipped && layout->version != header.version) {
    // A version that is far off was never written: it is damage, not to be skipped with what stands behind
    // it.
    constexpr int kNewerVersions = 4;
    if (header.version > layout->version + kNewerVersions) requireVersion(*layout, header.version);
    layout = nullptr;
  }
  if (layout != nullptr) {
    requireVersion(*layout, header.version);
    layout->walk(walker);
    walker.end();
    extent.kind = ObjectExtent::Kind::kKnown;
    extent.bytes = walker.walked();
  } else if (isObservation(header.class_name)) {
    extent.kind = ObjectExtent::Kind::kSkipped;
    extent.bytes = measureToNextObservation(in, offset);
  } else if (mrpt::rtti::findRegisteredClass(header.class_name)) {
    extent.kind = ObjectExtent::Kind::kForeign;
  } else {
    throw Damage{"class `" + header.class_name + "` is none of MRPT's"};
  }
  return extent;
}

}  // namespace

ObjectExtent measureObject(ByteStream& in, std::size_t offset) {
  try {
    return measure(in, offset);
  } catch (const Damage& damage) {
    ObjectExtent extent;
    extent.reason = damage.reason;
    return extent;
  }
}

Time findLastTime(ByteStream& in) {
  constexpr std::size_t kWindow = 4096;
  Time last{};
  for (;;) {
    const auto ahead = in.peek(0, kWindow);
    const std::string_view text(reinterpret_cast<const char*>(ahead.data()), ahead.size());
    const std::size_t found = text.find(kObservationMark, 1);
    if (found == std::string_view::npos) {
      if (ahead.size() < kWindow) return last;
      in.skip(ahead.size() - kNamespace.size() - kObservationMark.size());
      continue;
    }
    // Before the mark is the namespace, in MRPT before 2.0 not; before that the length of the class name.
    const bool is_named = found > kNamespace.size() && text.substr(0, found).ends_with(kNamespace);
    in.skip(found - (is_named ? kNamespace.size() : 0) - 1);
    // Of another the end would have to be searched, for each of them up to the file's.
    const std::size_t beyond = (is_named ? kNamespace.size() : 0) + 2;
    if (!beginsKnown(in, 0)) {
      in.skip(beyond);
      continue;
    }
    const ObjectExtent extent = measureObject(in);
    const bool known = extent.kind == ObjectExtent::Kind::kKnown;
    if (known) last = std::max(last, extent.time);
    in.skip(known ? extent.bytes : beyond);
  }
}

}  // namespace fathom
