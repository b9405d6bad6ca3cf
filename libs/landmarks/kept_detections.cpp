#include "landmarks/kept_detections.h"

#include <zlib.h>

#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <type_traits>

#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::uint32_t kLongestText = 1 << 20;
constexpr std::uint32_t kMostMarkers = 100000;  // in an image

struct Damage {};

/// Plain numbers and texts as bytes, in the machine's order.
class Packer {
 public:
  template <class T>
  void add(const T& number) {
    static_assert(std::is_arithmetic_v<T>);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void add(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes += text;
  }
  std::string bytes;
};

/// Takes them off again; throws Damage where there are too few.
class Unpacker {
 public:
  explicit Unpacker(const std::string& bytes) : bytes_(bytes) {}

  template <class T>
  T take() {
    T number;
    std::memcpy(&number, skip(sizeof number), sizeof number);
    return number;
  }
  std::uint32_t count(std::uint32_t limit) {
    const auto value = take<std::uint32_t>();
    if (value > limit) throw Damage{};
    return value;
  }
  std::string text() {
    const auto size = count(kLongestText);
    const char* begin = skip(size);
    return {begin, begin + size};
  }
  bool atEnd() const { return at_ == bytes_.size(); }

 private:
  const char* skip(std::size_t size) {
    if (size > bytes_.size() - at_) throw Damage{};
    at_ += size;
    return bytes_.data() + at_ - size;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

void pack(const Detection& detection, Packer& out) {
  out.add(detection.family);
  out.add(static_cast<std::int32_t>(detection.id));
  for (const Vector2d& corner : detection.corners_px)
    for (const double coordinate : corner) out.add(coordinate);
  for (const double element : detection.covariance_px2.reshaped()) out.add(element);
  out.add(static_cast<std::uint8_t>(detection.refined));
  out.add(static_cast<std::int32_t>(detection.corrected_bits));
  for (const double quality : {detection.decision_margin, detection.contrast, detection.blur_sigma_px})
    out.add(quality);
}

Detection unpackDetection(Unpacker& in) {
  Detection detection;
  detection.family = in.text();
  detection.id = in.take<std::int32_t>();
  for (Vector2d& corner : detection.corners_px)
    for (double& coordinate : corner) coordinate = in.take<double>();
  for (double& element : detection.covariance_px2.reshaped()) element = in.take<double>();
  detection.refined = in.take<std::uint8_t>() != 0;
  detection.corrected_bits = in.take<std::int32_t>();
  for (double* quality : {&detection.decision_margin, &detection.contrast, &detection.blur_sigma_px})
    *quality = in.take<double>();
  return detection;
}

KeptDetections unpack(const std::string& bytes, const std::string& inputs) {
  Unpacker in(bytes);
  if (in.text() != inputs) return {};
  KeptDetections kept;
  for (auto images = in.take<std::uint32_t>(); images > 0; --images) {
    auto& detections = kept[in.text()];
    for (auto markers = in.count(kMostMarkers); markers > 0; --markers)
      detections.push_back(unpackDetection(in));
  }
  if (!in.atEnd()) throw Damage{};
  return kept;
}

/// Its last bytes are the fingerprint of the others: zlib does not notice every cut.
std::optional<std::string> readSealed(const fs::path& file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.c_str(), "rb"), &gzclose);
  if (!in) return std::nullopt;
  std::string bytes;
  std::array<char, 1 << 16> piece{};
  int size = 0;
  while ((size = gzread(in.get(), piece.data(), static_cast<unsigned>(piece.size()))) > 0)
    bytes.append(piece.data(), static_cast<std::size_t>(size));
  const std::size_t seal_size = Fingerprint().hex().size();
  if (size < 0 || bytes.size() < seal_size) return std::nullopt;
  const std::string seal = bytes.substr(bytes.size() - seal_size);
  bytes.resize(bytes.size() - seal_size);
  if (seal != Fingerprint().add(bytes).hex()) return std::nullopt;
  return bytes;
}

}  // namespace

KeptDetections readKept(const fs::path& file, const std::string& inputs) {
  const auto bytes = readSealed(file);
  if (!bytes) return {};
  try {
    return unpack(*bytes, inputs);
  } catch (const Damage&) {
    return {};
  }
}

void writeKept(const fs::path& file, const std::string& inputs, const KeptDetections& kept) {
  Packer out;
  out.add(inputs);
  out.add(static_cast<std::uint32_t>(kept.size()));
  for (const auto& [image, detections] : kept) {
    out.add(image);
    out.add(static_cast<std::uint32_t>(detections.size()));
    for (const Detection& detection : detections) pack(detection, out);
  }
  out.bytes += Fingerprint().add(out.bytes).hex();

  PendingFile pending(file);
  const gzFile gz = gzopen(pending.path().c_str(), "wb1");
  const bool written =
      gz != nullptr && gzwrite(gz, out.bytes.data(), static_cast<unsigned>(out.bytes.size())) > 0;
  const bool closed = gz != nullptr && gzclose(gz) == Z_OK;
  if (!written || !closed) throw Error(file.string(), "", "cannot be written");
  pending.commit();
}

}  // namespace fathom
