#pragma once

#include <string>
#include <vector>

#include "diagnosis/black_box.h"
#include "diagnosis/diagnosis.h"

/// What was found in one recording, judged on another that nothing was fitted to: another manoeuvre, another
/// day.
namespace fathom {

/// Root mean squares of a channel, all that is estimated in any case estimated anew.
struct ElsewhereChannel {
  Channel channel = kChannel<Prior>;
  std::string metric;  ///< "reprojection_rms_px", "dvl_rms_mm_s", …
  double before = 0, after = 0, black_box = 0;
  double less = 0;  ///< before - after, in units of noise
};

struct Elsewhere {
  std::string failure;                     ///< why it could not be judged; empty: it was
  std::vector<ElsewhereChannel> channels;  ///< those that the effects change most first
  double physics = 0, black_box = 0;       ///< ln of the likelihood gained over the nominal model
};

/// Effects that a diagnosis found, or that came nearest, and that hold for any recording of the vehicle.
std::vector<Candidate> lastingEffects(const Diagnosis& diagnosis);

/// Those at their values, and beside them the black box with the splines it fitted where they were found.
class JudgeElsewhere {
 public:
  /// `recording`: the one diagnosed, in which something lasting was found. Throws Error, Interrupted.
  JudgeElsewhere(const Diagnosis& diagnosis, const BatchInput& recording);

  /// Throws Interrupted.
  Elsewhere judge(const BatchInput& other) const;

 private:
  JudgeElsewhere(const Diagnosis& diagnosis, const WhitenedModel& nominal);

  NoiseModel noise_;
  BatchOptions nominal_, with_;
  BlackBox black_box_;
  Eigen::VectorXd splines_;  // the black box's values
};

}  // namespace fathom
