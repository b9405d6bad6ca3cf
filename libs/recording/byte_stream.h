#pragma once

#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recording/decompressor.h"

namespace fathom {

/// The bytes of a plain, gzip or Zstandard file, inflated, with a look ahead. Used by the rawlog reader only.
///
/// Damage ends the bytes, it is not an Error: damage() then says what was found. A member (the file may
/// be a chain of them) that fits into one block is handed on only once its checksum is right, except the
/// first, whose bytes before the damage are all that can be had. In a longer member, wrong bytes may be
/// handed on before its damage is noticed.
class ByteStream {
 public:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

  /// Throws Error where the file is missing, no regular file, cannot be read or is empty.
  explicit ByteStream(std::filesystem::path file);
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// The bytes from position() + `offset` on: at least `size` of them, unless the data end sooner. Valid
  /// until the next call.
  std::span<const std::uint8_t> peek(std::size_t offset, std::size_t size) {
    while (buffer_.size() - begin_ < offset + size && !ended_) fill();
    const std::size_t ahead = buffer_.size() - begin_;
    return std::span(buffer_).subspan(begin_ + (offset < ahead ? offset : ahead));
  }
  /// Moves on by at most what the last peek() saw.
  void skip(std::size_t size);

  std::uint64_t position() const { return position_; }  ///< in the inflated bytes
  /// The same in the file: exact for a plain file, else interpolated within the block that was inflated last.
  std::uint64_t filePosition() const;
  std::uint64_t fileBytes() const { return file_bytes_; }
  bool compressed() const { return decompressor_ != nullptr; }
  /// Why the bytes ended before the data did, one line; empty while there are more and at a clean end.
  const std::string& damage() const { return damage_; }
  /// Whether that is because compressed data are cut off: how much is missing is not known.
  bool cutShort() const { return cut_short_; }

 private:
  /// Which bytes of the file became which inflated ones.
  struct Block {
    std::uint64_t begin, end, file_begin, file_end;
  };

  void fill();
  void fillPlain();
  void fillInflated();
  bool refillInput();
  void endAtMember();
  std::uint64_t fileConsumed() const { return file_read_ - unread_.size(); }

  std::filesystem::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> in_;
  std::uint64_t file_bytes_ = 0, file_read_ = 0, position_ = 0;
  bool ended_ = false, at_member_start_ = true, in_first_member_ = true, cut_short_ = false;
  std::string damage_;
  std::vector<std::uint8_t> buffer_, input_;
  std::span<const std::uint8_t> unread_;  ///< of input_
  std::size_t begin_ = 0;
  std::deque<Block> blocks_;
  std::unique_ptr<Decompressor> decompressor_;  ///< null: the file is plain
};

}  // namespace fathom
