#pragma once

#include <cstddef>
#include <deque>

namespace fathom {

/// Moving average of angles that are alike after `symmetry_rad`, each weighted by its sigma: of the last
/// `window` readings the mean direction (Mardia & Jupp 2000, ch. 2), symmetry taken for a whole turn.
class CircularAverage {
 public:
  CircularAverage(double symmetry_rad, std::size_t window) : symmetry_rad_(symmetry_rad), window_(window) {}

  void add(double angle_rad, double sigma_rad);
  std::size_t count() const { return readings_.size(); }
  /// There must be a reading; in [0, symmetry).
  double mean_rad() const;
  /// Of the mean: of the readings' sigmas, or of how they scatter, whichever is larger.
  double sigma_rad() const;
  /// Length of the mean direction: 1 where all readings agree, 0 where they say nothing.
  double agreement() const;

 private:
  struct Reading {
    double angle_rad, weight;
  };

  double symmetry_rad_;
  std::size_t window_;
  std::deque<Reading> readings_;
};

}  // namespace fathom
