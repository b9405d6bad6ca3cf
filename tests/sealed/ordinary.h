#pragma once

#include <vector>

#include "sealed_case.h"
#include "streams.h"

/// What real recordings differ by for no named reason. A case's `ordinary` scales all of it.
namespace fathom::sealed {

/// Standard deviations at `ordinary` 1, and over what smooth ones are correlated.
struct OrdinaryImperfections {
  double placement_m = 0.0003;                         ///< of each marker, in the face, x and y
  double flatness_m = 0.001, flatness_length_m = 0.5;  ///< of the panel
  double marker_height_m = 0.0002;                     ///< of each marker besides
  double marker_scale = 0.001;                         ///< all alike
  double stretch = 0.00033;                            ///< of the printed sheet, x and y apart
  double edge_px = 0.01;                               ///< white grows over black, all markers alike
  double marker_edge_px = 0.01;                        ///< each besides, by the corner detector
  double response = 0.005, response_length_dn = 60;    ///< fraction of the signal
  double flat_field = 0.01, flat_field_length = 0.31;  ///< length: of the image's width
  double illumination = 0.02, illumination_length_m = 0.5;
  double marker_albedo = 0.014;  ///< of each marker; with the next 2 % in all
  double albedo = 0.014, albedo_length_m = 0.05;
  double gain = 0.003;     ///< of each image
  double stamp_s = 0.001;  ///< of each image
  double camera_clock_ppm = 10;
  double dvl_m_s = 0.001, dvl_length_m_s = 0.3;  ///< each axis, smooth in its speed
  double outliers = 0.01;                        ///< fraction of corners and of DVL measurements
};
inline constexpr OrdinaryImperfections kOrdinary;

/// A smooth random function of zero mean: a Gaussian process whose correlation falls off as a Gaussian of
/// that length, as a sum of waves (random Fourier features: Rahimi & Recht 2007).
class SmoothField {
 public:
  SmoothField() = default;  ///< zero everywhere
  SmoothField(double sigma, double length, Random random);

  double at(const Vector3d& place) const;
  double at(double place) const { return at(Vector3d(place, 0, 0)); }
  bool isZero() const { return waves_.empty(); }

 private:
  struct Wave {
    Vector3d number;  ///< radians a unit of place
    double phase_rad;
  };
  double amplitude_ = 0;
  std::vector<Wave> waves_;
};

/// A field over a rectangle, linear between places one step apart: as light sees it at millions of places.
class FieldTable {
 public:
  FieldTable() = default;  ///< zero everywhere
  FieldTable(const SmoothField& field, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double step);

  /// Beyond the rectangle, as at its border.
  double at(double x, double y) const;
  bool isZero() const { return values_.empty(); }

 private:
  Eigen::Vector2d low_{0, 0};
  double step_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<double> values_;  ///< by row
};

/// Over the panel's face and legs.
FieldTable onPanel(const SmoothField& field);

/// A field at the case's scale; zero everywhere where nothing is ordinary.
SmoothField ordinaryField(const SealedCase& sealed, double sigma, double length, Stream which,
                          std::uint64_t index = 0);

/// Off by so much in any direction, for a fraction of the measurements.
template <int Size>
Eigen::Matrix<double, Size, 1> outlier(double fraction, double least, double most, Random& random) {
  using Offset = Eigen::Matrix<double, Size, 1>;
  const double chance = random.uniform(), size = random.uniform(least, most);
  Offset direction;
  for (double& coordinate : direction) coordinate = random.normal();
  return chance < fraction ? Offset(size * direction.normalized()) : Offset(Offset::Zero());
}

/// How far white grows over black, of all markers, without what is hidden. Light itself only spreads: in
/// images this is never negative.
double ordinaryEdgeGrowth_px(const SealedCase& sealed);

}  // namespace fathom::sealed
