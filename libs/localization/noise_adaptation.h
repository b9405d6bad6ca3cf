#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "localization/error_state_filter.h"
#include "sensors/channels.h"

/// How far the noise that a filter assumes is from what its innovations show, learnt while it runs.
namespace fathom {

/// What a reading showed, of a measurement of M numbers.
struct Shown {
  int size = 0;                      ///< M
  double nis = 0.0;                  ///< beyond the gate: the gate
  double own_share = 0.0;            ///< of the measurement's noise R in S, mean over the diagonal
  std::array<double, 6> residual{};  ///< each over the root of its variance, diagonal of S
};

template <class AnyMeasurement>
Shown shownBy(const AnyMeasurement& m, const Update& done, double gate) {
  Shown shown{static_cast<int>(m.residual.size()), std::min(done.nis, gate)};
  for (int k = 0; k < shown.size; ++k) {
    const auto at = static_cast<std::size_t>(k);
    shown.residual[at] = m.residual[k] / std::sqrt(done.variances[at]);
    shown.own_share += m.R(k, k) / done.variances[at] / shown.size;
  }
  return shown;
}
/// By a sighting that was fused; without its residual.
Shown shownBySighting(const UncertainPose& seen, const Update& done);

/// The mean of a channel's latest innovations, each component over its sigma. Noise has none; a sensor that
/// is off, or a filter that is, has.
class MeanInnovation {
 public:
  void add(const Shown& shown);
  double square() const;  ///< summed over the components

 private:
  std::array<double, 6> mean_{};
};

/// One factor on a measurement's variance R: maximum likelihood of the innovations, followed reading by
/// reading along the natural gradient (Fisher scoring; Amari 1998). Per reading the score of log R is
/// f (NIS - M) / 2, its information f² M / 2, where f is R's share in S.
class MeasurementVariance {
 public:
  double times() const { return times_; }
  bool isAtBound() const;
  /// `to_one_side`: what of NIS is no scatter.
  void add(const Shown& shown, double to_one_side = 0.0);

 private:
  double log_ = 0.0, times_ = 1.0;
  double information_ = 0.0;
};

/// A drive is lowered by no more. Between two readings of the velocity the acceleration is what the
/// accelerometer says of it, with errors that stay for so long (alignment, scale, gravity that leaks in), and
/// no less than these is the drive; the turning rate is read by the gyro alone.
inline constexpr double kLowestTurning = 1e-4, kLowestPushing = 1e-2;
/// Of what is stated of a measurement. Lowered by little: innovations show what differs from reading to
/// reading, and an error that stays (an alignment, a scale, a gyro's drift) is in the sheet's sigma and not
/// in them.
inline constexpr double kLowestVariance = 0.7;

/// Two factors of a state that one sensor reads at a rate at which it can follow: on R, and on the density q
/// of what drives it. A local level (a random walk seen through noise) is what turning rate and acceleration
/// are to gyro and accelerometer. Maximum likelihood of its innovations, by the prediction-error method
/// (Ljung & Soderstrom 1983): their variance C0, in units of S, is to be 1, and the gain g = 1 - R/S is to
/// make them least. How an innovation goes down with the gain is the sum u of those before, each weighed by
/// (1 - g) to its age, so that g is off by mean(nu u) / mean(u²). With g' and C0', R is off by
/// (1 - g') C0' / (1 - g) and q by g'² C0' / g².
class LevelVariances {
 public:
  explicit LevelVariances(double lowest_drive, double lowest_variance = kLowestVariance)
      : lowest_drive_(lowest_drive), lowest_variance_(lowest_variance) {}

  double measurementTimes() const { return measurement_.times; }
  double driveTimes() const { return drive_.times * onset_; }
  /// Neither factor can follow any further.
  bool isAtBounds() const;
  void add(const Shown& shown);

 private:
  struct Factor {
    double times = 1.0;
    /// Off by `ratio`, which is told with this variance.
    void move(double ratio, double variance, double share, double lowest, double highest);
  };
  void conclude(bool surprises);

  double lowest_drive_, lowest_variance_;
  Factor measurement_, drive_;
  double onset_ = 1.0;                     ///< of the drive, while a manoeuvre begins that was not foreseen
  std::array<double, 3> past_{}, last_{};  ///< u, and the latest innovation, of each number
  double last_square_ = 0.0;
  double squares_ = 0.0, products_ = 0.0, past_squares_ = 0.0, shares_ = 0.0;
  int numbers_ = 0, readings_ = 0, judgements_ = 0;
};

/// The stationary sigmas of the INS's biases, of each axis. Where a bias comes out far beyond, sigma becomes
/// the likeliest by what readings tell of the bias without it (empirical Bayes; Efron & Morris 1973).
struct BiasSigmas {
  double gyro_rad_s = 0.0, accelerometer_m_s2 = 0.0;

  /// What the smaller sigma has told the filter is taken back. The error coordinates whose sigma has changed.
  std::vector<int> widen(ErrorStateFilter<kFullSize>& filter);
};

/// What drives the motion, as it was found to be: factors on the densities assumed, and the biases.
struct AdaptedDrive {
  double turning_times = 1.0, pushing_times = 1.0;
  BiasSigmas biases;

  ProcessNoise appliedTo(ProcessNoise assumed) const;
};

/// Of all channels, as a filter knows it at one time: copied with it, since a late reading rewinds both.
class NoiseAdaptation {
 public:
  /// Without states for what gyro and accelerometer are off by, that is in their noise and the drives, which
  /// then are never lowered.
  explicit NoiseAdaptation(bool has_bias_states);

  BiasSigmas biases;  ///< to begin with, those that are assumed

  /// On the variance that the vehicle file, or the sighting, states.
  double varianceTimes(Channel channel) const;
  AdaptedDrive drive() const { return {gyro_.driveTimes(), accelerometer_.driveTimes(), biases}; }

  void add(Channel channel, const Shown& shown);
  /// Whether a reading of this NIS is one that a consistent filter sees once in 10 000, with the
  /// measurement's noise as it is stated; or the channel's noise has gone as far as it may: readings that
  /// drive the state, or that tell where it is, make it follow them and then do not contradict it any more.
  /// Of what tells position or heading also: its innovations are to one side, reading after reading.
  bool contradicts(Channel channel, const Shown& shown, double nis) const;
  /// As BiasSigmas; what readings have shown of other noise meanwhile was the bias, and is forgotten.
  std::vector<int> widenBiases(ErrorStateFilter<kFullSize>& filter);

 private:
  bool isAtBounds(Channel channel) const;

  LevelVariances gyro_, accelerometer_;
  std::array<MeasurementVariance, kChannelCount> others_{};
  std::array<MeanInnovation, kChannelCount> means_{};  ///< of what tells position or heading
};

}  // namespace fathom
