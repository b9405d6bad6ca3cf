#include "phase_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fathom::sealed {
namespace {

struct Measured {
  double angle_deg, per_sr;
};
constexpr std::array<Measured, 55> kPetzold{
    {{0.1, 1.767e3},   {0.126, 1.296e3}, {0.158, 9.502e2}, {0.2, 6.991e2},   {0.251, 5.140e2},
     {0.316, 3.764e2}, {0.398, 2.763e2}, {0.501, 2.188e2}, {0.631, 1.444e2}, {0.794, 1.022e2},
     {1, 7.161e1},     {1.259, 4.958e1}, {1.585, 3.395e1}, {1.995, 2.281e1}, {2.512, 1.516e1},
     {3.162, 1.002e1}, {3.981, 6.580},   {5.012, 4.295},   {6.310, 2.807},   {7.943, 1.819},
     {10, 1.153},      {15, 4.893e-1},   {20, 2.444e-1},   {25, 1.472e-1},   {30, 8.609e-2},
     {35, 5.931e-2},   {40, 4.210e-2},   {45, 3.067e-2},   {50, 2.275e-2},   {55, 1.699e-2},
     {60, 1.313e-2},   {65, 1.046e-2},   {70, 8.488e-3},   {75, 6.976e-3},   {80, 5.842e-3},
     {85, 4.953e-3},   {90, 4.292e-3},   {95, 3.782e-3},   {100, 3.404e-3},  {105, 3.116e-3},
     {110, 2.912e-3},  {115, 2.797e-3},  {120, 2.686e-3},  {125, 2.571e-3},  {130, 2.476e-3},
     {135, 2.377e-3},  {140, 2.329e-3},  {145, 2.313e-3},  {150, 2.365e-3},  {155, 2.506e-3},
     {160, 2.662e-3},  {165, 2.835e-3},  {170, 3.031e-3},  {175, 3.092e-3},  {180, 3.154e-3}}};

double degreesOf(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi; }

}  // namespace

PhaseFunction henyeyGreenstein(double g) {
  return [g](double cosine) { return g == 0 ? 1 : (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5); };
}

PhaseFunction fournierForand(double index, double slope) {
  const double v = (3 - slope) / 2, by_square = 4 / (3 * (index - 1) * (index - 1));
  const double back = by_square, back_v = std::pow(back, v);
  const double behind = (1 - back_v) / (16 * (back - 1) * back_v);
  return [=](double cosine) {
    const double half_sine2 = std::max(1e-9, (1 - cosine) / 2);
    const double d = by_square * half_sine2, dv = std::pow(d, v);
    const double ahead =
        (v * (1 - d) - (1 - dv) + (d * (1 - dv) - v * (1 - d)) / half_sine2) / (4 * (1 - d) * (1 - d) * dv);
    return 4 * (ahead + behind * (3 * cosine * cosine - 1));
  };
}

/// Straight between logarithms, and before the first: it falls by powers of the angle.
PhaseFunction petzold() {
  return [](double cosine) {
    const double angle_deg = std::max(degreesOf(cosine), 1e-4);
    const auto* above = std::upper_bound(kPetzold.begin() + 1, kPetzold.end() - 1, angle_deg,
                                         [](double angle, const Measured& m) { return angle < m.angle_deg; });
    const Measured &a = *(above - 1), &b = *above;
    const double share = std::log(angle_deg / a.angle_deg) / std::log(b.angle_deg / a.angle_deg);
    return 4 * std::numbers::pi * a.per_sr * std::pow(b.per_sr / a.per_sr, share);
  };
}

PhaseFunction lampPhase(const SealedCase& sealed, double stamp_s) {
  if (sealed.number("lamp", "petzold", stamp_s) != 0) return petzold();
  const double index = sealed.number("lamp", "fournier_forand_index", stamp_s);
  if (index != 0) return fournierForand(index, sealed.number("lamp", "fournier_forand_slope", stamp_s));
  return henyeyGreenstein(sealed.number("lamp", "scattering_asymmetry", stamp_s));
}

}  // namespace fathom::sealed
