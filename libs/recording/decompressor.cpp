#include "recording/decompressor.h"

#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <array>
#include <new>
#include <string_view>

namespace fathom {
namespace {

class Gzip : public Decompressor {
 public:
  Gzip() {
    if (inflateInit2(&zlib_, kGzipWindow) != Z_OK) throw std::bad_alloc();
  }
  ~Gzip() override { inflateEnd(&zlib_); }
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;

  Status inflate(std::span<const std::uint8_t>& in, std::span<std::uint8_t>& out) override {
    zlib_.next_in = const_cast<Bytef*>(in.data());  // it only reads them
    zlib_.avail_in = static_cast<uInt>(in.size());
    zlib_.next_out = out.data();
    zlib_.avail_out = static_cast<uInt>(out.size());
    const int status = ::inflate(&zlib_, Z_NO_FLUSH);
    in = in.last(zlib_.avail_in);
    out = out.last(zlib_.avail_out);
    if (status == Z_STREAM_END) return Status::kMemberEnd;
    return status == Z_OK || status == Z_BUF_ERROR ? Status::kMore : Status::kDamaged;
  }
  void beginMember() override { inflateReset(&zlib_); }
  const char* format() const override { return "gzip"; }
  std::string damage() const override { return zlib_.msg != nullptr ? zlib_.msg : "no end"; }
  bool isWhole() const override {
    return zlib_.msg != nullptr && std::string_view(zlib_.msg) == "incorrect data check";
  }

 private:
  z_stream zlib_{};
};

/// As MRPT writes from 2.15.7 on.
class Zstandard : public Decompressor {
 public:
  Zstandard() : zstd_(ZSTD_createDStream(), &ZSTD_freeDStream) {
    if (!zstd_) throw std::bad_alloc();
  }

  Status inflate(std::span<const std::uint8_t>& in, std::span<std::uint8_t>& out) override {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    const std::size_t result = ZSTD_decompressStream(zstd_.get(), &to, &from);
    in = in.subspan(from.pos);
    out = out.subspan(to.pos);
    if (ZSTD_isError(result)) {
      damage_ = ZSTD_getErrorName(result);
      checksum_wrong_ = ZSTD_getErrorCode(result) == ZSTD_error_checksum_wrong;
      return Status::kDamaged;
    }
    return result == 0 ? Status::kMemberEnd : Status::kMore;
  }
  void beginMember() override {}  // it goes on by itself
  const char* format() const override { return "Zstandard"; }
  std::string damage() const override { return damage_; }
  bool isWhole() const override { return checksum_wrong_; }

 private:
  std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> zstd_;
  std::string damage_;
  bool checksum_wrong_ = false;
};

constexpr std::array<std::uint8_t, 2> kGzipMark{0x1f, 0x8b};
constexpr std::array<std::uint8_t, 4> kZstandardMark{0x28, 0xb5, 0x2f, 0xfd};
/// Of a frame that decompressors skip, for notes: 0x50 to 0x5f, then these.
constexpr std::array<std::uint8_t, 3> kSkippableMark{0x2a, 0x4d, 0x18};

template <class Mark>
bool startsWith(std::span<const std::uint8_t> bytes, const Mark& mark) {
  return bytes.size() >= mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin());
}

bool isSkippable(std::span<const std::uint8_t> bytes) {
  return !bytes.empty() && (bytes[0] & 0xf0U) == 0x50 && startsWith(bytes.subspan(1), kSkippableMark);
}

}  // namespace

std::unique_ptr<Decompressor> decompressorFor(std::span<const std::uint8_t> begin) {
  if (startsWith(begin, kGzipMark)) return std::make_unique<Gzip>();
  if (startsWith(begin, kZstandardMark) || isSkippable(begin)) return std::make_unique<Zstandard>();
  return nullptr;
}

}  // namespace fathom
