#include "tuning/innovation_score.h"

#include <cmath>
#include <numbers>

#include "core/chi_square.h"
#include "core/progress.h"

namespace fathom {

namespace {

/// Of the filter's gate here: wide enough that only nonsense meets it. A reading that passes or does not by a
/// hair's breadth moves all that follow, and the log likelihood by a hundred: no slope could be taken. Where
/// the usual gate lies, an innovation begins to count less (huber).
constexpr double kWideGate = 1.0 - 1e-12;

/// As NIS within the gate, and beyond it as its root, in one line.
double huber(double nis, double gate) { return nis <= gate ? nis : 2.0 * std::sqrt(gate * nis) - gate; }

}  // namespace

void ChannelScore::add(double t_s, double nis) {
  nis_sum += nis;
  ++count;
  if (const auto second = static_cast<long>(t_s); second != second_) {
    square_ += of_second_ * of_second_;
    product_ += of_second_ * readings_;
    readings_square_ += readings_ * readings_;
    all_ += readings_;
    second_ = second;
    of_second_ = readings_ = 0.0;
  }
  of_second_ += nis;
  ++readings_;
}

double ChannelScore::unevenness() const {
  const double mean = nisMean();
  if (!(all_ > 0.0) || !(mean > 0.0)) return 1.0;
  const double by_chance = 2.0 * mean * mean / degrees_of_freedom * all_;
  return (square_ - 2.0 * mean * product_ + mean * mean * readings_square_) / by_chance;
}

void InnovationScore::add(const Innovation& innovation, double gate) {
  if (!(innovation.determinant > 0.0)) return;  // a pose that was set anew
  const double dof = innovation.degrees_of_freedom;
  log_likelihood -= 0.5 * (huber(innovation.nis, gate) + std::log(innovation.determinant) +
                           dof * std::log(2.0 * std::numbers::pi));
  ChannelScore& channel = channels[innovation.channel];
  channel.degrees_of_freedom = innovation.degrees_of_freedom;
  channel.add(innovation.t_s, std::min(innovation.nis, gate));
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
  setup.options.gate.probability = std::max(options.gate.probability, kWideGate);
  LocalizationSink sink;
  double begin_s = 0.0, last_s = 0.0;
  bool begun = false;
  sink.innovation = [&](const Innovation& innovation) {
    if (!std::exchange(begun, true)) begin_s = innovation.t_s;
    const double t_s = innovation.t_s - begin_s;
    if (!blocks.counts(t_s)) return;
    const double gate = gates[static_cast<std::size_t>(innovation.degrees_of_freedom)];
    if (blocks.isJudged(t_s)) return scores.judged.add(innovation, gate);
    const double before = scores.fit.log_likelihood;
    scores.fit.add(innovation, gate);
    const auto part = static_cast<std::size_t>(t_s / Scores::kPart_s);
    if (part >= scores.fit_parts.size()) scores.fit_parts.resize(part + 1, 0.0);
    scores.fit_parts[part] += scores.fit.log_likelihood - before;
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
