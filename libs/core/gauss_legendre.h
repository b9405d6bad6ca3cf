#pragma once

#include <array>

namespace fathom {

/// Gauss-Legendre quadrature of 20 points on [-1, 1]: each abscissa stands for itself and its negative.
struct GaussLegendre20 {
  struct Point {
    double abscissa, weight;
  };
  static constexpr std::array<Point, 10> kPoints{{{0.076526521133497338, 0.15275338713072584},
                                                  {0.22778585114164507, 0.14917298647260374},
                                                  {0.37370608871541955, 0.14209610931838204},
                                                  {0.51086700195082713, 0.13168863844917664},
                                                  {0.63605368072651502, 0.11819453196151841},
                                                  {0.7463319064601508, 0.10193011981724044},
                                                  {0.83911697182221878, 0.083276741576704755},
                                                  {0.91223442825132595, 0.062672048334109068},
                                                  {0.96397192727791381, 0.040601429800386939},
                                                  {0.99312859918509488, 0.017614007139152118}}};
};

}  // namespace fathom
