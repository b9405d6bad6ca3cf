#include "diagnosis/residual_metrics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/covariate.h"

namespace fathom {

std::string metricOf(BatchChannel channel) {
  switch (channel) {
    case BatchChannel::markers:
      return "reprojection_rms_px";
    case BatchChannel::dvl:
      return "dvl_rms_mm_s";
    case BatchChannel::depth:
      return "depth_rms_mm";
    case BatchChannel::gyro:
      return "gyro_rms_deg_s";
    case BatchChannel::accelerometer:
      return "accelerometer_rms_mm_s2";
    case BatchChannel::attitude:
      return "attitude_rms_deg";
    case BatchChannel::usbl:
      return "usbl_rms_m";
    case BatchChannel::pixels:
      return "patch_rms_dn";
    case BatchChannel::edges:
      return "blur_rms_px2";
    case BatchChannel::specks:
      return "specks_rms_count";
    case BatchChannel::tie_points:
      return "contradiction_rms_sigma";
    case BatchChannel::prior:
      break;
  }
  return "";
}

std::vector<BatchChannel> channelsOf(const WhitenedModel& model, const Eigen::VectorXd& change) {
  const Eigen::VectorXd left = model.nuisances().project(change);
  std::map<BatchChannel, double> squares;
  for (std::size_t i = 0; i < model.linear().rows.size(); ++i)
    if (const BatchChannel channel = model.linear().rows[i].channel; channel != BatchChannel::prior)
      squares[channel] += left[static_cast<Eigen::Index>(i)] * left[static_cast<Eigen::Index>(i)];
  std::vector<BatchChannel> channels;
  for (const auto& [channel, square] : squares) channels.push_back(channel);
  std::stable_sort(channels.begin(), channels.end(),
                   [&](BatchChannel a, BatchChannel b) { return squares[a] > squares[b]; });
  return channels;
}

double printedUnit(const Linearization& linear, const NoiseModel& noise, BatchChannel channel) {
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
  return unit * unitOf(channel).scale * own.scale / own.independentScale();
}

}  // namespace fathom
