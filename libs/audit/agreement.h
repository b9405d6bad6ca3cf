#pragma once

#include <array>
#include <map>
#include <optional>

#include "audit/acceleration_evidence.h"
#include "audit/assumption.h"
#include "audit/vertical_evidence.h"

namespace fathom {

/// How far an INS, a DVL and a pressure sensor disagree about what all of them saw, relation by relation,
/// under an assumption of what their entries are.
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
    double square = 0;  ///< mean of the squared difference; plus that of the floor
    double floor = 0;   ///< squared; less than this is ordinary: scale errors, misalignment, accelerations
    double moves = 0;   ///< mean square of what is compared, of the lesser side
    double weight = 0;  ///< half the number of independent numbers that were compared; 0: nothing was

    double rms() const;
  };
  using Differences = std::array<Difference, kRelations>;

  /// `force_scale`: to m/s² of the accelerometer; 0: what it reads is no specific force. What is not there is
  /// null. All must outlive this.
  Agreement(const InsStream& ins, bool with_attitude, const DvlStream* dvl, const DepthStream* depth,
            const Vehicle& vehicle, double force_scale);

  /// Of streams as they stand.
  const Differences& asTheyStand() const { return as_they_stand_; }
  /// Of kTurning the attitude's over the gyro's, of kVelocity the DVL's over the INS's, of kRise the
  /// pressure's over the DVL's: as they stand; of others nothing.
  const Regression& regression(Relation relation) const { return regressions_[relation]; }
  /// What is not compared otherwise is copied from asTheyStand().
  Differences of(const Assumption& assumption) const;

  /// Of kVelocity's square what is white noise of the DVL's readings, which no assumption changes; (m/s)².
  double dvlNoiseSquare() const { return dvl_noise_square_; }

  /// The best fit of a DVL's velocity turned about its z axis, and scaled: rad; nothing where it hardly
  /// moves.
  struct Turn {
    double angle_rad, scale;
  };
  std::optional<Turn> bestTurn() const;

 private:
  struct Turning {
    Vector3d rate;           ///< mean, INS axes
    Matrix3d before, after;  ///< attitudes
    double seconds;
  };
  struct Gravity {
    Vector3d up, rate, change;  ///< change a second
  };

  void collect();
  double upSquare(const Assumption& a) const;
  double turningSquare(const Assumption& a) const;
  double gravitySquare(const Assumption& a) const;
  double velocitySquare(const Assumption& a) const;
  double riseSquare(const Assumption& a) const;
  double uprightSquare(const Assumption& a) const;
  const Regression& velocityOf(const Assumption& a) const;
  Regression riseOf(const Assumption& a) const;
  AssumedAxes axesOf(const Assumption& a) const;

  const InsStream& ins_;
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
  double dvl_noise_square_ = 0;
  mutable std::map<std::array<double, 28>, Regression> velocities_;  ///< they take longest
};

}  // namespace fathom
