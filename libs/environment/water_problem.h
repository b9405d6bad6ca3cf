#pragma once

#include <ceres/problem.h>

#include <vector>

#include "environment/water_fit.h"
#include "sensors/image_model.h"

/// What fitWater() solves, again and again. Used within this room only.
namespace fathom {

inline constexpr double kWaterLossSigmas = 3;       ///< Cauchy's scale, of the norm of a patch's residuals
inline constexpr double kFirstWaterExcess = 0.002;  ///< half a digital number of eight bits

/// A state of the fit: parameters, and what patches vary by besides their own sigma.
struct WaterState {
  Vector9d water;
  std::vector<double> log_gain;  ///< one an image
  Vector3d excess = Vector3d::Constant(kFirstWaterExcess);
};

/// The state that the fit begins with, gains of 1: for each attenuation of a grid the model is linear in
/// ambient light and veil; the best of these by a robust cost.
WaterState waterStart(const std::vector<Patch>& patches, std::size_t images, const WaterFitOptions& options);

/// What a patch should read.
template <class T>
Vector3<T> predictRadiance(const Patch& patch, const T* water, const T& log_gain) {
  static const EffectParameters<T> nominal{};
  using std::exp;
  WaterColumn<T> column;
  Vector3<T> scene;
  for (int c = 0; c < 3; ++c) {
    column.attenuation_per_m[c] = water[c];
    column.veil[c] = water[3 + c];
    scene[c] = patch.albedo[c] * water[6 + c];
  }
  return predictLight<T>(scene, T(patch.z_m), T(patch.range_m), column, nominal) * exp(log_gain);
}

/// Of a patch's three channels: seen - predicted, and its sigma with the excess.
Vector3d residualOf(const Patch& patch, const WaterState& state);
Vector3d totalSigma(const Patch& patch, const Vector3d& excess);

/// The least-squares problem over some patches at a state, which solving moves.
class WaterProblem {
 public:
  WaterProblem(const std::vector<Patch>& patches, const std::vector<bool>& counts,
               const WaterFitOptions& options, bool robust, bool with_gain, WaterState& state);

  /// Whether the solution can be used.
  bool solve();
  /// Of the parameters, first the nine of the water; see fitWater() about the growth.
  void covariance(Eigen::MatrixXd& least_squares, Vector9d& growth);

 private:
  void add(const Patch& patch, bool robust);
  void addPriors(const WaterFitOptions& options);
  void addBounds(const WaterFitOptions& options);
  ceres::CRSMatrix evaluate();
  /// By how much sigmas grow where residuals of a channel's patches in one group are correlated, all pairs
  /// alike: the correlation is the mean over all pairs of all groups.
  template <class GroupOf>
  Vector9d growthByGroups(const ceres::CRSMatrix& jacobian, const Eigen::MatrixXd& least_squares,
                          const GroupOf& groupOf) const;

  WaterState& state_;
  bool with_gain_;
  ceres::Problem problem_;
  std::vector<const Patch*> chosen_;  ///< that count
  std::vector<double> residuals_;
};

}  // namespace fathom
