#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace fathom {

/// A 64-bit FNV-1a hash: tells inputs apart, withstands no malice.
class Fingerprint {
 public:
  Fingerprint& add(const void* bytes, std::size_t size);
  Fingerprint& add(double number) { return add(&number, sizeof number); }
  Fingerprint& add(std::string_view text) { return add(text.data(), text.size()); }
  std::uint64_t value() const { return hash_; }
  std::string hex() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace fathom
