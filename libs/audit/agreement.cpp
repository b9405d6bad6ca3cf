#include "audit/agreement.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "audit/water_column.h"
#include "core/median.h"

namespace fathom {
namespace {

constexpr double kMostWeight = 60;  // what one relation says is never more certain than the model is right
constexpr double kGyroBias_rad_s = radians(1), kAccelerometerBias_m_s2 = 0.3;  // micromechanical ones'

double squared(double x) { return x * x; }

/// Of y from slope x; 0 of nothing.
double meanSquareOff(const Regression& r, double slope) {
  return r.count() == 0 ? 0 : r.squareOff(slope) / static_cast<double>(r.count());
}

/// Over so many windows from one on; nothing where there is a gap.
template <class F>
void forEachSpan(const std::vector<InsWindow>& windows, std::size_t length, std::size_t step, F&& f) {
  for (std::size_t i = 0; i + length < windows.size(); i += step)
    if (windows[i + length].t_s - windows[i].t_s < 1.5 * static_cast<double>(length) * kInsWindow_s) f(i);
}

/// By how much each velocity is off the middle one of the five around it; each axis by itself.
std::vector<Vector3d> offNeighbours(const std::vector<Timed<Vector3d>>& velocities) {
  constexpr std::size_t kBeside = 2;
  std::vector<Vector3d> off(velocities.size(), Vector3d::Zero());
  for (std::size_t k = kBeside; k + kBeside < velocities.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> around;
      for (std::size_t i = k - kBeside; i <= k + kBeside; ++i) around.push_back(velocities[i].value[axis]);
      off[k][axis] = velocities[k].value[axis] - upperMedian(around);
    }
  return off;
}

/// A few velocities that are many times the others are "no measurement" by a number of some driver's own; a
/// few that are far off their neighbours (Hampel 1974) are wrong: one in a hundred is enough to make squares
/// of a robot that hardly moves say anything.
DvlStream withoutOutliers(const DvlStream& dvl) {
  constexpr double kTimes = 5, kSigmas = 5, kLeast_m_s = 0.01;  // of such a sigma: no DVL is better
  DvlStream clean{dvl.T_robot_dvl, {}};
  std::vector<double> speeds;
  for (const auto& reading : dvl.velocities) speeds.push_back(reading.value.norm());
  std::sort(speeds.begin(), speeds.end());
  const double most = speeds.empty() ? 0 : kTimes * speeds[speeds.size() * 3 / 4];
  const std::vector<Vector3d> off = offNeighbours(dvl.velocities);
  Vector3d farthest = Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> sizes;
    for (const Vector3d& own : off) sizes.push_back(std::abs(own[axis]));
    if (!sizes.empty()) farthest[axis] = kSigmas * std::max(kLeast_m_s, sigmaByMedian(std::move(sizes)));
  }
  for (std::size_t k = 0; k < off.size(); ++k)
    if (dvl.velocities[k].value.norm() <= most && (off[k].array().abs() <= farthest.array()).all())
      clean.velocities.push_back(dvl.velocities[k]);
  return clean;
}

/// Sum over axes of the variance of white noise. Its third differences have 20 times as much, and motion
/// slower than the readings hardly enters.
template <class Difference>
double whiteNoiseSquare(std::size_t count, Difference&& third) {
  double sum = 0;
  for (std::size_t k = 3; k < count; ++k) sum += third(k) / 20;
  return count > 3 ? sum / static_cast<double>(count - 3) : 0;
}

double velocityNoiseSquare(const DvlStream& dvl) {
  const auto& v = dvl.velocities;
  return whiteNoiseSquare(v.size(), [&](std::size_t k) {
    return (v[k].value - 3 * v[k - 1].value + 3 * v[k - 2].value - v[k - 3].value).squaredNorm();
  });
}

/// m², of a way between two readings.
double depthNoiseSquare(const DepthStream& depth, const Vehicle& vehicle) {
  const auto& p = depth.pressures;
  const double m_pa = depthOf(1, vehicle, {}) - depthOf(0, vehicle, {});
  return 2 * m_pa * m_pa * whiteNoiseSquare(p.size(), [&](std::size_t k) {
           return squared(p[k].value - 3 * p[k - 1].value + 3 * p[k - 2].value - p[k - 3].value);
         });
}

/// (rad/s)², of turns between attitudes a second apart.
double turningNoiseSquare(const InsStream& ins) {
  const auto& w = ins.windows;
  std::vector<Vector3d> turns;
  for (std::size_t k = 1; k < w.size(); ++k)
    if (w[k].attitude && w[k - 1].attitude)
      turns.push_back(logSO3<double>(w[k - 1].attitude->transpose() * *w[k].attitude));
  return 2 * whiteNoiseSquare(turns.size(), [&](std::size_t k) {
           return (turns[k] - 2 * turns[k - 1] + turns[k - 2]).squaredNorm();
         });
}

double rmsSpeed(const DvlStream& dvl) {
  double sum = 0;
  for (const auto& reading : dvl.velocities) sum += reading.value.squaredNorm();
  return dvl.velocities.empty() ? 0 : std::sqrt(sum / static_cast<double>(dvl.velocities.size()));
}

}  // namespace

double Agreement::Difference::rms() const { return std::sqrt(square); }

Agreement::Agreement(const InsStream& ins, const InsSheet& sheet, bool with_attitude, const DvlStream* dvl,
                     const DepthStream* depth, const Vehicle& vehicle, double force_scale)
    : ins_(ins),
      gyro_bias_sigma_(std::max(kGyroBias_rad_s, sheet.gyro_bias_sigma_rad_s)),
      accelerometer_bias_sigma_(std::max(kAccelerometerBias_m_s2, sheet.accelerometer_bias_sigma_m_s2)),
      with_attitude_(with_attitude),
      dvl_(dvl == nullptr ? std::nullopt : std::optional(withoutOutliers(*dvl))),
      depth_(depth),
      vehicle_(vehicle),
      force_scale_(force_scale) {
  collect();
  const auto weight = [](double independent) { return std::min(0.5 * independent, kMostWeight); };
  const Assumption none;
  // Floors: three degrees of tilt, as accelerations make; a tenth of scale or so.
  const auto compare = [&](Relation relation, double floor, double moves, double independent, auto square) {
    // Floor and weight first: with them biases are found.
    as_they_stand_[relation] = {0, 0, floor, moves, weight(independent)};
    const Squares squares = (this->*square)(none);
    as_they_stand_[relation].square = squares.square;
    as_they_stand_[relation].with_biases = squares.with_biases;
  };
  compare(kUp, squared(0.05), 1, 0.5 * static_cast<double>(ups_.size()), &Agreement::upSquare);
  double turned = 0, tipped = 0, swung = 0;
  for (const Turning& t : turnings_)
    turned += (logSO3<double>(t.before.transpose() * t.after) / t.seconds).squaredNorm();
  // An INS beside the axis of a turn feels what pulls it round: so far it takes up to be elsewhere.
  const double lever_m = ins.T_robot_ins.position.norm();
  for (const Gravity& g : gravities_) {
    tipped += g.change.squaredNorm();
    const double rate = g.rate.norm(), tilt = std::min(1.0, rate * rate * lever_m / kStandardGravity_m_s2);
    if (rate < vehicle.limits.turn_rate_rad_s) swung += squared(rate * tilt);
  }
  if (!turnings_.empty()) turned /= static_cast<double>(turnings_.size());
  if (!gravities_.empty()) tipped /= static_cast<double>(gravities_.size());
  if (!gravities_.empty()) swung /= static_cast<double>(gravities_.size());
  if (!turnings_.empty()) noise_squares_[kTurning] = turningNoiseSquare(ins_);
  compare(kTurning, squared(radians(0.3)) + 0.01 * turned, turned, 2 * static_cast<double>(turnings_.size()),
          &Agreement::turningSquare);
  const Vector3d bias = turningFit(none).bias;
  for (const Turning& t : turnings_)
    regressions_[kTurning].add(t.rate - bias, logSO3<double>(t.before.transpose() * t.after) / t.seconds);
  compare(kGravity, squared(radians(0.5)) + 0.01 * tipped + swung, tipped,
          static_cast<double>(gravities_.size()), &Agreement::gravitySquare);
  if (dvl_ && force_scale_ > 0) {
    const Regression all = velocitiesOf(none).all();
    const double moves = std::min(all.rmsX(), all.rmsY());
    compare(kVelocity, squared(0.01) + 0.01 * squared(moves), squared(moves),
            0.5 * static_cast<double>(all.count()), &Agreement::velocitySquare);
    // Biases that are fitted beside a wrong unit take some of it for themselves.
    constexpr double kGoesAlong = 0.6;
    regressions_[kVelocity] = all.correlation() > kGoesAlong ? all : velocityOf(none).regression;
    noise_squares_[kVelocity] = velocityNoiseSquare(*dvl_);
  }
  if (dvl_ && depth_ != nullptr && force_scale_ > 0) {
    const Regression rise = regressions_[kRise] = riseOf(none);
    const double moves = std::min(rise.rmsX(), rise.rmsY());
    noise_squares_[kRise] = depthNoiseSquare(*depth_, vehicle_);
    compare(kRise, riseFloor(none, squared(moves)), squared(moves), static_cast<double>(rise.count()),
            &Agreement::riseSquare);
  }
  // One glance at a robot that may be tilted by twenty degrees; one of three that are not upright means it.
  if (mean_up_.norm() > 0.8) compare(kUpright, squared(radians(20)), 1, 8, &Agreement::uprightSquare);
}

void Agreement::collect() {
  const auto& w = ins_.windows;
  std::size_t forces = 0;
  const auto meanForce = [&](std::size_t from, std::size_t count) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = from; k < from + count; ++k) sum += w[k].force;
    return sum;
  };
  const auto meanRate = [&](std::size_t from, std::size_t count) -> std::optional<Vector3d> {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = from; k < from + count; ++k) {
      if (w[k].rates == 0) return {};
      sum += w[k].rate;
    }
    return Vector3d(sum / static_cast<double>(count));
  };
  if (force_scale_ > 0)
    forEachSpan(w, 5, 5, [&](std::size_t i) {
      const Vector3d force = meanForce(i, 5);
      if (force.norm() < 1e-9) return;
      mean_up_ += force.normalized();
      ++forces;
      if (with_attitude_ && w[i + 2].attitude) ups_.emplace_back(force.normalized(), *w[i + 2].attitude);
    });
  if (forces >= kFewestSeconds) mean_up_ /= static_cast<double>(forces);
  forEachSpan(w, 10, 10, [&](std::size_t i) {
    const auto rate = meanRate(i, 10);
    if (with_attitude_ && rate && w[i].attitude && w[i + 10].attitude)
      turnings_.push_back(
          {*rate, *w[i].attitude, *w[i + 10].attitude, w[i + 10].attitude_t_s - w[i].attitude_t_s});
  });
  if (force_scale_ > 0)
    forEachSpan(w, 15, 5, [&](std::size_t i) {
      const Vector3d before = meanForce(i, 5), after = meanForce(i + 10, 5);
      const auto rate = meanRate(i + 5, 5);
      if (!rate || before.norm() < 1e-9 || after.norm() < 1e-9) return;
      gravities_.push_back({(before + after).normalized(), *rate,
                            (after.normalized() - before.normalized()) / (10 * kInsWindow_s)});
    });
  // A few say nothing.
  if (ups_.size() < kFewestSeconds) ups_.clear();
  if (turnings_.size() < kFewestSeconds) turnings_.clear();
  if (gravities_.size() < 2 * kFewestSeconds) gravities_.clear();
}

Agreement::Squares Agreement::upSquare(const Assumption& a) const {
  double sum = 0;
  for (const auto& [up, attitude] : ups_) {
    const Matrix3d R = a.attitude->read(attitude * a.attitude_axes.transpose(), ins_.T_robot_ins.rotation);
    sum += (R.transpose().col(2) - a.accelerometer * up).squaredNorm();
  }
  return ups_.empty() ? 0 : sum / static_cast<double>(ups_.size());
}

Agreement::Squares Agreement::turningSquare(const Assumption& a) const {
  const auto fit = turningFit(a);
  return {fit.square, fit.with_biases};
}

BiasFit<3>::Fit Agreement::turningFit(const Assumption& a) const {
  BiasFit<3> fit;
  for (const Turning& t : turnings_) {
    const auto read = [&](const Matrix3d& R) -> Matrix3d {
      return a.attitude->read(R * a.attitude_axes.transpose(), ins_.T_robot_ins.rotation);
    };
    fit.add(a.gyro * t.rate - logSO3<double>(read(t.before).transpose() * read(t.after)) / t.seconds,
            Matrix3d::Identity());
  }
  const Difference& d = as_they_stand_[kTurning];
  return fit.fit(Vector3d::Constant(gyro_bias_sigma_), d.floor, d.weight);
}

Agreement::Squares Agreement::gravitySquare(const Assumption& a) const {
  BiasFit<3> evidence;
  for (const Gravity& g : gravities_) {
    const Matrix3d across = crossMatrix<double>(a.accelerometer * g.up);
    evidence.add(across * a.gyro * g.rate - a.accelerometer * g.change, across);
  }
  const Difference& d = as_they_stand_[kGravity];
  const auto fit = evidence.fit(Vector3d::Constant(gyro_bias_sigma_), d.floor, d.weight);
  return {fit.square, fit.with_biases};
}

AccelerationEvidence Agreement::velocitiesOf(const Assumption& a) const {
  return accelerationEvidence(*dvl_, ins_,
                              {a.gyro, force_scale_ * a.accelerometer, a.dvl, a.dvl_later_s - a.ins_later_s});
}

const Agreement::Velocity& Agreement::velocityOf(const Assumption& a) const {
  std::array<double, 28> key{};
  const auto put = [&](const Matrix3d& m, std::ptrdiff_t at) {
    std::copy(m.data(), m.data() + 9, key.begin() + at);
  };
  put(a.gyro, 0), put(a.accelerometer, 9), put(a.dvl, 18);
  key[27] = a.dvl_later_s - a.ins_later_s;
  const auto [known, is_new] = velocities_.try_emplace(key);
  if (!is_new) return known->second;
  const AccelerationEvidence evidence = velocitiesOf(a);
  BiasFit<6> fit;
  for (const auto& change : evidence.changes) fit.add(change.by_dvl - change.by_ins, change.by_bias);
  BiasFit<6>::Vector sigma;
  sigma << Vector3d::Constant(gyro_bias_sigma_), Vector3d::Constant(accelerometer_bias_sigma_);
  const Difference& d = as_they_stand_[kVelocity];
  const auto [bias, square, with_biases] = fit.fit(sigma, d.floor, d.weight);
  return known->second = {evidence.all(bias), square, with_biases};
}

Agreement::Squares Agreement::velocitySquare(const Assumption& a) const {
  const Velocity& velocity = velocityOf(a);
  return {velocity.square, velocity.with_biases};
}

Regression Agreement::riseOf(const Assumption& a) const {
  const auto rise = [&](const DvlStream& dvl, const DepthStream& depth) {
    return verticalEvidence(dvl, ins_, depth, vehicle_, a.dvl, a.accelerometer);
  };
  if (a.dvl_later_s == 0 && a.ins_later_s == 0) return rise(*dvl_, *depth_);
  DvlStream dvl = *dvl_;
  DepthStream depth = *depth_;
  for (auto& reading : dvl.velocities) reading.t_s += a.dvl_later_s - a.ins_later_s;
  for (auto& reading : depth.pressures) reading.t_s -= a.ins_later_s;
  return rise(dvl, depth);
}

double Agreement::riseFloor(const Assumption& a, double moves_square) const {
  // A misalignment of five degrees or so rises as the robot goes ahead.
  const double speed = std::cbrt(std::abs(a.dvl.determinant())) * rmsSpeed(*dvl_);
  return squared(0.03) + 0.01 * moves_square + squared(0.09 * kVerticalStep_s * speed);
}

Agreement::Squares Agreement::riseSquare(const Assumption& a) const {
  return meanSquareOff(riseOf(a), a.rise);
}

Agreement::Squares Agreement::uprightSquare(const Assumption& a) const {
  const Vector3d up = ins_.T_robot_ins.rotation * a.accelerometer * mean_up_.normalized();
  return squared(std::acos(std::clamp(up.z(), -1.0, 1.0)));
}

Agreement::Differences Agreement::of(const Assumption& a) const {
  const bool gyro = !a.gyro.isIdentity(0), force = !a.accelerometer.isIdentity(0),
             dvl = !a.dvl.isIdentity(0) || a.dvl_later_s != 0 || a.ins_later_s != 0,
             attitude = a.attitude != &attitudeReadings()[0] || !a.attitude_axes.isIdentity(0);
  Differences d = as_they_stand_;
  const auto update = [&](Relation relation, bool differs, auto square) {
    if (!differs || d[relation].weight == 0) return;
    const Squares squares = (this->*square)(a);
    d[relation].square = squares.square, d[relation].with_biases = squares.with_biases;
  };
  update(kUp, force || attitude, &Agreement::upSquare);
  update(kTurning, gyro || attitude, &Agreement::turningSquare);
  update(kGravity, gyro || force, &Agreement::gravitySquare);
  update(kVelocity, gyro || force || dvl, &Agreement::velocitySquare);
  update(kRise, force || dvl || a.rise != 1, &Agreement::riseSquare);
  update(kUpright, force, &Agreement::uprightSquare);
  if (dvl && d[kRise].weight > 0) d[kRise].floor = riseFloor(a, d[kRise].moves);
  return d;
}

std::optional<double> Agreement::bestTurn() const {
  double angle_rad = 0;
  for (int i = 0; i < 2; ++i) {  // what a gyro's bias makes of the velocity depends on how it is turned
    const auto more_rad = bestTurn(rotationFromYawPitchRoll(angle_rad, 0, 0));
    if (!more_rad) return {};
    angle_rad += *more_rad;
  }
  return wrapAngle(angle_rad);
}

std::optional<double> Agreement::bestTurn(const Matrix3d& turned) const {
  const Difference& d = as_they_stand_[kVelocity];
  if (d.weight == 0) return {};
  // The velocity turned by an angle is cos times what is level of it, plus sin times that turned by a
  // quarter, plus what is vertical. Biases beside them, in units of their sigmas.
  const auto changesOf = [&](const Matrix3d& axes) {
    Assumption a;
    a.dvl = axes * turned;
    return velocitiesOf(a).changes;
  };
  Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 0;
  const auto along = changesOf(Vector3d(1, 1, 0).asDiagonal()), across = changesOf(quarter),
             upright = changesOf(Vector3d(0, 0, 1).asDiagonal()), all = changesOf(Matrix3d::Identity());
  Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
  A.diagonal().tail<6>().setConstant(d.floor + noise_squares_[kVelocity]);
  Eigen::Matrix<double, 8, 1> b = Eigen::Matrix<double, 8, 1>::Zero();
  for (std::size_t i = 0; i < along.size(); ++i) {
    Eigen::Matrix<double, 3, 8> columns;
    columns << along[i].by_dvl, across[i].by_dvl, -gyro_bias_sigma_ * all[i].by_bias.leftCols<3>(),
        -accelerometer_bias_sigma_ * all[i].by_bias.rightCols<3>();
    A += columns.transpose() * columns;
    b += columns.transpose() * (along[i].by_ins - upright[i].by_dvl);
  }
  const Eigen::Matrix<double, 8, 1> x = A.colPivHouseholderQr().solve(b);
  if (!x.allFinite() || x.head<2>().norm() < 1e-3) return {};
  return std::atan2(x[1], x[0]);
}

}  // namespace fathom
