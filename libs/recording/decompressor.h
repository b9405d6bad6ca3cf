#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace fathom {

/// zlib: the largest window, gzip header (without a time) and checksum.
inline constexpr int kGzipWindow = 15 + 16;

/// Inflates compressed data piece by piece: a chain of members (gzip) or frames (Zstandard), each with an end
/// of its own and mostly a checksum.
class Decompressor {
 public:
  enum class Status { kMore, kMemberEnd, kDamaged };

  virtual ~Decompressor() = default;
  /// Moves `in` past what it took and `out` past what it wrote. kMore where `out` is not full: it wants more
  /// of `in`.
  virtual Status inflate(std::span<const std::uint8_t>& in, std::span<std::uint8_t>& out) = 0;
  /// After kMemberEnd: what follows is another member.
  virtual void beginMember() = 0;
  virtual const char* format() const = 0;  ///< its name
  virtual std::string damage() const = 0;  ///< after kDamaged: a few words
  /// After kDamaged: all was inflated, but its checksum is another.
  virtual bool isWhole() const = 0;
};

/// By the first bytes of a file; null where they are no compressed data.
std::unique_ptr<Decompressor> decompressorFor(std::span<const std::uint8_t> begin);

}  // namespace fathom
