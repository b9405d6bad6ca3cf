#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <limits>

#include "core/error.h"
#include "recording/byte_stream.h"
#include "recording/mrpt_types.h"
#include "recording/observations.h"
#include "recording/rawlog.h"
#include "recording/rawlog_object.h"

namespace fathom {
namespace fs = std::filesystem;

struct RawlogReader::Impl {
  explicit Impl(fs::path file_in) : file(std::move(file_in)), in(file) {}

  fs::path file;
  ByteStream in;
  RecordingHeader header;
  std::optional<Sample> first;  ///< read ahead by the constructor, not yet handed on
  std::optional<RecordingLoss> loss;
  std::deque<Sample> pending;  ///< of the entries read, not yet handed on
  bool ended = false;
  bool any_read = false;
  Time first_time{}, last_time{};

  std::optional<Sample> readSample();
  void readEntry();
  void decode(const RawlogObject& object);
  Sample sampleOf(const mrpt::obs::CObservation& observation);
  void end(const std::string& reason);
  void noteLoss(const std::string& reason);
  Error error(const std::string& why) const;
};

/// Errors name the byte in the rawlog's own bytes, which are the file's only where it is plain.
Error RawlogReader::Impl::error(const std::string& why) const {
  const std::string where = "byte " + std::to_string(in.position());
  return {file.string(), in.compressed() ? where + " of the inflated data" : where, why};
}

/// The observations of an entry as samples, behind those that wait.
void RawlogReader::Impl::decode(const RawlogObject& object) {
  using mrpt::obs::CActionCollection;
  if (object.kind == RawlogObject::Kind::kSkipped) {
    pending.push_back({last_time, {}, UnknownSample{object.mrpt_class, object.reason}});
  } else if (const auto* actions = dynamic_cast<const CActionCollection*>(object.object.get())) {
    const Time time = actions->size() > 0 ? fromMrpt(actions->get(0).timestamp) : Time{};
    pending.push_back({time, {}, UnknownSample{object.mrpt_class}});
  } else {
    forEachObservation(*object.object, [&](const auto& each) { pending.push_back(sampleOf(each)); });
  }
}

Sample RawlogReader::Impl::sampleOf(const mrpt::obs::CObservation& observation) {
  Sample sample{fromMrpt(observation.timestamp), observation.sensorLabel, {}};
  try {
    sample.reading = decodeReading(observation);
  } catch (const ConventionBreach& breach) {
    throw error(breach.why);
  }
  // Only the first comment is the header; others are remarks.
  if (any_read && std::holds_alternative<RecordingHeader>(sample.reading))
    sample.reading = UnknownSample{observation.GetRuntimeClass()->className};
  any_read = true;
  if (first_time == Time{}) first_time = sample.time;
  if (sample.time != Time{}) last_time = sample.time;
  return sample;
}

std::optional<Sample> RawlogReader::Impl::readSample() {
  while (pending.empty() && !ended) readEntry();
  if (pending.empty()) return {};
  std::optional<Sample> sample = std::move(pending.front());
  pending.pop_front();
  return sample;
}

void RawlogReader::Impl::readEntry() {
  if (in.peek(0, 1).empty()) {
    end(in.damage());
    return;
  }
  const RawlogObject object = readObject(in);
  if (object.kind == RawlogObject::Kind::kDamaged) {
    end(object.reason + (in.damage().empty() ? "" : ": " + in.damage()));
    return;
  }
  if (object.kind == RawlogObject::Kind::kForeign)
    throw error("holds a " + object.mrpt_class + ": is no rawlog");
  decode(object);
  in.skip(object.bytes);
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
  loss->cut_off = in.cutShort() || (reason == kDataEnd && in.damage().empty());
  if (loss->cut_off) {
    loss->lost_seconds = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const double seconds_read = secondsBetween(first_time, last_time);
  loss->lost_seconds =
      seconds_read > 0.0 && loss->at_byte > 0
          ? static_cast<double>(loss->lost_bytes) * seconds_read / static_cast<double>(loss->at_byte)
          : std::numeric_limits<double>::quiet_NaN();
}

RawlogReader::RawlogReader(fs::path file) : impl_(std::make_unique<Impl>(std::move(file))) {
  impl_->first = impl_->readSample();
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
  if (!impl_->first) return impl_->readSample();
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
  const std::string stopped =
      "reading stopped at byte " + std::to_string(loss.at_byte) + " (" + loss.reason + "): ";
  if (loss.cut_off) return stopped + "the file is cut off, how much is lost is not known";
  char seconds[64];
  std::snprintf(seconds, sizeof seconds, "%s%.1f s", loss.estimated ? "about " : "", loss.lost_seconds);
  return stopped + std::to_string(loss.lost_bytes) + " bytes" +
         (std::isnan(loss.lost_seconds) ? "" : std::string(", ") + seconds) + " are lost";
}

}  // namespace fathom
