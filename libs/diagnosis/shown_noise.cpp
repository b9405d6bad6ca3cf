#include "diagnosis/shown_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/median.h"
#include "core/random.h"
#include "diagnosis/constants.h"
#include "diagnosis/saturated.h"

namespace fathom {
namespace {

/// Sums over a channel of squares and of neighbours' products.
struct Moments {
  double square = 0, product = 0;
  double correlation() const { return square > 0 ? product / square : 0; }
};

using Pairs = std::vector<std::array<std::size_t, 2>>;

struct ChannelRows {
  std::vector<std::size_t> rows;
  Pairs pairs;
};

Moments momentsOf(const Eigen::Ref<const Eigen::VectorXd>& r, const ChannelRows& own) {
  Moments moments;
  for (const std::size_t i : own.rows)
    moments.square += r[static_cast<Eigen::Index>(i)] * r[static_cast<Eigen::Index>(i)];
  for (const auto& [a, b] : own.pairs)
    moments.product += r[static_cast<Eigen::Index>(a)] * r[static_cast<Eigen::Index>(b)];
  if (!own.pairs.empty())
    moments.product *= static_cast<double>(own.rows.size()) / static_cast<double>(own.pairs.size());
  return moments;
}

/// What is left as far as a robust fit is moved by it: of an outlier the threshold, however far off it is.
Eigen::VectorXd influenceOf(const Eigen::VectorXd& left, const Linearization& linear) {
  Eigen::VectorXd influence = left;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    influence[static_cast<Eigen::Index>(i)] *= std::sqrt(linear.rows[i].robust_weight);
  return influence;
}

/// Times the noise assumed, with which influences are as large as white noise's would be (Huber 1964,
/// proposal 2): a few outliers do not make all readings seem noisy, and what is estimated scatters as it is
/// said to.
double robustScale(const Eigen::VectorXd& left, const Linearization& linear, const ChannelRows& own,
                   double expected_square) {
  struct Reading {
    double square = 0, threshold = 0;  // in full; 0: none
  };
  std::map<std::size_t, Reading> readings;
  for (const std::size_t i : own.rows) {
    const RowInfo& row = linear.rows[i];
    Reading& reading = readings[row.reading];
    reading.square += std::pow(left[static_cast<Eigen::Index>(i)], 2) / row.robust_weight;
    reading.threshold = row.robust_threshold;
  }
  const auto squareAt = [&](double scale) {
    double sum = 0;
    for (const auto& [index, reading] : readings) {
      const double square = reading.square / (scale * scale);
      sum += reading.threshold > 0 ? std::min(square, reading.threshold * reading.threshold) : square;
    }
    return sum;
  };
  double less = 1 / kMostScale, more = kMostScale;
  for (int halving = 0; halving < kScaleHalvings; ++halving) {
    const double middle = std::sqrt(less * more);
    (squareAt(middle) > expected_square ? less : more) = middle;
  }
  return std::sqrt(less * more);
}

Moments meanMoments(const Eigen::MatrixXd& draws, const ChannelRows& own) {
  Moments mean;
  for (const auto& draw : draws.colwise()) {
    const Moments moments = momentsOf(draw, own);
    mean.square += moments.square / static_cast<double>(draws.cols());
    mean.product += moments.product / static_cast<double>(draws.cols());
  }
  return mean;
}

std::array<ChannelRows, kChannelCount> rowsByChannel(const Linearization& linear) {
  std::array<ChannelRows, kChannelCount> channels;
  for (const Channel channel : kEveryChannel) {
    auto& own = channels[indexOf(channel)];
    if (channel == kChannel<Prior>) continue;
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].channel == channel) own.rows.push_back(i);
    own.pairs = neighbours(linear, channel);
  }
  return channels;
}

/// White noise made into that of first-order autoregressions, sigma one.
Eigen::MatrixXd correlated(Eigen::MatrixXd noise, const std::array<ChannelRows, kChannelCount>& rows,
                           const std::array<double, kChannelCount>& correlation) {
  for (std::size_t c = 0; c < rows.size(); ++c) {
    if (correlation[c] == 0) continue;
    const double fresh = std::sqrt(1 - correlation[c] * correlation[c]);
    for (const auto& [a, b] : rows[c].pairs) {
      const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b);
      noise.row(j) = correlation[c] * noise.row(i) + fresh * noise.row(j);
    }
  }
  return noise;
}

/// The pixels' noise as two parts: the sigma stated, so many times, and a share of the light. By the sum of
/// what is left squared, and by the same with more weight where the second part would show most; without a
/// second part where that sum is not beyond chance, or where there is no more noise than is stated: that
/// counts what rounding does to dark places, which lasts, and is not to be made less of. `influence`: of
/// what is left; `simulated`: what would be left of white noise.
void splitLightNoise(const Eigen::VectorXd& influence, const Linearization& linear,
                     const std::vector<std::size_t>& rows, const Eigen::MatrixXd& simulated,
                     const NoiseModel& assumed, NoiseModel& noise) {
  constexpr auto kPixels = indexOf(kChannel<Pixels>);
  if (rows.size() < kFewestRows) return;
  const double scale = assumed.channels[kPixels].independentScale();
  const auto count = std::ssize(rows);
  // As shares of the variance assumed: of what is stated, of all the light; what is left of them; and what is
  // seen.
  Eigen::ArrayXd stated(count), light(count), left(count), seen(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto row = static_cast<Eigen::Index>(rows[static_cast<std::size_t>(k)]);
    const RowInfo& info = linear.rows[rows[static_cast<std::size_t>(k)]];
    light[k] = std::pow(info.level * info.per_unit, 2);
    stated[k] = (1 - assumed.light_scatter * assumed.light_scatter * light[k]) / (scale * scale);
    left[k] = simulated.row(row).squaredNorm() / kNoiseDraws;
    seen[k] = influence[row] * influence[row];
  }
  const double of_stated = (left * stated).sum();
  const Eigen::ArrayXd weight = light - (left * stated * light).sum() / of_stated;
  const double plain = seen.sum() / of_stated;
  const double excess = (weight * seen).sum(),
               chance = std::sqrt(2 * (weight * left * plain * stated).square().sum());
  if (excess <= kClearSigmas * chance || plain < 1) return;
  const double share = excess / (weight * left * light).sum();
  noise.light_scatter = std::sqrt(std::max(0.0, share));
  noise.channels[kPixels].scale =
      std::sqrt(std::max(kLeastOfStated * plain, plain - share * (left * light).sum() / of_stated));
}

/// What places differ by in parts, from how much more they scatter the less of them is seen.
double partScatter(const Saturated& saturated, const Linearization& linear) {
  std::vector<double> parts, seen;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    if (row.channel != kChannel<Pixels> || !(row.reflected > 0)) continue;
    parts.push_back(partVariance(row));
    seen.push_back(std::pow(saturated.left[static_cast<Eigen::Index>(i)], 2));
  }
  if (parts.size() < kFewestRows) return 0;
  const Eigen::Map<const Eigen::ArrayXd> x(parts.data(), std::ssize(parts)), y(seen.data(), std::ssize(seen));
  const Eigen::ArrayXd weight = x - x.mean();
  const double excess = (weight * y).sum(), chance = y.mean() * std::sqrt(2 * weight.square().sum());
  return excess > kClearSigmas * chance ? std::sqrt(excess / (weight * x).sum()) : 0;
}

/// Makes less of what is seen in part.
void takeParts(Linearization& linear, double parts) {
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(linear.residual.size());
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    double& own = factor[static_cast<Eigen::Index>(i)];
    own = 1 / std::sqrt(1 + parts * parts * partVariance(linear.rows[i]));
    linear.rows[i].per_unit *= own;
  }
  multiplyRows(linear, factor);
}

}  // namespace

NoiseModel shownNoise(Linearization linear, const NoiseModel& assumed, std::uint64_t seed) {
  NoiseModel noise = assumed.declared();
  std::unique_ptr<Saturated> saturated = saturate(linear, noise);
  // What readings that vary so much weigh, and with it how much that is, is known only once it is taken.
  noise.parts = 0;
  for (int round = 0; round < kPartRounds; ++round) {
    const double more = partScatter(*saturated, linear);
    if (more == 0) break;
    noise.parts = std::hypot(noise.parts, more);
    takeParts(linear, more);
    saturated = saturate(linear, noise);
  }
  const Eigen::VectorXd influence = influenceOf(saturated->left, linear);
  const auto rows = rowsByChannel(linear);
  Random random(seed);
  const Eigen::MatrixXd white = random.normals(saturated->left.size(), kNoiseDraws),
                        left_of_white = saturated->nuisances.project(white);

  std::array<double, kChannelCount> correlation{};
  std::array<bool, kChannelCount> is_correlated{};
  Eigen::MatrixXd simulated = left_of_white;
  for (int round = 0; round < kCorrelationRounds; ++round) {
    if (round > 0) simulated = saturated->nuisances.project(correlated(white, rows, correlation));
    for (std::size_t c = 0; c < rows.size(); ++c) {
      ChannelNoise& channel = noise.channels[c];
      channel.rows = rows[c].rows.size();
      if (channel.rows < kFewestRows) continue;
      const Moments seen = momentsOf(influence, rows[c]), expected = meanMoments(simulated, rows[c]);
      const double difference = seen.correlation() - expected.correlation();
      const bool counts_specks = static_cast<Channel>(c) == kChannel<Specks>;
      if (round == 0)
        is_correlated[c] = rows[c].pairs.size() >= kFewestRows &&
                           (counts_specks ? seen.square > kCounted * expected.square
                                          : std::abs(difference) >
                                                kClearSigmas / std::sqrt(static_cast<double>(channel.rows)));
      channel.correlation = correlation[c];
      // Numbers of specks scatter by Poisson's law, and where there are none they do not. But the same flakes
      // are seen in several images, in how many is told by how alike the numbers are.
      if (!counts_specks) {
        channel.scale = assumed.channels[c].independentScale() *
                        robustScale(saturated->left, linear, rows[c], std::max(expected.square, 1e-12));
        channel.freedom = expected.square;
      }
      if (is_correlated[c])
        correlation[c] =
            std::clamp(correlation[c] + difference, counts_specks ? 0.0 : -0.5, kLargestCorrelation);
    }
    if (std::none_of(is_correlated.begin(), is_correlated.end(), [](bool is) { return is; })) break;
  }
  noise.light_scatter = 0;
  splitLightNoise(influence, linear, rows[indexOf(kChannel<Pixels>)].rows, left_of_white, assumed, noise);
  return noise;
}

}  // namespace fathom
