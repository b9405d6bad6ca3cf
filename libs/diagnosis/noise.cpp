#include "diagnosis/noise.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "diagnosis/saturated.h"

namespace fathom {
namespace {

constexpr int kNoiseDraws = 16;
constexpr int kCorrelationRounds = 5;
constexpr std::size_t kFewestRows = 30;  // fewer show no noise of their own
constexpr double kClearSigmas = 4;       // from which on a correlation is more than chance
constexpr double kLargestCorrelation = 0.95;
constexpr double kLeastOfStated = 0.01;  // of the variance of light: a mean of rounded numbers is no better

/// Sums over a channel of squares and of neighbours' products.
struct Moments {
  double square = 0, product = 0;
  double correlation() const { return square > 0 ? product / square : 0; }
};

using Pairs = std::vector<std::array<std::size_t, 2>>;

Moments momentsOf(const Eigen::Ref<const Eigen::VectorXd>& r, const std::vector<std::size_t>& rows,
                  const Pairs& pairs) {
  Moments moments;
  for (const std::size_t i : rows)
    moments.square += r[static_cast<Eigen::Index>(i)] * r[static_cast<Eigen::Index>(i)];
  for (const auto& [a, b] : pairs)
    moments.product += r[static_cast<Eigen::Index>(a)] * r[static_cast<Eigen::Index>(b)];
  if (!pairs.empty()) moments.product *= static_cast<double>(rows.size()) / static_cast<double>(pairs.size());
  return moments;
}

struct ChannelRows {
  std::vector<std::size_t> rows;
  Pairs pairs;
};

std::array<ChannelRows, kBatchChannels.size()> rowsByChannel(const Linearization& linear) {
  std::array<ChannelRows, kBatchChannels.size()> channels;
  for (const BatchChannel channel : kBatchChannels) {
    auto& own = channels[static_cast<std::size_t>(channel)];
    if (channel == BatchChannel::prior) continue;
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].channel == channel) own.rows.push_back(i);
    own.pairs = neighbours(linear, channel);
  }
  return channels;
}

/// White noise made into that of first-order autoregressions, sigma one.
Eigen::MatrixXd correlated(Eigen::MatrixXd noise, const std::array<ChannelRows, kBatchChannels.size()>& rows,
                           const std::array<double, kBatchChannels.size()>& correlation) {
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
/// counts what rounding does to dark places, which lasts, and is not to be made less of.
void splitLightNoise(const Saturated& saturated, const Linearization& linear,
                     const std::vector<std::size_t>& rows, const Eigen::MatrixXd& white,
                     const NoiseModel& assumed, NoiseModel& noise) {
  constexpr auto kPixels = static_cast<std::size_t>(BatchChannel::pixels);
  if (rows.size() < kFewestRows) return;
  const Eigen::MatrixXd simulated = saturated.nuisances.project(white);
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
    seen[k] = saturated.left[row] * saturated.left[row];
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

}  // namespace

double lastingBias(BatchChannel channel) {
  if (channel == BatchChannel::markers) return 0.005;
  return channel == BatchChannel::edges ? 0.01 : 0;
}

double ChannelNoise::independentScale() const {
  return scale * std::sqrt((1 + correlation) / (1 - correlation));
}

void NoiseModel::applyTo(ProblemOptions& options) const {
  for (std::size_t c = 0; c < channels.size(); ++c) options.noise_scale[c] = channels[c].independentScale();
  options.light_scatter = light_scatter;
}

std::set<int> markersOf(const Linearization& linear) {
  std::set<int> ids;
  for (const RowInfo& row : linear.rows)
    if (row.marker_id >= 0) ids.insert(row.marker_id);
  return ids;
}

std::vector<Candidate> lastingCandidates(const Linearization& linear) {
  const std::set<int> ids = markersOf(linear);
  std::vector<Candidate> candidates;
  for (const EffectInfo& effect : allEffects()) {
    if (isEstimated(linear, effect.index) || effect.has(ParameterKind::time) || hasPeak(effect)) continue;
    Candidate candidate{.effect = effect.index, .marker_id = {}, .time_s = {}, .peak = {}, .active_s = {}};
    if (!effect.has(ParameterKind::marker_id)) candidates.push_back(candidate);
    for (const int id : ids)
      if (effect.has(ParameterKind::marker_id)) {
        candidate.marker_id = id;
        candidates.push_back(candidate);
      }
  }
  return candidates;
}

std::vector<std::array<std::size_t, 2>> neighbours(const Linearization& linear, BatchChannel channel) {
  std::vector<std::array<std::size_t, 2>> pairs;
  for (const auto& track : linear.tracks) {
    if (track.size() < 2 || linear.rows[track[0]].channel != channel) continue;
    std::vector<double> spacings;
    for (std::size_t k = 1; k < track.size(); ++k)
      spacings.push_back(linear.rows[track[k]].t_s - linear.rows[track[k - 1]].t_s);
    std::vector<double> sorted = spacings;
    std::nth_element(sorted.begin(), sorted.begin() + std::ssize(sorted) / 2, sorted.end());
    const double longest_s = 1.5 * sorted[sorted.size() / 2];
    for (std::size_t k = 1; k < track.size(); ++k)
      if (spacings[k - 1] <= longest_s) pairs.push_back({track[k - 1], track[k]});
  }
  return pairs;
}

NoiseModel shownNoise(Linearization linear, const NoiseModel& assumed, std::uint64_t seed) {
  std::unique_ptr<Saturated> saturated = saturate(linear);
  NoiseModel noise = assumed;
  noise.print = printScatter(*saturated, linear);
  if (noise.print.isSeen()) saturated = saturate(linear, noise.print);
  noise.markers = markerScatter(*saturated, linear);
  const auto rows = rowsByChannel(linear);
  const Eigen::VectorXd& left = saturated->left;
  Random random(seed);
  const Eigen::MatrixXd white = random.normals(left.size(), kNoiseDraws);

  std::array<double, kBatchChannels.size()> correlation{};
  std::array<bool, kBatchChannels.size()> is_correlated{};
  for (int round = 0; round < kCorrelationRounds; ++round) {
    const Eigen::MatrixXd simulated = saturated->nuisances.project(correlated(white, rows, correlation));
    for (std::size_t c = 0; c < rows.size(); ++c) {
      ChannelNoise& channel = noise.channels[c];
      channel.rows = rows[c].rows.size();
      // Numbers of specks scatter by Poisson's law, and where there are none they do not.
      if (channel.rows < kFewestRows || static_cast<BatchChannel>(c) == BatchChannel::specks) continue;
      const Moments seen = momentsOf(left, rows[c].rows, rows[c].pairs);
      Moments expected;
      for (Eigen::Index d = 0; d < kNoiseDraws; ++d) {
        const Moments draw = momentsOf(simulated.col(d), rows[c].rows, rows[c].pairs);
        expected.square += draw.square / kNoiseDraws;
        expected.product += draw.product / kNoiseDraws;
      }
      const double difference = seen.correlation() - expected.correlation();
      if (round == 0)
        is_correlated[c] = rows[c].pairs.size() >= kFewestRows &&
                           std::abs(difference) > kClearSigmas / std::sqrt(static_cast<double>(channel.rows));
      channel.scale =
          assumed.channels[c].independentScale() * std::sqrt(seen.square / std::max(expected.square, 1e-12));
      channel.correlation = correlation[c];
      channel.freedom = expected.square;
      if (is_correlated[c])
        correlation[c] = std::clamp(correlation[c] + difference, -0.5, kLargestCorrelation);
    }
  }
  noise.light_scatter = 0;
  splitLightNoise(*saturated, linear, rows[static_cast<std::size_t>(BatchChannel::pixels)].rows, white,
                  assumed, noise);
  return noise;
}

}  // namespace fathom
