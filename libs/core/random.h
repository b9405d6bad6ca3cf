#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace fathom {

/// The one source of randomness: seeded, handed in, never global. The same seed gives the same numbers on
/// every machine: std::normal_distribution is not portable, so the normal is made here (Box-Muller).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal.
  double normal();
  Eigen::Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }
  Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns);
  std::uint64_t bits() { return engine_(); }
  /// An independent stream, for a sensor or a run of its own: adding one draw here moves no other stream.
  static Random stream(std::uint64_t seed, std::uint64_t number);

 private:
  std::mt19937_64 engine_;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace fathom
