#include "sha256.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/text.h"

namespace fathom::sealed {
namespace {

/// The first 32 bits of the fraction of a prime's root. A double holds them exactly: 53 bits, at most five
/// before the point.
template <class Root, std::size_t count>
std::array<std::uint32_t, count> fractionsOfRoots(Root root) {
  std::array<std::uint32_t, count> bits{};
  std::size_t found = 0;
  for (int candidate = 2; found < count; ++candidate) {
    bool prime = true;
    for (int divisor = 2; divisor * divisor <= candidate; ++divisor)
      prime = prime && candidate % divisor != 0;
    if (!prime) continue;
    const double value = root(static_cast<double>(candidate));
    bits[found++] = static_cast<std::uint32_t>((value - std::floor(value)) * 0x1.0p32);
  }
  return bits;
}

using State = std::array<std::uint32_t, 8>;

void addBlock(State& state, const unsigned char* block) {
  static const auto k = fractionsOfRoots<double (*)(double), 64>([](double p) { return std::cbrt(p); });
  std::array<std::uint32_t, 64> w{};
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t j = 0; j < 4; ++j) w[i] = w[i] << 8 | block[4 * i + j];
  for (std::size_t i = 16; i < 64; ++i) {
    const std::uint32_t s0 = std::rotr(w[i - 15], 7) ^ std::rotr(w[i - 15], 18) ^ w[i - 15] >> 3;
    const std::uint32_t s1 = std::rotr(w[i - 2], 17) ^ std::rotr(w[i - 2], 19) ^ w[i - 2] >> 10;
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t i = 0; i < 64; ++i) {
    const std::uint32_t s1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t s0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t t1 = h + s1 + ((e & f) ^ (~e & g)) + k[i] + w[i];
    const std::uint32_t t2 = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
  }
  const State sum{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < 8; ++i) state[i] += sum[i];
}

}  // namespace

std::string sha256(const std::string& bytes) {
  std::string padded = bytes + '\x80';
  while (padded.size() % 64 != 56) padded += '\0';
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(bytes.size());
  for (int shift = 56; shift >= 0; shift -= 8) padded += static_cast<char>(bits >> shift & 0xffU);
  State state = fractionsOfRoots<double (*)(double), 8>([](double p) { return std::sqrt(p); });
  for (std::size_t at = 0; at < padded.size(); at += 64)
    addBlock(state, reinterpret_cast<const unsigned char*>(padded.data()) + at);
  std::string hex;
  for (const std::uint32_t word : state) hex += print("%08x", word);
  return hex;
}

}  // namespace fathom::sealed
