#include "recording/byte_stream.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/files.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kInputBytes = std::size_t{1} << 16;

}  // namespace

ByteStream::ByteStream(fs::path file) : file_(std::move(file)), in_(nullptr, &std::fclose) {
  const std::string name = file_.string();
  std::error_code problem;
  if (!isThere(file_)) throw Error(name, "", "no such file");
  if (!isFile(file_)) throw Error(name, "", "is not a file");
  in_.reset(std::fopen(name.c_str(), "rb"));
  if (!in_) throw Error(name, "", std::string("cannot be read: ") + std::strerror(errno));
  file_bytes_ = fs::file_size(file_, problem);
  if (problem) throw Error(name, "", "cannot be read: " + problem.message());
  if (file_bytes_ == 0) throw Error(name, "", "is empty");

  if (!refillInput()) throw Error(name, "", "cannot be read");
  decompressor_ = decompressorFor(input_);
}

void ByteStream::skip(std::size_t size) {
  begin_ += size;
  position_ += size;
  while (blocks_.size() > 1 && blocks_.front().end <= position_) blocks_.pop_front();
}

std::uint64_t ByteStream::filePosition() const {
  if (!compressed()) return position_;
  if (blocks_.empty()) return 0;
  // Damage is searched for within what was inflated last, so position_ is in the blocks kept.
  for (const Block& block : blocks_) {
    if (position_ >= block.end) continue;
    const double share =
        static_cast<double>(position_ - block.begin) / static_cast<double>(block.end - block.begin);
    return block.file_begin +
           static_cast<std::uint64_t>(share * static_cast<double>(block.file_end - block.file_begin));
  }
  return blocks_.back().file_end;
}

void ByteStream::fill() {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  if (compressed())
    fillInflated();
  else
    fillPlain();
}

/// Reads the next piece of the file into input_; false at its end.
bool ByteStream::refillInput() {
  input_.resize(kInputBytes);
  input_.resize(std::fread(input_.data(), 1, kInputBytes, in_.get()));
  if (std::ferror(in_.get())) damage_ = "the file cannot be read any further";
  file_read_ += input_.size();
  unread_ = input_;
  return !input_.empty();
}

void ByteStream::fillPlain() {
  // The constructor has read the first piece already.
  buffer_.insert(buffer_.end(), input_.begin(), input_.end());
  ended_ = !refillInput();
}

void ByteStream::fillInflated() {
  const std::size_t old_size = buffer_.size();
  const std::uint64_t file_begin = fileConsumed();
  const bool from_member_start = at_member_start_;
  buffer_.resize(old_size + kBlockBytes);
  std::span<std::uint8_t> room = std::span(buffer_).subspan(old_size);

  auto status = Decompressor::Status::kMore;
  while (status == Decompressor::Status::kMore && !room.empty()) {
    status = decompressor_->inflate(unread_, room);
    const bool wants_more = status == Decompressor::Status::kMore && !room.empty();
    if (wants_more && unread_.empty() && !refillInput()) {
      cut_short_ = damage_.empty();
      if (cut_short_) damage_ = std::string("the ") + decompressor_->format() + " data are cut short";
      ended_ = true;
      break;
    }
  }
  std::size_t produced = kBlockBytes - room.size();
  const bool nothing = from_member_start && produced == 0;
  at_member_start_ = false;
  if (status == Decompressor::Status::kMemberEnd) {
    if (position_ + old_size + produced > 0) in_first_member_ = false;  // frames of notes are none
    endAtMember();
  } else if (status == Decompressor::Status::kDamaged) {
    const std::string format = decompressor_->format();
    damage_ = nothing && !in_first_member_ ? "bytes that are not " + format + " data follow"
              : decompressor_->isWhole()
                  ? "the checksum of the " + format + " data does not fit: values that were read may be wrong"
                  : "the " + format + " data are damaged (" + decompressor_->damage() + ")";
    ended_ = true;
    // The checksum was never right: what came out is not to be trusted.
    if (from_member_start && !in_first_member_) produced = 0;
  }
  buffer_.resize(old_size + produced);
  const std::uint64_t begin = position_ + old_size;
  if (produced > 0) blocks_.push_back({begin, begin + produced, file_begin, fileConsumed()});
}

/// After a member whose checksum was right: the file ends, or another member follows.
void ByteStream::endAtMember() {
  at_member_start_ = true;
  if (unread_.empty() && !refillInput()) {
    ended_ = true;
    return;
  }
  decompressor_->beginMember();
}

}  // namespace fathom
