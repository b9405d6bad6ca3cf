#include "recording/decompressor.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <new>

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
      return Status::kDamaged;
    }
    return result == 0 ? Status::kMemberEnd : Status::kMore;
  }
  void beginMember() override {}  // it goes on by itself
  const char* format() const override { return "Zstandard"; }
  std::string damage() const override { return damage_; }

 private:
  std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> zstd_;
  std::string damage_;
};

}  // namespace

std::unique_ptr<Decompressor> decompressorFor(std::span<const std::uint8_t> begin) {
  constexpr std::array<std::uint8_t, 2> kGzipMark{0x1f, 0x8b};
  constexpr std::array<std::uint8_t, 4> kZstandardMark{0x28, 0xb5, 0x2f, 0xfd};
  const auto is = [&](const auto& mark) {
    return begin.size() >= mark.size() && std::equal(mark.begin(), mark.end(), begin.begin());
  };
  if (is(kGzipMark)) return std::make_unique<Gzip>();
  if (is(kZstandardMark)) return std::make_unique<Zstandard>();
  return nullptr;
}

}  // namespace fathom
