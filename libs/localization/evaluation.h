#pragma once

#include <optional>
#include <vector>

#include "localization/localizer.h"
#include "recording/tum.h"

namespace fathom {

/// One estimate against the reference.
struct PoseError {
  double t_s = 0.0;
  Vector3d position_m = Vector3d::Zero();          ///< estimate - reference, odom
  Vector3d rotation_rad = Vector3d::Zero();        ///< Log(R_reference^T R_estimate), robot axes
  Vector3d position_sigma_m = Vector3d::Zero();    ///< what the filter believed
  Vector3d rotation_sigma_rad = Vector3d::Zero();  ///< likewise
  double nees = 0.0;  ///< normalized squared error of the pose, 6 degrees of freedom
};

struct MeanAndSigma {
  double mean = 0.0, sigma = 0.0;
};

/// The mean and the standard deviation about it (1/(n-1); 0 of a single value). Not of nothing.
MeanAndSigma meanAndSigma(const std::vector<double>& values);

struct Evaluation {
  std::vector<PoseError> errors;  ///< in time order
  MeanAndSigma position_m;        ///< of the errors' norms
  MeanAndSigma angle_rad;         ///< geodesic (Huynh 2009)
  double position_rms_m = 0.0, angle_rms_rad = 0.0;
  double nees_mean = 0.0;
  double within_3_sigma = 0.0;  ///< share of the six components times estimates
  double path_m = 0.0;          ///< length of the reference
  bool is_laid = false;         ///< the reference was laid on the first estimate: see Evaluator
};

/// Collects errors as estimates come; summarizes at the end. As long as odom is a definition of the start's
/// (Estimate::defined), the reference is laid on the first estimate in the coordinates that nothing told: it
/// has a frame of its own.
class Evaluator {
 public:
  explicit Evaluator(const std::vector<StampedPose>& reference) : reference_(reference) {}
  /// False where the reference does not cover its time.
  bool add(const Estimate& estimate);
  /// Nothing where no estimate lies within the reference's time.
  std::optional<Evaluation> finish() const;

 private:
  const std::vector<StampedPose>& reference_;
  std::vector<PoseError> errors_;
  std::optional<Pose> T_defined_reference_;
};

/// |position error| of the last estimate at or before a time since the recording's first entry; NaN where
/// there is none within 2 s.
double positionErrorAt(const std::vector<PoseError>& errors, double t_s);

}  // namespace fathom
