#include "diagnosis/residual_metrics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/stable_sort.h"
#include "diagnosis/covariate.h"

namespace fathom {

std::vector<Channel> channelsOf(const WhitenedModel& model, const Eigen::VectorXd& change) {
  const Eigen::VectorXd left = model.nuisances().project(change);
  std::map<Channel, double> squares;
  for (std::size_t i = 0; i < model.linear().rows.size(); ++i)
    if (const Channel channel = model.linear().rows[i].channel; channel != kChannel<Prior>)
      squares[channel] += left[static_cast<Eigen::Index>(i)] * left[static_cast<Eigen::Index>(i)];
  std::vector<Channel> channels;
  for (const auto& [channel, square] : squares) channels.push_back(channel);
  stableSort(channels, [&](Channel a, Channel b) { return squares[a] > squares[b]; });
  return channels;
}

double printedUnit(const Linearization& linear, const NoiseModel& noise, Channel channel) {
  double raw = 0, residual = 0;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == channel && linear.rows[i].robust_weight == 1) {
      raw += linear.rows[i].raw * linear.rows[i].raw;
      residual +=
          linear.residual[static_cast<Eigen::Index>(i)] * linear.residual[static_cast<Eigen::Index>(i)];
    }
  // Where the nominal model is far off, no reading may have its full weight.
  const double unit = residual > 0 ? std::sqrt(raw / residual) : noiseUnit(linear, channel);
  const ChannelNoise& own = noise.of(channel);
  return unit * textOf(channel).scale * own.scale / own.independentScale();
}

}  // namespace fathom
