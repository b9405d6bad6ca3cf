#pragma once

#include <array>
#include <map>
#include <optional>

#include "audit/acceleration_evidence.h"
#include "audit/assumption.h"
#include "audit/bias_fit.h"
#include "audit/vertical_evidence.h"

namespace fathom {

/// How far an INS, a DVL and a pressure sensor disagree about what all of them saw, relation by relation,
/// under an assumption of what their entries are. Constant biases as instruments have are no disagreement.
class Agreement {
 public:
  enum Relation : std::size_t {
    kUp,        ///< up by the specific force and by the attitude; rad
    kTurning,   ///< the gyro and how the attitude turns; rad/s
    kGravity,   ///< the gyro and how the specific force's direction turns (Farrell 2008, sec. 2.6); rad/s
    kVelocity,  ///< how the DVL's velocity changes and what the INS makes of it; m/s
    kRise,      ///< the way up by pressure and by the DVL in kVerticalStep_s; m
    kUpright,   ///< the specific force and the robot's up: most robots stay about upright; rad
    kRelations
  };
  struct Difference {
    double square = 0;       ///< mean of the squared difference, without likely biases
    double with_biases = 0;  ///< the same with them
    double floor = 0;   ///< squared; less than this is ordinary: scale errors, misalignment, accelerations
    double moves = 0;   ///< mean square of what is compared, of the lesser side
    double weight = 0;  ///< half the number of independent numbers that were compared; 0: nothing was

    double rms() const;
  };
  using Differences = std::array<Difference, kRelations>;

  /// `force_scale`: to m/s² of the accelerometer; 0: what it reads is no specific force. What is not there is
  /// null. All must outlive this.
  Agreement(const InsStream& ins, const InsSheet& sheet, bool with_attitude, const DvlStream* dvl,
            const DepthStream* depth, const Vehicle& vehicle, double force_scale);

  /// Of streams as they stand.
  const Differences& asTheyStand() const { return as_they_stand_; }
  /// Of kTurning the attitude's over the gyro's, of kVelocity the DVL's over the INS's, of kRise the
  /// pressure's over the DVL's: as they stand; of others nothing.
  const Regression& regression(Relation relation) const { return regressions_[relation]; }
  /// What is not compared otherwise is copied from asTheyStand().
  Differences of(const Assumption& assumption) const;

  /// Of a relation's square what is white noise of the DVL's, the pressure sensor's or the attitude's
  /// readings, which no assumption changes.
  double noiseSquare(Relation relation) const { return noise_squares_[relation]; }

  /// By which angle about its z axis a DVL's velocity fits best: rad; nothing where it hardly moves.
  std::optional<double> bestTurn() const;

 private:
  struct Turning {
    Vector3d rate;           ///< mean, INS axes
    Matrix3d before, after;  ///< attitudes
    double seconds;
  };
  struct Gravity {
    Vector3d up, rate, change;  ///< change a second
  };

  /// The INS's velocity without likely biases beside the DVL's, and their difference.
  struct Velocity {
    Regression regression;
    double square = 0, with_biases = 0;
  };

  struct Squares {
    Squares(double without_bias) : square(without_bias), with_biases(without_bias) {}
    Squares(double likely, double raw) : square(likely), with_biases(raw) {}
    double square, with_biases;
  };

  void collect();
  Squares upSquare(const Assumption& a) const;
  Squares turningSquare(const Assumption& a) const;
  Squares gravitySquare(const Assumption& a) const;
  BiasFit<3>::Fit turningFit(const Assumption& a) const;
  Squares velocitySquare(const Assumption& a) const;
  Squares riseSquare(const Assumption& a) const;
  Squares uprightSquare(const Assumption& a) const;
  const Velocity& velocityOf(const Assumption& a) const;
  std::optional<double> bestTurn(const Matrix3d& turned) const;  ///< what is left of it
  double riseFloor(const Assumption& a, double moves_square) const;
  AccelerationEvidence velocitiesOf(const Assumption& a) const;
  Regression riseOf(const Assumption& a) const;

  const InsStream& ins_;
  /// Of biases: what small instruments have, or the data sheet's where that is more; rad/s and m/s².
  const double gyro_bias_sigma_, accelerometer_bias_sigma_;
  const bool with_attitude_;
  std::optional<DvlStream> dvl_;  ///< without outliers
  const DepthStream* depth_;
  const Vehicle& vehicle_;
  double force_scale_;
  std::vector<std::pair<Vector3d, Matrix3d>> ups_;  ///< direction of the specific force, attitude
  std::vector<Turning> turnings_;
  std::vector<Gravity> gravities_;
  Vector3d mean_up_ = Vector3d::Zero();  ///< INS axes
  Differences as_they_stand_;
  std::array<Regression, kRelations> regressions_;
  std::array<double, kRelations> noise_squares_{};
  mutable std::map<std::array<double, 28>, Velocity> velocities_;  ///< they take longest
};

}  // namespace fathom
