#pragma once

#include <ceres/jet.h>
#include <ceres/problem.h>

#include <type_traits>
#include <vector>

#include "environment/fitted_water.h"
#include "imaging/image_patch.h"
#include "observables/patches.h"

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

/// The forward model of the fit, with what is known: water and gain to what a patch should read.
class PatchModel {
 public:
  static constexpr int kParameters = 10;  ///< the water's nine, and the gain
  using Jet = ceres::Jet<double, kParameters>;

  explicit PatchModel(const KnownLight& known);

  /// The light that comes to the camera, `water` as waterParameters(); T is double or Jet.
  template <class T>
  Vector3<T> light(const Patch& patch, const Vector9<T>& water) const {
    const EffectParameters<T>& effects = effectsAs<T>();
    const SceneLight<T> shining = sceneLightOn<T>(patch, effects, patch.t_s);
    PatchUnderLamps<T> under_lamps;
    if (effects.isActive(kEffectIndex<Lamp>, patch.t_s)) under_lamps = lampsOn<T>(patch, water, shining);
    return predictPatchLight<T>(
        patch, T(patch.z_m), T(patch.range_m), shining, under_lamps, water, effects, patch.t_s,
        {patch.sight.camera_m.template cast<T>(), patch.sight.direction.template cast<T>()});
  }

  /// What the patch should read. Where no effect is on the camera's response it is the light itself, be it
  /// brighter than full scale: or else a fit would not find its way back.
  template <class T>
  Vector3<T> radiance(const Patch& patch, const T* water, const T& log_gain) const {
    using std::exp;
    const Vector3<T> seen = light<T>(patch, Eigen::Map<const Vector9<T>>(water));
    if (!changes_response_) return seen * exp(log_gain);
    return predictPatchReading<T>(seen, patch, effectsAs<T>(), patch.t_s, exp(log_gain));
  }

  /// The inverse of the camera's response: the light that a patch's reading stands for.
  Vector3d lightSeen(const Patch& patch) const;

 private:
  template <class T>
  const EffectParameters<T>& effectsAs() const {
    if constexpr (std::is_same_v<T, double>)
      return effects_;
    else
      return jet_effects_;
  }
  template <class T>
  PatchUnderLamps<T> lampsOn(const Patch& patch, const Vector9<T>& water,
                             const SceneLight<T>& shining) const {
    PatchOnRobot<T> place{{}, patch.on_robot.normal_robot.template cast<T>()};
    for (std::size_t i = 0; i < place.around_robot.size(); ++i)
      place.around_robot[i] = patch.on_robot.around_robot[i].template cast<T>();
    const Mounting<T, Camera> mount{patch.T_robot_camera.rotation.template cast<T>(),
                                    patch.T_robot_camera.position.template cast<T>()};
    return underLamps<T>(place, lamps_, mount, water, shining);
  }

  EffectParameters<double> effects_;
  EffectParameters<Jet> jet_effects_;  ///< the same
  std::vector<LampSheet> lamps_;
  bool changes_response_;
};

/// The state that the fit begins with, gains of 1: for each attenuation of a grid the model is linear in
/// ambient light and veil; the best of these by a robust cost.
WaterState waterStart(const std::vector<Patch>& patches, std::size_t images, const WaterFitOptions& options);

/// Of a patch's three channels: seen - predicted, and its sigma with the excess.
Vector3d residualOf(const PatchModel& model, const Patch& patch, const WaterState& state);
Vector3d totalSigma(const Patch& patch, const Vector3d& excess);

/// The least-squares problem over some patches at a state, which solving moves.
class WaterProblem {
 public:
  /// The model outlives the problem.
  WaterProblem(const PatchModel& model, const std::vector<Patch>& patches, const std::vector<bool>& counts,
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

  const PatchModel& model_;
  WaterState& state_;
  bool with_gain_;
  ceres::Problem problem_;
  std::vector<const Patch*> chosen_;  ///< that count
  std::vector<double> residuals_;
};

}  // namespace fathom
