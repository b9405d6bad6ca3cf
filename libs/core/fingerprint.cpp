#include "core/fingerprint.h"

namespace fathom {

Fingerprint& Fingerprint::add(const void* bytes, std::size_t size) {
  const auto* byte = static_cast<const std::uint8_t*>(bytes);
  for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ byte[i]) * 0x100000001b3U;
  return *this;
}

std::string Fingerprint::hex() const {
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += "0123456789abcdef"[hash_ >> shift & 0xfU];
  return text;
}

}  // namespace fathom
