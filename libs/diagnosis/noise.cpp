#include "diagnosis/noise.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/chi_square.h"
#include "core/random.h"
#include "effects/catalogue.h"
#include "estimation/nuisances.h"

namespace fathom {
namespace {

constexpr int kNoiseDraws = 16;
constexpr int kCorrelationRounds = 5;
constexpr int kWeightRounds = 4;
constexpr std::size_t kFewestRows = 30;  // fewer show no noise of their own
constexpr double kClearSigmas = 4;       // from which on a correlation is more than chance
constexpr double kLargestCorrelation = 0.95;
constexpr std::size_t kFewestMarkers = 4;
constexpr int kPeaks = 16;  // over the recording: narrower ones are noise until they are found
constexpr double kLargestTolerance_m = 1.0;

/// Of an effect that comes and goes, whenever it may be: one peak beside another.
std::vector<Candidate> peaksOf(const Linearization& linear) {
  const auto [first_s, last_s] = readingsSpan(linear);
  const double spacing_s = std::max(1e-9, (last_s - first_s) / kPeaks);
  std::vector<Candidate> candidates;
  for (const EffectInfo& effect : allEffects()) {
    if (!hasPeak(effect) || isEstimated(linear, effect.index) || !canShow(linear, effect.index)) continue;
    for (int k = 0; k <= kPeaks; ++k) {
      Candidate candidate;
      candidate.effect = effect.index;
      candidate.peak = {first_s + k * spacing_s, spacing_s};
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

std::vector<Candidate> lastingOrPeaking(const Linearization& linear) {
  std::vector<Candidate> candidates = lastingCandidates(linear);
  const std::vector<Candidate> peaks = peaksOf(linear);
  candidates.insert(candidates.end(), peaks.begin(), peaks.end());
  return candidates;
}

/// The estimate with all these effects among its unknowns, each held by its prior.
struct Saturated {
  std::vector<Candidate> candidates;
  Nuisances nuisances;
  Eigen::VectorXd residual, left;  ///< before and after

  explicit Saturated(const Linearization& linear)
      : candidates(lastingOrPeaking(linear)),
        nuisances(withHeldColumns(linear.J, columnsOf(linear, candidates), priorSigmas(linear, candidates))),
        residual(Eigen::VectorXd::Zero(nuisances.J().rows())) {
    residual.head(linear.residual.size()) = linear.residual;
    left = nuisances.project(residual);
  }
};

/// What an effect explains is no outlier: a reading of light counts in full where it does once all may be
/// there. Else an effect that shows in all images would make light's noise seem small. (Where corners are off
/// by pixels, what explains them is far from linear, and which are outliers is not known.)
std::unique_ptr<Saturated> saturate(Linearization& linear) {
  auto saturated = std::make_unique<Saturated>(linear);
  for (int round = 0; round < kWeightRounds; ++round) {
    if (!applyOtherRobustWeights(linear, BatchChannel::pixels, saturated->left)) break;
    saturated = std::make_unique<Saturated>(linear);
  }
  return saturated;
}

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

/// How far a marker seems to lie elsewhere where its corners are that much off, m.
double cornerBias_m(const Linearization& linear) {
  double square = 0, count = 0;
  // The offset's axes in the panel's face; the marker's id is before them.
  for (const std::size_t axis : {1u, 2u}) {
    const Eigen::Index column = columnOf(linear, kEffectIndex<MarkerMoved>, axis);
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].marker_id >= 0) {
        square += std::pow(linear.C(static_cast<Eigen::Index>(i), column) / linear.rows[i].per_unit, 2);
        count += 0.5;  // each coordinate has its share of either axis
      }
  }
  return square > 0 ? lastingBias(BatchChannel::markers) / std::sqrt(square / count) : 0;
}

/// What an axis of the markers' places scatters by beyond their own uncertainty. The one marker that is most
/// off does not count: it may have been moved.
double panelTolerance(const Saturated& saturated, const Linearization& linear) {
  std::vector<Eigen::Index> offsets;
  Eigen::Index column = linear.J.cols();
  for (const Candidate& candidate : saturated.candidates) {
    if (candidate.effect == kEffectIndex<MarkerMoved>)
      for (Eigen::Index axis = 0; axis < 3; ++axis) offsets.push_back(column + axis);
    column += std::ssize(columnsOf(linear, candidate.effect));
  }
  if (offsets.size() < 3 * kFewestMarkers) return 0;
  const Eigen::VectorXd x = saturated.nuisances.step(saturated.residual)(offsets);
  const Eigen::MatrixXd covariance = saturated.nuisances.covariance(offsets);
  const auto statistic = [&](double sigma_m, std::optional<Eigen::Index> but) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!but || i / 3 != *but) kept.push_back(i);
    Eigen::MatrixXd S = covariance(kept, kept);
    S.diagonal().array() += sigma_m * sigma_m;
    const Eigen::VectorXd own = x(kept);
    return own.dot(S.ldlt().solve(own));
  };
  Eigen::Index most = 0;
  for (Eigen::Index marker = 1; marker < x.size() / 3; ++marker)
    if (statistic(0, marker) < statistic(0, most)) most = marker;
  const auto dof = static_cast<double>(x.size() - 3);
  if (statistic(0, most) <= chiSquareQuantile(dof, 0.999)) return 0;
  double low = 0, high = kLargestTolerance_m;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (statistic(middle, most) > dof ? low : high) = middle;
  }
  return high;
}

}  // namespace

double lastingBias(BatchChannel channel) {
  if (channel == BatchChannel::markers) return 0.005;
  return channel == BatchChannel::edges ? 0.01 : 0;
}

double ChannelNoise::independentScale() const {
  return scale * std::sqrt((1 + correlation) / (1 - correlation));
}

std::array<double, kBatchChannels.size()> NoiseModel::noiseScale() const {
  std::array<double, kBatchChannels.size()> scales{};
  for (std::size_t c = 0; c < scales.size(); ++c) scales[c] = channels[c].independentScale();
  return scales;
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
  const std::unique_ptr<Saturated> saturated = saturate(linear);
  const auto rows = rowsByChannel(linear);
  const Eigen::VectorXd& left = saturated->left;
  Random random(seed);
  const Eigen::MatrixXd white = random.normals(left.size(), kNoiseDraws);

  NoiseModel noise = assumed;
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
  noise.panel_tolerance_m = std::max(cornerBias_m(linear), panelTolerance(*saturated, linear));
  return noise;
}

}  // namespace fathom
