#include "core/random.h"

#include <cmath>
#include <numbers>

namespace fathom {

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 - u is in (0, 1]
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Eigen::MatrixXd Random::normals(Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd all(rows, columns);
  for (double& value : all.reshaped()) value = normal();
  return all;
}

Random Random::stream(std::uint64_t seed, std::uint64_t number) {
  std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                      static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)};
  std::uint32_t mixed[2];
  words.generate(mixed, mixed + 2);
  return Random((static_cast<std::uint64_t>(mixed[0]) << 32) | mixed[1]);
}

}  // namespace fathom
