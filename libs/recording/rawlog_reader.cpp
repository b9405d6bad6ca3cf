#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/error.h"
#include "recording/byte_stream.h"
#include "recording/object_layout.h"
#include "recording/observations.h"
#include "recording/rawlog.h"

namespace fathom {
namespace fs = std::filesystem;

struct RawlogReader::Impl {
  explicit Impl(fs::path file_in) : file(std::move(file_in)), in(file) {}

  fs::path file;
  ByteStream in;
  RecordingHeader header;
  std::optional<Sample> first;  ///< read ahead by the constructor, not yet handed on
  std::optional<RecordingLoss> loss;
  bool ended = false;
  bool any_read = false;
  Time first_time{}, last_time{};

  std::optional<Sample> readEntry();
  Reading decode(const ObjectExtent& extent);
  void end(const std::string& reason);
  void noteLoss(const std::string& reason);
  Error error(const std::string& why) const;
};

/// Errors name the byte in the rawlog's own bytes, which are the file's only where it is plain.
Error RawlogReader::Impl::error(const std::string& why) const {
  const std::string where = "byte " + std::to_string(in.position());
  return {file.string(), in.compressed() ? where + " of the inflated data" : where, why};
}

Reading RawlogReader::Impl::decode(const ObjectExtent& extent) {
  if (extent.kind == ObjectExtent::Kind::kForeign)
    throw error("holds a " + extent.mrpt_class + ": not in the observations-only format");
  if (extent.kind == ObjectExtent::Kind::kSkipped) return UnknownSample{extent.mrpt_class};
  const auto kind = baseOf(extent.label);
  const bool of_convention = kind == labels::kCamera || kind == labels::kStereo || kind == labels::kSimulated;
  if (extent.has_pixels && of_convention)
    throw error("an image is stored in the rawlog, must be in a file of its own (rawlog-edit --externalize)");
  if (extent.has_pixels) return UnknownSample{extent.mrpt_class};
  const auto object = in.peek(0, extent.bytes).first(extent.bytes);
  Reading reading = decodeReading(extent.mrpt_class, extent.label, object);
  // Only the first comment is the header; others are remarks.
  if (any_read && std::holds_alternative<RecordingHeader>(reading)) return UnknownSample{extent.mrpt_class};
  return reading;
}

std::optional<Sample> RawlogReader::Impl::readEntry() {
  if (ended) return {};
  if (in.peek(0, 1).empty()) {
    end(in.damage());
    return {};
  }
  const ObjectExtent extent = measureObject(in);
  if (extent.kind == ObjectExtent::Kind::kDamaged) {
    end(extent.reason + (in.damage().empty() ? "" : ": " + in.damage()));
    return {};
  }
  const bool skipped = extent.kind == ObjectExtent::Kind::kSkipped;
  Sample sample{skipped ? last_time : extent.time, extent.label, {}};
  try {
    sample.reading = decode(extent);
  } catch (const ConventionBreach& breach) {
    throw error(breach.why);
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    end("MRPT cannot decode a " + extent.mrpt_class);
    return {};
  }
  in.skip(extent.bytes);
  any_read = true;
  if (first_time == Time{}) first_time = sample.time;
  last_time = sample.time;
  return sample;
}

/// Reading is over: at a clean end, where there is no reason, or for a reason.
void RawlogReader::Impl::end(const std::string& reason) {
  ended = true;
  if (!reason.empty()) noteLoss(reason);
}

void RawlogReader::Impl::noteLoss(const std::string& reason) {
  loss.emplace();
  loss->reason = reason;
  // Where only a checksum at the very end is wrong, that is what is lost.
  loss->at_byte = std::min(in.filePosition(), in.fileBytes() - 1);
  loss->lost_bytes = in.fileBytes() - loss->at_byte;

  const Time last_behind = any_read ? findLastTime(in) : Time{};
  if (last_behind > last_time && in.damage().empty()) {
    loss->lost_seconds = secondsBetween(last_time, last_behind);
    return;
  }
  loss->estimated = true;
  const double seconds_read = secondsBetween(first_time, last_time);
  loss->lost_seconds =
      seconds_read > 0.0 && loss->at_byte > 0
          ? static_cast<double>(loss->lost_bytes) * seconds_read / static_cast<double>(loss->at_byte)
          : std::numeric_limits<double>::quiet_NaN();
}

RawlogReader::RawlogReader(fs::path file) : impl_(std::make_unique<Impl>(std::move(file))) {
  impl_->first = impl_->readEntry();
  if (!impl_->first) {
    const std::string reason = impl_->loss ? impl_->loss->reason : "no data";
    throw Error(impl_->file.string(), "", "is no rawlog, or damaged from the start: " + reason);
  }
  if (const auto* header = std::get_if<RecordingHeader>(&impl_->first->reading)) impl_->header = *header;
}

RawlogReader::~RawlogReader() = default;

const fs::path& RawlogReader::file() const { return impl_->file; }
const RecordingHeader& RawlogReader::header() const { return impl_->header; }
const std::optional<RecordingLoss>& RawlogReader::loss() const { return impl_->loss; }

std::optional<Sample> RawlogReader::next() {
  if (!impl_->first) return impl_->readEntry();
  std::optional<Sample> sample;
  sample.swap(impl_->first);
  return sample;
}

double RawlogReader::fraction() const {
  if (impl_->ended) return 1.0;
  return static_cast<double>(impl_->in.filePosition()) / static_cast<double>(impl_->in.fileBytes());
}

fs::path RawlogReader::imageFolder() const {
  return impl_->file.parent_path() / (impl_->file.stem().string() + "_Images");
}

std::string describe(const RecordingLoss& loss) {
  char seconds[64];
  std::snprintf(seconds, sizeof seconds, "%s%.1f s", loss.estimated ? "about " : "", loss.lost_seconds);
  return "reading stopped at byte " + std::to_string(loss.at_byte) + " (" + loss.reason +
         "): " + std::to_string(loss.lost_bytes) + " bytes" +
         (std::isnan(loss.lost_seconds) ? "" : std::string(", ") + seconds) + " are lost";
}

}  // namespace fathom
