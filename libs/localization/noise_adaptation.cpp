#include "localization/noise_adaptation.h"

#include <algorithm>
#include <numeric>

#include "core/chi_square.h"

namespace fathom {
namespace {

// Upper bounds. A sigma is raised threefold at most: beyond that the vehicle file is wrong, or the sensor,
// which is not to be hidden.
constexpr double kHighestVariance = 9.0;
constexpr double kHighestDrive = 100.0;

// A measurement's variance.
/// What is stated counts as so many readings of three numbers that say the same; readings before the last so
/// many are forgotten by and by, since noise changes.
constexpr double kStated = 20.0, kRemembered = 300.0;
constexpr double informationOf(double readings) { return readings * 1.5; }

/// Each reading's share in the mean of the latest. By chance that mean is sqrt(kMeanShare / 2) = 0.14 sigma,
/// so that this many sigmas are not.
constexpr double kMeanShare = 0.1, kToOneSide = 1.5;

// A level's two.
/// They are judged after so many numbers, and at once after fewer that are this much larger than they should
/// be.
constexpr int kNumbers = 300, kAtOnce = 30;
constexpr double kTooLarge = 2.5;
/// A judgement is the mean of all before, later of about the last ten.
constexpr double kShare = 0.1;
/// Of what the factors are off by: ordinary, and by what a judgement moves them at least and most.
constexpr double kOrdinary = 0.5, kLeastMove = 0.05, kMostMove = 4.0, kFarOff = 0.5;
/// Of a reading's three numbers: squares that a hundredth of readings has; how alike two are that are to one
/// side.
constexpr double kSurprise = 11.0, kAlike = 0.7;
/// An onset is seen so surely, in sigmas; after kNumbers more so much of it is left.
constexpr double kSurely = 3.0, kOnsetDecay = 0.5, kMostOnset = 1e4;
/// Of R or of P in S: where it is less nothing is told of it.
constexpr double kLeastShare = 1e-3;
/// Of a prior's variance: what readings have told at least, for anything to be made of it.
constexpr double kLeastTold = 1e-4;
/// Numbers beyond so many sigmas are outliers.
constexpr double kOutlier = 4.0;

/// A factor is at its bound from so much of it on.
constexpr double kAtBound = 0.95;
/// What a chi-square variable of so many degrees of freedom exceeds once in 10 000 times.
const std::array<double, 7> kSeenOnceIn10000 = [] {
  std::array<double, 7> quantiles{};
  for (std::size_t dof = 1; dof < quantiles.size(); ++dof)
    quantiles[dof] = chiSquareQuantile(static_cast<double>(dof), 0.9999);
  return quantiles;
}();

/// A bias of so many sigmas was not told of. (Of one that its prior holds down readings tell too little: what
/// a DVL that is turned a little against the INS tells of it would be taken for a bias, too.) No INS that a
/// vehicle carries has larger ones than these.
constexpr double kFarBias = 3.0, kMostGyro_rad_s = radians(1.0), kMostAccelerometer_m_s2 = 0.3;

/// Nothing else aboard tells what these do, so that an error of the filter stays in their innovations.
bool tellsPositionOrHeading(Channel channel) {
  const auto start = textOf(channel).start;
  return start == ChannelText::Start::position || start == ChannelText::Start::heading;
}

/// What the readings tell of a bias without its prior: the posterior with the prior taken out.
struct ToldBias {
  Vector3d bias, variance;

  ToldBias(const Vector3d& posterior, const Vector3d& posterior_variance, double sigma) {
    const double prior = sigma * sigma;
    const Vector3d told = (prior - posterior_variance.array()).max(kLeastTold * prior);
    bias = posterior.cwiseQuotient(told) * prior;
    variance = posterior_variance.cwiseQuotient(told) * prior;
  }
};

/// All axes of an instrument are of a kind: where one is far off, none is trusted.
void widenBlock(ErrorStateFilter<kFullSize>& filter, int block, const Vector3d& bias, double most,
                double& sigma, std::vector<int>& widened) {
  if (bias.cwiseAbs().maxCoeff() <= kFarBias * sigma) return;
  const ToldBias told(bias, filter.P.diagonal().segment<3>(block), sigma);
  const double likeliest = std::sqrt(std::max(0.0, (told.bias.squaredNorm() - told.variance.sum()) / 3.0));
  const double wider = std::min(likeliest, most);
  if (wider <= sigma) return;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& x = filter.x;
    const double now = (block == kGyroBias ? x.gyro_bias_rad_s : x.accelerometer_bias_m_s2)[axis];
    filter.widenPrior(block + axis, now, sigma, wider);
    widened.push_back(block + axis);
  }
  sigma = wider;
}

}  // namespace

Shown shownBySighting(const UncertainPose& seen, const Update& done) {
  Shown shown{6, done.nis};
  for (int k = 0; k < shown.size; ++k)
    shown.own_share += seen.covariance(k, k) / done.variances[static_cast<std::size_t>(k)] / shown.size;
  return shown;
}

void MeanInnovation::add(const Shown& shown) {
  for (std::size_t k = 0; k < mean_.size(); ++k) mean_[k] += kMeanShare * (shown.residual[k] - mean_[k]);
}

double MeanInnovation::square() const {
  return std::inner_product(mean_.begin(), mean_.end(), mean_.begin(), 0.0);
}

void MeasurementVariance::add(const Shown& shown, double to_one_side) {
  const double f = shown.own_share, M = shown.size;
  information_ = std::min(information_ + 0.5 * f * f * M, informationOf(kRemembered));
  log_ += 0.5 * f * (std::max(0.0, shown.nis - to_one_side) - M) / (information_ + informationOf(kStated));
  log_ = std::clamp(log_, std::log(kLowestVariance), std::log(kHighestVariance));
  times_ = std::exp(log_);
}

bool MeasurementVariance::isAtBound() const { return times_ > kAtBound * kHighestVariance; }

bool LevelVariances::isAtBounds() const {
  return measurement_.times > kAtBound * kHighestVariance && drive_.times > kAtBound * kHighestDrive;
}

void LevelVariances::Factor::move(double ratio, double variance, double share, double lowest,
                                  double highest) {
  const double off = std::clamp(ratio, kLeastMove, kMostMove);
  const double weight = share * kOrdinary * kOrdinary / (kOrdinary * kOrdinary + variance);
  // By the mean of what is judged, so that NIS comes out right in the mean; down from far off faster.
  times *= off < kFarOff ? std::pow(off, weight) : 1.0 + weight * (off - 1.0);
  times = std::clamp(times, lowest, highest);
}

void LevelVariances::add(const Shown& shown) {
  double square = 0.0, product = 0.0;
  for (std::size_t k = 0; k < past_.size(); ++k) {
    const double now = std::clamp(shown.residual[k], -kOutlier, kOutlier);
    square += now * now;
    product += now * last_[k];
    products_ += now * past_[k];
    past_squares_ += past_[k] * past_[k];
    past_[k] = shown.own_share * past_[k] + now;
    last_[k] = now;
  }
  // Twice beyond what is ordinary and to the same side: a manoeuvre begins, which the next reading may
  // follow.
  if (square > kSurprise && last_square_ > kSurprise && product > kAlike * std::sqrt(square * last_square_))
    onset_ = std::min(onset_ * kMostMove, kMostOnset);
  last_square_ = square;
  squares_ += square;
  shares_ += shown.own_share;
  ++readings_;
  numbers_ += shown.size;
  const bool surprises = numbers_ >= kAtOnce && squares_ > kTooLarge * numbers_;
  if (numbers_ >= kNumbers || surprises) conclude(surprises);
}

void LevelVariances::conclude(bool surprises) {
  const double share = std::max(1.0 / ++judgements_, kShare);
  const double n = numbers_, C0 = squares_ / n;
  const double rest = std::clamp(shares_ / readings_, kLeastShare, 1.0 - kLeastShare), g = 1.0 - rest;
  const double change = past_squares_ > 0.0 ? products_ / past_squares_ : 0.0;
  const double gain = std::clamp(g + change, 0.5 * g, 1.0 - 0.5 * rest);
  const double least = std::max(C0 - change * products_ / n, 0.5 * C0);
  const double gain_variance = (1.0 - rest * rest) / n;
  const double drive_off = gain * gain / (g * g) * least;
  measurement_.move((1.0 - gain) / rest * least, 2.0 / n + gain_variance / (rest * rest), share,
                    lowest_variance_, kHighestVariance);
  drive_.move(drive_off * onset_, 2.0 / n + 4.0 * gain_variance / (g * g), share, lowest_drive_,
              kHighestDrive);
  // What is noise differs from reading to reading; behind a manoeuvre the filter stays back, to one side.
  const bool stays_back = products_ > kSurely * std::sqrt(past_squares_ * C0);
  onset_ = surprises && stays_back ? std::min(onset_ * std::clamp(drive_off, 1.0, kMostMove), kMostOnset)
                                   : std::max(1.0, std::pow(kOnsetDecay, n / kNumbers) * onset_);
  squares_ = products_ = past_squares_ = shares_ = 0.0;
  numbers_ = readings_ = 0;
}

std::vector<int> NoiseAdaptation::widenBiases(ErrorStateFilter<kFullSize>& filter) {
  std::vector<int> widened = biases.widen(filter);
  if (!widened.empty()) others_ = {};
  return widened;
}

std::vector<int> BiasSigmas::widen(ErrorStateFilter<kFullSize>& filter) {
  std::vector<int> widened;
  widenBlock(filter, kGyroBias, filter.x.gyro_bias_rad_s, kMostGyro_rad_s, gyro_rad_s, widened);
  widenBlock(filter, kAccelerometerBias, filter.x.accelerometer_bias_m_s2, kMostAccelerometer_m_s2,
             accelerometer_m_s2, widened);
  return widened;
}

ProcessNoise AdaptedDrive::appliedTo(ProcessNoise assumed) const {
  assumed.angular_velocity *= turning_times;
  assumed.acceleration *= pushing_times;
  assumed.gyro_bias_sigma_rad_s.setConstant(biases.gyro_rad_s);
  assumed.accelerometer_bias_sigma_m_s2.setConstant(biases.accelerometer_m_s2);
  return assumed;
}

double NoiseAdaptation::varianceTimes(Channel channel) const {
  if (channel == kChannel<Gyro>) return gyro_.measurementTimes();
  if (channel == kChannel<Accelerometer>) return accelerometer_.measurementTimes();
  return others_[indexOf(channel)].times();
}

NoiseAdaptation::NoiseAdaptation(bool has_bias_states)
    : gyro_(has_bias_states ? LevelVariances{kLowestTurning} : LevelVariances{1.0, 1.0}),
      accelerometer_(has_bias_states ? LevelVariances{kLowestPushing} : LevelVariances{1.0, 1.0}) {}

bool NoiseAdaptation::contradicts(Channel channel, const Shown& shown, double nis) const {
  // R and S taken as alike in all directions.
  const double stated_nis = nis / (1.0 - shown.own_share + shown.own_share / varianceTimes(channel));
  const bool is_to_one_side = means_[indexOf(channel)].square() > kToOneSide * kToOneSide;
  return is_to_one_side || isAtBounds(channel) ||
         stated_nis > kSeenOnceIn10000[static_cast<std::size_t>(shown.size)];
}

bool NoiseAdaptation::isAtBounds(Channel channel) const {
  if (channel == kChannel<Gyro>) return gyro_.isAtBounds();
  if (channel == kChannel<Accelerometer>) return accelerometer_.isAtBounds();
  return textOf(channel).tells == ChannelText::Tells::position && others_[indexOf(channel)].isAtBound();
}

void NoiseAdaptation::add(Channel channel, const Shown& shown) {
  if (!std::isfinite(shown.nis)) return;  // it would be remembered for good
  if (channel == kChannel<Gyro>)
    gyro_.add(shown);
  else if (channel == kChannel<Accelerometer>)
    accelerometer_.add(shown);
  else if (tellsPositionOrHeading(channel)) {
    MeanInnovation& mean = means_[indexOf(channel)];
    mean.add(shown);
    others_[indexOf(channel)].add(shown, mean.square());
  } else
    others_[indexOf(channel)].add(shown);
}

}  // namespace fathom
