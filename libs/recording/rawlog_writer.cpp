#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "core/error.h"
#include "core/files.h"
#include "recording/decompressor.h"
#include "recording/observations.h"
#include "recording/rawlog.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr int kLevel = 6;
// Small enough that the reader checks a block as a whole (ByteStream::kBlockBytes), large enough to cost
// nothing in size: deflate looks back 32 KiB only.
constexpr std::size_t kBlockBytes = std::size_t{256} << 10;

}  // namespace

struct RawlogWriter::Impl {
  Impl(fs::path target, Time start);
  ~Impl() { deflateEnd(&zlib); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  PendingFile file;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out;
  z_stream zlib{};
  std::vector<std::uint8_t> block, compressed;
  Time last_time;

  void writeBlock();
  Error writeError() const;
};

RawlogWriter::Impl::Impl(fs::path target, Time start)
    : file(std::move(target)), out(std::fopen(file.path().c_str(), "wb"), &std::fclose), last_time(start) {
  if (!out) throw writeError();
  if (deflateInit2(&zlib, kLevel, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

Error RawlogWriter::Impl::writeError() const {
  return {file.target().string(), "", std::string("cannot be written: ") + std::strerror(errno)};
}

/// Writes what has been gathered as one gzip member.
void RawlogWriter::Impl::writeBlock() {
  if (block.empty()) return;
  deflateReset(&zlib);
  compressed.resize(deflateBound(&zlib, static_cast<uLong>(block.size())));
  zlib.next_in = block.data();
  zlib.avail_in = static_cast<uInt>(block.size());
  zlib.next_out = compressed.data();
  zlib.avail_out = static_cast<uInt>(compressed.size());
  if (deflate(&zlib, Z_FINISH) != Z_STREAM_END) throw std::logic_error("deflateBound is too small");
  const std::size_t size = compressed.size() - zlib.avail_out;
  if (std::fwrite(compressed.data(), 1, size, out.get()) != size) throw writeError();
  block.clear();
}

RawlogWriter::RawlogWriter(fs::path file, const RecordingHeader& header, Time start)
    : impl_(std::make_unique<Impl>(std::move(file), start)) {
  // The header is a block of its own: see ByteStream on the first one.
  encodeHeader(header, start, impl_->block);
  impl_->writeBlock();
}

RawlogWriter::~RawlogWriter() = default;

void RawlogWriter::write(const Sample& sample) {
  if (!impl_->out) throw std::logic_error("the rawlog is finished");
  if (sample.time < impl_->last_time) throw std::logic_error("samples must be written in time order");
  encodeSample(sample, impl_->block);
  impl_->last_time = sample.time;
  if (impl_->block.size() >= kBlockBytes) impl_->writeBlock();
}

void RawlogWriter::finish() {
  impl_->writeBlock();
  if (std::fclose(impl_->out.release()) != 0) throw impl_->writeError();
  impl_->file.commit();
}

}  // namespace fathom
