#include "tuning/innovation_score.h"

#include <cmath>
#include <numbers>

#include "core/chi_square.h"
#include "core/progress.h"

namespace fathom {

namespace {

/// As NIS within the gate, and beyond it as its root, in one line.
double huber(double nis, double gate) { return nis <= gate ? nis : 2.0 * std::sqrt(gate * nis) - gate; }

}  // namespace

void InnovationScore::add(const Innovation& innovation, double gate) {
  if (!(innovation.determinant > 0.0)) return;  // a pose that was set anew
  const double dof = innovation.degrees_of_freedom;
  log_likelihood -= 0.5 * (huber(innovation.nis, gate) + std::log(innovation.determinant) +
                           dof * std::log(2.0 * std::numbers::pi));
  ChannelScore& channel = channels[innovation.channel];
  channel.degrees_of_freedom = innovation.degrees_of_freedom;
  channel.nis_sum += std::min(innovation.nis, gate);
  ++channel.count;
  if (!innovation.fused) ++channel.gated;
}

Scores score(const TunedRecording& recording, const LocalizationOptions& options, const Blocks& blocks) {
  Scores scores;
  std::array<double, 7> gates{};
  for (std::size_t dof = 1; dof < gates.size(); ++dof)
    gates[dof] = chiSquareQuantile(static_cast<double>(dof), options.gate.probability);
  LocalizationSetup setup = recording.setup;
  setup.options = options;
  setup.options.smooth = false;
  setup.options.adapts_noise = false;
  LocalizationSink sink;
  double begin_s = 0.0, last_s = 0.0;
  bool begun = false;
  sink.innovation = [&](const Innovation& innovation) {
    if (!std::exchange(begun, true)) begin_s = innovation.t_s;
    const double t_s = innovation.t_s - begin_s;
    if (!blocks.counts(t_s)) return;
    (blocks.isJudged(t_s) ? scores.judged : scores.fit)
        .add(innovation, gates[static_cast<std::size_t>(innovation.degrees_of_freedom)]);
  };
  sink.estimate = [&](const Estimate& estimate) {
    if (last_s > 0.0) scores.regimes_s[options.regimes.of(estimate.state.motion)] += estimate.t_s - last_s;
    last_s = estimate.t_s;
  };
  Localizer localizer(setup, sink);
  for (const Sample& sample : recording.samples) {
    if (interrupted()) throw Interrupted{};
    localizer.add(sample);
  }
  localizer.finish();
  return scores;
}

}  // namespace fathom
