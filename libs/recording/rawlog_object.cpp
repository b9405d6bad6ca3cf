#include "recording/rawlog_object.h"

#include <mrpt/io/CMemoryStream.h>
#include <mrpt/io/CStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#ifdef FATHOM_SANITIZE
#include <sanitizer/lsan_interface.h>
#endif

#include "recording/allocation_limit.h"
#include "recording/mrpt_classes.h"
#include "recording/mrpt_types.h"

namespace fathom {
namespace {

using mrpt::rtti::TRuntimeClassId;

constexpr std::uint8_t kEndFlag = 0x88;
constexpr std::size_t kMaxObjectBytes = std::size_t{64} << 20;  // a raw colour image of 20 megapixels
constexpr std::size_t kMaxAllocatedBytes = kMaxObjectBytes;
constexpr std::size_t kMaxImageBytes = 4 * kMaxObjectBytes;  // JPEG images become larger when they are read
/// Of a class or one of its parts: a version number that is further above those known was never written.
constexpr int kNewerVersions = 4, kHighestVersion = 16;
// MRPT counts 100 ns ticks from 1601. Observations are from 1970 to 2500, or have no time at all: 0.
constexpr std::int64_t kTicksPerYear = 10'000'000LL * 86400 * 365;
constexpr std::int64_t kEarliestTicks = 116'444'736'000'000'000LL;
constexpr std::int64_t kLatestTicks = kEarliestTicks + 530 * kTicksPerYear;

struct Damage {
  std::string reason;
};

/// The bytes of one object, as MRPT reads them. After an exception damage() says whether it was the bytes
/// that ended, for MRPT makes another of whatever is thrown.
class ObjectStream : public mrpt::io::CStream {
 public:
  ObjectStream(ByteStream& in, std::size_t offset) : in_(in), begin_(offset), at_(offset) {}

  std::size_t walked() const { return at_ - begin_; }
  const std::string& damage() const { return damage_; }

  std::size_t Read(void* to, std::size_t count) override {
    if (count > kMaxObjectBytes - walked()) fail("an entry is impossibly long");
    const auto ahead = in_.peek(at_, count);
    if (ahead.size() < count) fail(kDataEnd.data());
    if (count > 0) std::memcpy(to, ahead.data(), count);
    at_ += count;
    return count;
  }
  std::uint64_t getPosition() const override { return at_; }
  std::size_t Write(const void*, std::size_t) override { throw std::logic_error("read only"); }
  std::uint64_t Seek(std::int64_t, TSeekOrigin) override { throw std::logic_error("read only"); }
  std::uint64_t getTotalBytesCount() const override { throw std::logic_error("not known"); }

 private:
  void fail(const char* reason) {
    damage_ = reason;
    throw std::runtime_error(reason);
  }

  ByteStream& in_;
  std::size_t begin_, at_;
  std::string damage_;
};

struct Header {
  std::string class_name;
  int version = 0;
};

/// Nothing where no object begins there.
std::optional<Header> readHeader(ByteStream& in, std::size_t offset) {
  const auto first = in.peek(offset, 1);
  if (first.empty() || !(first[0] & 0x80U)) return {};
  const std::size_t size = first[0] & 0x7fU;
  const auto ahead = in.peek(offset, size + 2);
  if (size == 0 || ahead.size() < size + 2) return {};
  const auto name = ahead.subspan(1, size);
  const auto is_name = [](std::uint8_t c) { return std::isalnum(c) || c == ':' || c == '_'; };
  if (!std::all_of(name.begin(), name.end(), is_name)) return {};
  return Header{{name.begin(), name.end()}, ahead[size + 1]};
}

/// What the names of all of MRPT's observations begin with, behind their namespace, which MRPT before 2.0
/// left out.
constexpr std::string_view kObservationMark = "CObservation", kNamespace = "mrpt::obs::";

bool namesObservation(std::string_view name) {
  if (name.starts_with(kNamespace)) name.remove_prefix(kNamespace.size());
  return name.starts_with(kObservationMark);
}

bool isOfRawlogs(const TRuntimeClassId& id) {
  return id.derivedFrom(CLASS_ID(mrpt::obs::CObservation)) ||
         id.derivedFrom(CLASS_ID(mrpt::obs::CSensoryFrame)) ||
         id.derivedFrom(CLASS_ID(mrpt::obs::CActionCollection));
}

bool beginsEntry(ByteStream& in, std::size_t offset) {
  const auto ahead = in.peek(offset, 2);  // looked at first: every byte could end an entry
  if (ahead.size() < 2 || !(ahead[0] & 0x80U) || !std::isalpha(ahead[1])) return false;
  const auto header = readHeader(in, offset);
  if (!header) return false;
  if (namesObservation(header->class_name)) return true;
  const TRuntimeClassId* id = mrpt::rtti::findRegisteredClass(header->class_name, true);
  return id != nullptr && isOfRawlogs(*id);
}

/// The length of an observation whose fields are not known: its end flag is followed by the file's end or by
/// another entry. MRPT's observations hold no observations, so nothing within looks like that.
std::size_t measureToNextEntry(ByteStream& in, std::size_t offset) {
  for (std::size_t size = 1; size <= kMaxObjectBytes; ++size) {
    const auto ahead = in.peek(offset + size - 1, 2);
    if (ahead.empty()) break;
    const bool at_end = ahead.size() == 1 && in.damage().empty();
    if (ahead[0] == kEndFlag && (at_end || beginsEntry(in, offset + size))) return size;
  }
  throw Damage{"the end of an entry cannot be found"};
}

/// Whether the end of what cannot be read is searched, which may be the whole rest of the file.
enum class EndSearch { kNone, kToNextEntry };

struct Place {
  ByteStream& in;
  std::size_t offset;
  EndSearch search;
};

RawlogObject skipped(const Place& place, const Header& header, std::string reason) {
  RawlogObject object{RawlogObject::Kind::kSkipped, header.class_name, 0, {}, std::move(reason)};
  if (place.search == EndSearch::kToNextEntry) object.bytes = measureToNextEntry(place.in, place.offset);
  return object;
}

/// The version that the installed MRPT writes of a class.
int writtenVersion(const TRuntimeClassId& id) {
  mrpt::io::CMemoryStream stream;
  mrpt::serialization::archiveFrom(stream)
      << dynamic_cast<const mrpt::serialization::CSerializable&>(*id.createObject());
  return static_cast<const std::uint8_t*>(stream.getRawBufferData())[1 + std::strlen(id.className)];
}

/// The number in MRPT's message about a version that it does not know; nothing where it says something else.
std::optional<int> unknownVersion(std::string_view message) {
  constexpr std::string_view kSaid = "unknown serialization version number: '";
  const std::size_t found = message.find(kSaid);
  if (found == std::string_view::npos) return {};
  message.remove_prefix(found + kSaid.size());
  int version = 0;
  const auto [end, error] = std::from_chars(message.data(), message.data() + message.size(), version);
  if (error != std::errc()) return {};
  return version & 0xff;  // it counts them signed
}

/// What an object is that MRPT has refused with this message: of a later version, which is no damage, or
/// else.
RawlogObject refused(const Place& place, const Header& header, const TRuntimeClassId& id,
                     const char* message) {
  const auto unknown = unknownVersion(message);
  if (!unknown) throw Damage{"MRPT cannot decode a " + std::string(id.className)};
  const std::string number = std::to_string(*unknown);
  if (*unknown == header.version) {
    const int written = writtenVersion(id);
    const std::string why =
        "version " + number + ", where the installed MRPT writes " + std::to_string(written);
    if (header.version < written || header.version > written + kNewerVersions)
      throw Damage{std::string(id.className) + " of " + why};
    return skipped(place, header, why);
  }
  if (*unknown > kHighestVersion) throw Damage{"a part of an entry is of version " + number};
  return skipped(place, header, "a part of it is of version " + number);
}

/// MRPT takes any byte for a flag, of which C++ must not be asked whether it is true.
template <class Flags>
void requireFlags(const Flags& flags) {
  std::array<std::uint8_t, sizeof(Flags)> bytes;
  std::memcpy(bytes.data(), &flags, sizeof(Flags));
  if (std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte > 1; }))
    throw Damage{"a flag is neither 0 nor 1"};
}

/// What MRPT does not look at.
void requirePossible(const mrpt::obs::CObservation& observation) {
  using namespace mrpt::obs;
  const auto ticks = fromMrpt(observation.timestamp).time_since_epoch().count();
  if (ticks != 0 && (ticks < kEarliestTicks || ticks > kLatestTicks))
    throw Damage{"a time stamp is impossible"};
  if (const auto* imu = dynamic_cast<const CObservationIMU*>(&observation)) requireFlags(imu->dataIsPresent);
  if (const auto* bearings = dynamic_cast<const CObservationBearingRange*>(&observation))
    requireFlags(bearings->validCovariances);
  if (const auto* stereo = dynamic_cast<const CObservationStereoImages*>(&observation)) {
    requireFlags(stereo->hasImageRight);
    requireFlags(stereo->hasImageDisparity);
  }
}

/// Whether MRPT says so of an object within the one that it read.
bool holdsUnknownClass(std::string_view message) {
  return message.find("not registered") != std::string_view::npos;
}

RawlogObject read(const Place& place) {
  ByteStream& in = place.in;
  const auto header = readHeader(in, place.offset);
  if (!header) throw Damage{"no object begins where one should"};
  const TRuntimeClassId* id = findMrptClass(header->class_name);
  if (id == nullptr) {
    if (!namesObservation(header->class_name))
      throw Damage{"class `" + header->class_name + "` is none of MRPT's"};
    return skipped(place, *header, "a class that the installed MRPT does not have");
  }
  const bool is_foreign = !isOfRawlogs(*id);
  if (is_foreign && in.position() + place.offset == 0)  // what a file begins with says what it is
    return {RawlogObject::Kind::kForeign, id->className, 0, {}, {}};

  RawlogObject object{RawlogObject::Kind::kRead, id->className, 0, {}, {}};
  object.object =
      std::dynamic_pointer_cast<mrpt::serialization::CSerializable>(std::shared_ptr(id->createObject()));
  ObjectStream stream(in, place.offset);
  auto archive = mrpt::serialization::archiveFrom<mrpt::io::CStream>(stream);
  try {
    const AllocationLimit limit(kMaxAllocatedBytes, kMaxImageBytes);
#ifdef FATHOM_SANITIZE
    // What MRPT has made of a GNSS receiver's message that it then finds damaged it never frees.
    const __lsan::ScopedDisabler leaking;
#endif
    archive.ReadObject(object.object.get());
  } catch (const std::bad_alloc&) {
    throw Damage{"a length is impossible"};
  } catch (const std::exception& error) {
    if (!stream.damage().empty()) throw Damage{stream.damage()};
    if (holdsUnknownClass(error.what()) && loadFurtherMrptClasses()) return read(place);
    return refused(place, *header, *id, error.what());
  }
  forEachObservation(*object.object, &requirePossible);
  object.bytes = stream.walked();
  if (is_foreign) object.kind = RawlogObject::Kind::kSkipped, object.reason = "no observation";
  return object;
}

/// The latest time of an object's observations.
Time lastTime(const RawlogObject& object) {
  Time last{};
  forEachObservation(*object.object, [&](const mrpt::obs::CObservation& observation) {
    last = std::max(last, fromMrpt(observation.timestamp));
  });
  return last;
}

RawlogObject readAt(const Place& place) {
  try {
    return read(place);
  } catch (const Damage& damage) {
    RawlogObject object;
    object.reason = damage.reason;
    return object;
  }
}

}  // namespace

void forEachObservation(const mrpt::serialization::CSerializable& object,
                        const std::function<void(const mrpt::obs::CObservation&)>& visit) {
  if (const auto* observation = dynamic_cast<const mrpt::obs::CObservation*>(&object)) visit(*observation);
  if (const auto* frame = dynamic_cast<const mrpt::obs::CSensoryFrame*>(&object))
    for (const auto& observation : *frame)
      if (observation) visit(*observation);
}

RawlogObject readObject(ByteStream& in, std::size_t offset) {
  return readAt({in, offset, EndSearch::kToNextEntry});
}

Time findLastTime(ByteStream& in) {
  constexpr std::size_t kWindow = 4096;
  constexpr int kMostRefused = 100;  // MRPT takes its time to say so, and may have made room for much
  Time last{};
  int refused = 0;
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
    const auto header = readHeader(in, 0);
    const bool is_known = header && mrpt::rtti::findRegisteredClass(header->class_name, true) != nullptr;
    const RawlogObject object = is_known ? readAt({in, 0, EndSearch::kNone}) : RawlogObject{};
    const bool is_read = object.kind == RawlogObject::Kind::kRead;
    if (is_known && !is_read && ++refused > kMostRefused) return Time{};
    if (is_read) last = std::max(last, lastTime(object));
    in.skip(is_read ? object.bytes : (is_named ? kNamespace.size() : 0) + 2);
  }
}

}  // namespace fathom
