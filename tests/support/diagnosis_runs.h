#pragma once

#include <functional>

#include "effects/catalogue.h"
#include "estimation/linearization.h"
#include "estimation/nuisances.h"
#include "support/batch_runs.h"
#include "support/hidden_effect.h"

/// Recordings that hide something, for the diagnosis: an effect of a size in units of what the recording can
/// resolve, or nothing at all.
namespace fathom::test {

/// 1.2 to 3.4 m before the panel at x = 6 m, which stays in view: range, heading, roll, pitch and depth all
/// move, each at its own frequency, none above 0.6 rad/s so that knots 0.2 s apart follow.
Pose richPose(double t);

Trajectory pathOf(double duration_s, const std::function<Pose(double)>& poseAt);

BatchRun richRun(std::uint64_t seed, double duration_s = 80.0);
/// 24 s of it, with what its images show of light.
const BatchRun& lightDive();

class Excitation;

/// A recording and what it hides.
struct DiagnosisRun {
  std::string name;
  BatchRun run;
  std::function<void(const BatchRun&, std::vector<Sample>&)> change;  ///< of the samples, afterwards
  std::optional<Candidate> truth;                                     ///< where it hides an effect
  double sqrt_lambda = 0;                                             ///< its size
  std::shared_ptr<const Excitation> excitation;  ///< where sensors are other than the path's usual ones
  std::function<void(std::vector<ImagePatch>&)> change_light = {};  ///< of the patches, afterwards
  std::function<void(std::vector<MarkerBlur>&)> change_edges = {};  ///< likewise

  BatchInput input() const {
    std::vector<Sample> all = run.samples();
    if (change) change(run, all);
    BatchInput input = run.input(all);
    if (change_light) change_light(input.data.patches);
    if (change_edges) change_edges(input.data.blurs);
    return input;
  }
};

/// What a path lets its recording resolve, against the declared error budget: residuals and derivatives where
/// nothing is missing, without noise.
class Excitation {
 public:
  explicit Excitation(BatchRun run);

  const Linearization& linear() const { return linear_; }
  const BatchEstimate& estimate() const { return estimate_; }

  /// By how many sigma the effects change each reading, all orders, less what the nuisances take over. The
  /// seed: of a recording in which something is drawn anew for each image.
  Eigen::VectorXd signal(const EffectParameters<double>& effects, std::uint64_t seed = 0) const;
  /// sqrt(phi^T A phi) of small effects: the length of their signal.
  double sqrtLambda(const EffectParameters<double>& effects, std::uint64_t seed = 0) const {
    return signal(effects, seed).norm();
  }

  /// |c|: the cosine between a signal and the nearest one that a rival's parameters can make, to first order.
  double alignment(const Eigen::VectorXd& signal, const Candidate& rival) const;
  /// lambda (1 - |c|): below 5.4 a rival cannot be told apart at 5 %.
  double separability(const Eigen::VectorXd& signal, const Candidate& rival) const;

  /// Whether any reading depends on it.
  bool canShow(const EffectInfo& effect) const;

  /// How much of an effect's columns the nuisances leave.
  double kept(const Candidate& candidate) const;

  /// Every effect, for good; a marker's for each marker, a step's at every tenth of the recording.
  std::vector<Candidate> candidates() const;

 private:
  Eigen::MatrixXd project(const Eigen::MatrixXd& C) const;

  Eigen::VectorXd residualsWith(const EffectParameters<double>& effects, std::uint64_t seed) const;

  Eigen::MatrixXd columns(const Candidate& candidate) const;

  BatchInput input_;
  BatchEstimate estimate_;
  Linearization linear_;
  std::optional<Nuisances> nuisances_;
  Eigen::VectorXd nominal_;
};

/// An effect hidden in a recording: its direction at random in units of the priors, its marker, its step's
/// time, of a current every other time its interval too; its size such that sqrt(lambda) is as asked, or the
/// largest that the registry's limits allow.
DiagnosisRun effectOfSize(const BatchRun& nominal, const Excitation& excitation, const EffectInfo& effect,
                          double sqrt_lambda, std::uint64_t seed);

// Nothing left out.

DiagnosisRun plainNull(const BatchRun& nominal, std::uint64_t seed);

/// The map's markers moved out of its plane by a wave, about a period across the panel, at most by so much.
/// What of it is a plane is taken out, for that would be a panel which is elsewhere than the map says, and
/// what of it is folded, twisted or bent, for that is an effect.
PanelMap rippled(PanelMap panel, double largest_m, Random& random);

/// The DVL's noise as a first-order autoregression of the same variance.
void correlateDvl(const BatchRun& run, std::vector<Sample>& samples, double correlation, Random& random);

/// Nothing left out by a world a little richer than the model: 1 mm of panel ripple, corners of heavier
/// tails (Student's t of 4), correlated DVL noise (0.6), the three together; of light, noise that goes with
/// it, a thousandth.
DiagnosisRun richNull(const BatchRun& nominal, std::uint64_t seed);

}  // namespace fathom::test
