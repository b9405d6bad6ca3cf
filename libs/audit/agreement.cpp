#include "audit/agreement.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace fathom {
namespace {

constexpr double kMostWeight = 60;  // what one relation says is never more certain than the model is right

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

/// A few velocities that are many times the others are "no measurement" by a number of some driver's own.
DvlStream withoutOutliers(const DvlStream& dvl) {
  constexpr double kTimes = 5;
  DvlStream clean{dvl.T_robot_dvl, {}};
  std::vector<double> speeds;
  for (const auto& reading : dvl.velocities) speeds.push_back(reading.value.norm());
  std::sort(speeds.begin(), speeds.end());
  const double most = speeds.empty() ? 0 : kTimes * speeds[speeds.size() * 3 / 4];
  for (const auto& reading : dvl.velocities)
    if (reading.value.norm() <= most) clean.velocities.push_back(reading);
  return clean;
}

/// Third differences of white noise have variance 20 sigma², and motion slower than the readings hardly
/// enters.
double whiteNoiseSquare(const DvlStream& dvl) {
  const auto& v = dvl.velocities;
  double sum = 0;
  for (std::size_t k = 3; k < v.size(); ++k)
    sum += (v[k].value - 3 * v[k - 1].value + 3 * v[k - 2].value - v[k - 3].value).squaredNorm() / 20;
  return v.size() > 3 ? sum / static_cast<double>(v.size() - 3) : 0;
}

double rmsSpeed(const DvlStream& dvl) {
  double sum = 0;
  for (const auto& reading : dvl.velocities) sum += reading.value.squaredNorm();
  return dvl.velocities.empty() ? 0 : std::sqrt(sum / static_cast<double>(dvl.velocities.size()));
}

}  // namespace

double Agreement::Difference::rms() const { return std::sqrt(square); }

Agreement::Agreement(const InsStream& ins, bool with_attitude, const DvlStream* dvl, const DepthStream* depth,
                     const Vehicle& vehicle, double force_scale)
    : ins_(ins),
      with_attitude_(with_attitude),
      dvl_(dvl == nullptr ? std::nullopt : std::optional(withoutOutliers(*dvl))),
      depth_(depth),
      vehicle_(vehicle),
      force_scale_(force_scale) {
  collect();
  const auto weight = [](double independent) { return std::min(0.5 * independent, kMostWeight); };
  const Assumption none;
  // Floors: three degrees of tilt, as accelerations make; a tenth of scale or so.
  as_they_stand_[kUp] = {upSquare(none), squared(0.05), 1, weight(0.5 * static_cast<double>(ups_.size()))};
  double turned = 0, tipped = 0;
  for (const Turning& t : turnings_) {
    const Vector3d rate = logSO3<double>(t.before.transpose() * t.after) / t.seconds;
    turned += rate.squaredNorm();
    regressions_[kTurning].add(t.rate, rate);
  }
  for (const Gravity& g : gravities_) tipped += g.change.squaredNorm();
  if (!turnings_.empty()) turned /= static_cast<double>(turnings_.size());
  if (!gravities_.empty()) tipped /= static_cast<double>(gravities_.size());
  as_they_stand_[kTurning] = {turningSquare(none), squared(radians(0.3)) + 0.01 * turned, turned,
                              weight(2 * static_cast<double>(turnings_.size()))};
  as_they_stand_[kGravity] = {gravitySquare(none), squared(radians(0.5)) + 0.01 * tipped, tipped,
                              weight(static_cast<double>(gravities_.size()))};
  if (dvl_ && force_scale_ > 0) {
    const Regression all = regressions_[kVelocity] = velocityOf(none);
    const double moves = std::min(all.rmsX(), all.rmsY());
    as_they_stand_[kVelocity] = {velocitySquare(none), squared(0.01) + 0.01 * squared(moves), squared(moves),
                                 weight(0.5 * static_cast<double>(all.count()))};
    dvl_noise_square_ = whiteNoiseSquare(*dvl_);
  }
  if (dvl_ && depth_ != nullptr && force_scale_ > 0) {
    const Regression rise = regressions_[kRise] = riseOf(none);
    const double moves = std::min(rise.rmsX(), rise.rmsY());
    // A misalignment of five degrees or so rises as the robot goes ahead.
    const double by_misalignment = 0.09 * kVerticalStep_s * rmsSpeed(*dvl_);
    as_they_stand_[kRise] = {meanSquareOff(rise, 1),
                             squared(0.03) + 0.01 * squared(moves) + squared(by_misalignment), squared(moves),
                             weight(static_cast<double>(rise.count()))};
  }
  // One glance at a robot that may be tilted by twenty degrees; one of three that are not upright means it.
  if (mean_up_.norm() > 0.8) as_they_stand_[kUpright] = {uprightSquare(none), squared(radians(20)), 1, 4};
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

double Agreement::upSquare(const Assumption& a) const {
  double sum = 0;
  for (const auto& [up, attitude] : ups_) {
    const Matrix3d R = a.attitude->read(attitude * a.attitude_axes.transpose(), ins_.T_robot_ins.rotation);
    sum += (R.transpose().col(2) - a.accelerometer * up).squaredNorm();
  }
  return ups_.empty() ? 0 : sum / static_cast<double>(ups_.size());
}

double Agreement::turningSquare(const Assumption& a) const {
  double sum = 0;
  for (const Turning& t : turnings_) {
    const auto read = [&](const Matrix3d& R) -> Matrix3d {
      return a.attitude->read(R * a.attitude_axes.transpose(), ins_.T_robot_ins.rotation);
    };
    sum += (logSO3<double>(read(t.before).transpose() * read(t.after)) / t.seconds - a.gyro * t.rate)
               .squaredNorm();
  }
  return turnings_.empty() ? 0 : sum / static_cast<double>(turnings_.size());
}

double Agreement::gravitySquare(const Assumption& a) const {
  double sum = 0;
  for (const Gravity& g : gravities_)
    sum += (a.accelerometer * g.change - (a.accelerometer * g.up).cross(a.gyro * g.rate)).squaredNorm();
  return gravities_.empty() ? 0 : sum / static_cast<double>(gravities_.size());
}

AssumedAxes Agreement::axesOf(const Assumption& a) const {
  return {a.gyro, force_scale_ * a.accelerometer, a.dvl, a.dvl_later_s};
}

const Regression& Agreement::velocityOf(const Assumption& a) const {
  std::array<double, 28> key{};
  const auto put = [&](const Matrix3d& m, std::ptrdiff_t at) {
    std::copy(m.data(), m.data() + 9, key.begin() + at);
  };
  put(a.gyro, 0), put(a.accelerometer, 9), put(a.dvl, 18);
  key[27] = a.dvl_later_s;
  const auto [known, is_new] = velocities_.try_emplace(key);
  if (is_new) known->second = accelerationEvidence(*dvl_, ins_, axesOf(a)).all();
  return known->second;
}

double Agreement::velocitySquare(const Assumption& a) const { return meanSquareOff(velocityOf(a), 1); }

Regression Agreement::riseOf(const Assumption& a) const {
  return verticalEvidence(*dvl_, ins_, *depth_, vehicle_, a.dvl, a.accelerometer);
}

double Agreement::riseSquare(const Assumption& a) const { return meanSquareOff(riseOf(a), a.rise); }

double Agreement::uprightSquare(const Assumption& a) const {
  const Vector3d up = ins_.T_robot_ins.rotation * a.accelerometer * mean_up_.normalized();
  return squared(std::acos(std::clamp(up.z(), -1.0, 1.0)));
}

Agreement::Differences Agreement::of(const Assumption& a) const {
  const bool gyro = !a.gyro.isIdentity(0), force = !a.accelerometer.isIdentity(0),
             dvl = !a.dvl.isIdentity(0) || a.dvl_later_s != 0,
             attitude = a.attitude != &attitudeReadings()[0] || !a.attitude_axes.isIdentity(0);
  Differences d = as_they_stand_;
  const auto update = [&](Relation relation, bool differs, auto square) {
    if (differs && d[relation].weight > 0) d[relation].square = (this->*square)(a);
  };
  update(kUp, force || attitude, &Agreement::upSquare);
  update(kTurning, gyro || attitude, &Agreement::turningSquare);
  update(kGravity, gyro || force, &Agreement::gravitySquare);
  update(kVelocity, gyro || force || dvl, &Agreement::velocitySquare);
  update(kRise, force || dvl || a.rise != 1, &Agreement::riseSquare);
  update(kUpright, force, &Agreement::uprightSquare);
  return d;
}

std::optional<Agreement::Turn> Agreement::bestTurn() const {
  if (as_they_stand_[kVelocity].weight == 0) return {};
  // The velocity turned by an angle is cos times what is level of it, plus sin times that turned by a
  // quarter, plus what is vertical.
  const Matrix3d level = Vector3d(1, 1, 0).asDiagonal();
  Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 0;
  const auto changesOf = [&](const Matrix3d& axes) {
    Assumption a;
    a.dvl = axes;
    return accelerationEvidence(*dvl_, ins_, axesOf(a)).changes;
  };
  const auto along = changesOf(level), across = changesOf(quarter),
             upright = changesOf(Vector3d(0, 0, 1).asDiagonal());
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < along.size(); ++i) {
    Eigen::Matrix<double, 3, 2> columns;
    columns << along[i].by_dvl, across[i].by_dvl;
    A += columns.transpose() * columns;
    b += columns.transpose() * (along[i].by_ins - upright[i].by_dvl);
  }
  const Eigen::Vector2d x = A.colPivHouseholderQr().solve(b);
  if (!x.allFinite() || x.norm() < 1e-3) return {};
  return Turn{std::atan2(x.y(), x.x()), x.norm()};
}

}  // namespace fathom
