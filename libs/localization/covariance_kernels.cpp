#include "localization/covariance_kernels.h"

#include "localization/covariance_arithmetic.h"

#if defined(__x86_64__)
#define FATHOM_WIDE [[gnu::target("avx2,fma")]]
#else
#define FATHOM_WIDE
#endif

namespace fathom {
namespace {

template <int N>
struct BaseKernels {
  using Four = kernels::FourDoubles;
  static void propagate(double* P, const TransitionBlocks& F, const double* q, double decay) {
    kernels::propagate<Four, N>(P, F, q, decay);
  }
  static void project(const double* P, const StateColumns& columns, const double* H, Border<N>& border) {
    kernels::project<Four, N>(P, columns, H, border);
  }
  static bool eliminate(Border<N>& border) { return kernels::eliminate<Four, N>(border); }
  static void subtract(double* P, const Border<N>& border) { kernels::subtract<Four, N>(P, border); }
  static void turn(double* P, const Matrix3d& G) { kernels::turn<Four, N>(P, G); }
};

template <int N>
struct WideKernels {
  using Four = kernels::FourDoubles;
  FATHOM_WIDE static void propagate(double* P, const TransitionBlocks& F, const double* q, double decay) {
    kernels::propagate<Four, N>(P, F, q, decay);
  }
  FATHOM_WIDE static void project(const double* P, const StateColumns& columns, const double* H,
                                  Border<N>& border) {
    kernels::project<Four, N>(P, columns, H, border);
  }
  FATHOM_WIDE static bool eliminate(Border<N>& border) { return kernels::eliminate<Four, N>(border); }
  FATHOM_WIDE static void subtract(double* P, const Border<N>& border) {
    kernels::subtract<Four, N>(P, border);
  }
  FATHOM_WIDE static void turn(double* P, const Matrix3d& G) { kernels::turn<Four, N>(P, G); }
};

template <class Kernels, int N>
constexpr CovarianceKernels<N> kTable{Kernels::propagate, Kernels::project, Kernels::eliminate,
                                      Kernels::subtract, Kernels::turn};

}  // namespace

bool processorHas(Instructions instructions) {
#if defined(__x86_64__)
  return instructions == Instructions::base ||
         (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"));
#else
  return instructions == Instructions::base;
#endif
}

template <int N>
const CovarianceKernels<N>& covarianceKernels(Instructions instructions) {
  return instructions == Instructions::wide ? kTable<WideKernels<N>, N> : kTable<BaseKernels<N>, N>;
}

template <int N>
const CovarianceKernels<N>& fastestKernels() {
  static const CovarianceKernels<N>& fastest =
      covarianceKernels<N>(processorHas(Instructions::wide) ? Instructions::wide : Instructions::base);
  return fastest;
}

template const CovarianceKernels<kCoreSize>& covarianceKernels<kCoreSize>(Instructions);
template const CovarianceKernels<kFullSize>& covarianceKernels<kFullSize>(Instructions);
template const CovarianceKernels<kCoreSize>& fastestKernels<kCoreSize>();
template const CovarianceKernels<kFullSize>& fastestKernels<kFullSize>();

}  // namespace fathom
