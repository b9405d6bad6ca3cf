#include "diagnosis/held_out.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/chi_square.h"
#include "core/progress.h"
#include "core/random.h"
#include "diagnosis/covariate.h"
#include "diagnosis/screening.h"

namespace fathom {
namespace {

constexpr double kRidge = 1e-4;  // of a column's length, where a stretch by itself says nothing
constexpr int kStretches = 3;    // of a fold, between those of others: an effect for a part is in most
constexpr int kParts = 2;        // of a stretch, that are drawn anew by the bootstrap
constexpr int kResamples = 1000;
constexpr int kPlacebos = 20, kFloorDraws = 8;

/// The linearization with the effects' columns taken out of the nuisances: the residual is that without them.
Linearization withoutEffects(const Linearization& linear, const Eigen::SparseMatrix<double>& columns,
                             const Eigen::VectorXd& values) {
  Linearization bare = linear;
  bare.residual = linear.residual - columns * values;
  std::vector<Eigen::Triplet<double>> entries;
  int width = 0;
  bare.blocks.clear();
  for (UnknownBlock block : linear.blocks) {
    if (block.kind == UnknownBlock::Kind::effect) continue;
    for (int k = 0; k < block.size; ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator e(linear.J, block.column + k); e; ++e)
        entries.emplace_back(static_cast<int>(e.row()), width + k, e.value());
    block.column = width;
    width += block.size;
    bare.blocks.push_back(block);
  }
  bare.J.resize(linear.J.rows(), width);
  bare.J.setFromTriplets(entries.begin(), entries.end());
  for (EffectColumn& column : bare.columns) column.estimated = false;
  return bare;
}

/// Splines over the covariates (of first order: how far readings are off in each bin), every direction.
Eigen::SparseMatrix<double> blackBox(const Linearization& linear, const std::vector<BatchChannel>& channels,
                                     std::vector<double>& sigma) {
  std::vector<Eigen::Triplet<double>> entries;
  int column = 0;
  for (const BatchChannel channel : channels) {
    const double unit = noiseUnit(linear, channel);
    for (const Direction& direction : directionsOf(linear, channel))
      for (const Covariate& covariate : covariatesOf(linear, channel)) {
        if (covariate.name == "time") continue;  // another stretch is another time
        const std::vector<double> limits = binLimits(linear, channel, covariate);
        for (std::size_t i = 0; i < linear.rows.size(); ++i)
          if (linear.rows[i].channel == channel && direction.values[i] != 0)
            entries.emplace_back(static_cast<int>(i),
                                 column + static_cast<int>(binOf(limits, covariate.of(linear.rows[i]))),
                                 direction.values[i]);
        column += static_cast<int>(limits.size() - 1);
        sigma.resize(static_cast<std::size_t>(column), unit);
      }
  }
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), column);
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

/// Some of the rows by themselves, with all columns that are tested: projected.
struct Part {
  std::vector<Eigen::Index> rows;  // of the model
  Eigen::VectorXd residual;        // P r
  Eigen::MatrixXd columns;         // P C
  Eigen::MatrixXd noise;           // P of simulated white noise
};

/// The nuisances of some rows, each held a little: a stretch by itself may not determine them all.
Nuisances nuisancesOf(const Eigen::SparseMatrix<double>& J, const std::vector<Eigen::Index>& rows) {
  std::vector<int> place(static_cast<std::size_t>(J.rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k)
    place[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> lengths;
  for (Eigen::Index c = 0; c < J.outerSize(); ++c) {
    const int column = static_cast<int>(lengths.size());
    double square = 0;
    for (Eigen::SparseMatrix<double>::InnerIterator e(J, c); e; ++e) {
      if (place[static_cast<std::size_t>(e.row())] < 0) continue;
      entries.emplace_back(place[static_cast<std::size_t>(e.row())], column, e.value());
      square += e.value() * e.value();
    }
    if (square > 0) lengths.push_back(std::sqrt(square));
  }
  const int first = static_cast<int>(rows.size()), width = static_cast<int>(lengths.size());
  for (int c = 0; c < width; ++c)
    entries.emplace_back(first + c, c, kRidge * lengths[static_cast<std::size_t>(c)]);
  Eigen::SparseMatrix<double> own(first + width, width);
  own.setFromTriplets(entries.begin(), entries.end());
  return Nuisances(own);
}

Part partOf(const WhitenedModel& model, std::vector<Eigen::Index> rows, const Eigen::MatrixXd& columns,
            const Eigen::MatrixXd& noise) {
  const Nuisances nuisances = nuisancesOf(model.nuisances().J(), rows);
  const auto projected = [&](const Eigen::MatrixXd& all) {
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(nuisances.J().rows(), all.cols());
    own.topRows(std::ssize(rows)) = all(rows, Eigen::all);
    return Eigen::MatrixXd(nuisances.project(own).topRows(std::ssize(rows)));
  };
  Part part;
  part.residual = projected(model.residual());
  part.columns = projected(columns);
  part.noise = projected(noise);
  part.rows = std::move(rows);
  return part;
}

Eigen::VectorXd fit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual,
                    const Eigen::VectorXd& sigma) {
  if (columns.cols() == 0) return {};
  Eigen::MatrixXd A = columns.transpose() * columns;
  A.diagonal() += sigma.array().square().inverse().matrix();
  return -A.ldlt().solve(columns.transpose() * residual);
}

/// Sums over a piece of a held-out stretch.
struct Piece {
  struct Sums {
    double before = 0, after = 0, black_box = 0, floor = 0;
    std::size_t rows = 0;
  };
  std::map<BatchChannel, Sums> channels;
  double physics = 0, black_box = 0;  // gains
};

std::array<double, 2> central95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return {at(0.025), at(0.975)};
}

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
    case BatchChannel::prior:
      break;
  }
  return "";
}

/// What a unit of residual is in the reading's own unit, as the residuals have it.
double rawPerUnit(const Linearization& linear, BatchChannel channel) {
  double raw = 0, residual = 0;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == channel) {
      raw += linear.rows[i].raw * linear.rows[i].raw;
      residual +=
          linear.residual[static_cast<Eigen::Index>(i)] * linear.residual[static_cast<Eigen::Index>(i)];
    }
  return residual > 0 ? std::sqrt(raw / residual) : 0;
}

/// Which channels the effects act on, those they change most first.
std::vector<BatchChannel> channelsOf(const Linearization& linear, const Eigen::VectorXd& change) {
  std::map<BatchChannel, double> squares;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel != BatchChannel::prior)
      squares[linear.rows[i].channel] +=
          change[static_cast<Eigen::Index>(i)] * change[static_cast<Eigen::Index>(i)];
  std::vector<BatchChannel> channels;
  for (const auto& [channel, square] : squares) channels.push_back(channel);
  std::stable_sort(channels.begin(), channels.end(),
                   [&](BatchChannel a, BatchChannel b) { return squares[a] > squares[b]; });
  return channels;
}

/// The best of all candidates on each draw of noise, and what it gains on stretches it was not trained on.
class Placebo {
 public:
  Placebo(std::vector<Eigen::Index> first, std::vector<Eigen::Index> size, Eigen::VectorXd sigma)
      : first_(std::move(first)), size_(std::move(size)), sigma_(std::move(sigma)) {}

  /// `columns`: where the candidates' are among the parts'.
  void add(const Part& train, const Part& test, Eigen::Index column) {
    Fold fold;
    const auto own = [&](const Part& part) { return part.columns.middleCols(column, sigma_.size()); };
    fold.A_train = own(train).transpose() * own(train);
    fold.A_test = own(test).transpose() * own(test);
    fold.g_train = own(train).transpose() * train.noise.leftCols(kPlacebos);
    fold.g_test = own(test).transpose() * test.noise.leftCols(kPlacebos);
    folds_.push_back(std::move(fold));
  }

  double percentile95() const {
    std::vector<double> gains;
    for (Eigen::Index draw = 0; draw < kPlacebos && !folds_.empty(); ++draw) {
      double best_evidence = -1e300, gain = 0;
      for (std::size_t c = 0; c < first_.size(); ++c) {
        const double evidence = evidenceOf(c, draw);
        if (evidence <= best_evidence) continue;
        best_evidence = evidence;
        gain = gainOf(c, draw);
      }
      gains.push_back(gain);
    }
    if (gains.empty()) return 0;
    std::sort(gains.begin(), gains.end());
    return gains[gains.size() * 95 / 100];
  }

 private:
  struct Fold {
    Eigen::MatrixXd A_train, A_test, g_train, g_test;
  };
  double evidenceOf(std::size_t c, Eigen::Index draw) const {
    const Eigen::Index k = first_[c], n = size_[c];
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    for (const Fold& fold : folds_) {
      A += fold.A_test.block(k, k, n, n);
      g += fold.g_test.col(draw).segment(k, n);
    }
    return support(A, g, sigma_.segment(k, n));
  }
  double gainOf(std::size_t c, Eigen::Index draw) const {
    const Eigen::Index k = first_[c], n = size_[c];
    double gain = 0;
    for (const Fold& fold : folds_) {
      Eigen::MatrixXd A = fold.A_train.block(k, k, n, n);
      A.diagonal() += sigma_.segment(k, n).array().square().inverse().matrix();
      const Eigen::VectorXd value = -A.ldlt().solve(fold.g_train.col(draw).segment(k, n));
      gain -= fold.g_test.col(draw).segment(k, n).dot(value) +
              0.5 * value.dot(fold.A_test.block(k, k, n, n) * value);
    }
    return gain;
  }
  std::vector<Eigen::Index> first_, size_;
  Eigen::VectorXd sigma_;
  std::vector<Fold> folds_;
};

Eigen::VectorXd priorSigmas(const Linearization& linear, const std::vector<Candidate>& candidates) {
  std::vector<double> sigmas;
  for (const Candidate& candidate : candidates)
    for (const std::size_t c : columnsOf(linear, candidate.effect))
      sigmas.push_back(linear.columns[c].prior_sigma);
  return Eigen::Map<Eigen::VectorXd>(sigmas.data(), std::ssize(sigmas));
}

/// What is left of a held-out stretch with all effects but one, whose columns come first.
Eigen::VectorXd leftWithout(const Linearization& linear, const std::vector<Candidate>& effects,
                            std::size_t one, const Part& train, const Part& test) {
  std::vector<Eigen::Index> others;
  std::vector<double> sigmas;
  Eigen::Index column = 0;
  for (std::size_t e = 0; e < effects.size(); ++e)
    for (const std::size_t c : columnsOf(linear, effects[e].effect)) {
      if (e != one) {
        others.push_back(column);
        sigmas.push_back(linear.columns[c].prior_sigma);
      }
      ++column;
    }
  if (others.empty()) return test.residual;
  const Eigen::VectorXd value = fit(train.columns(Eigen::all, others), train.residual,
                                    Eigen::Map<Eigen::VectorXd>(sigmas.data(), std::ssize(sigmas)));
  return test.residual + test.columns(Eigen::all, others) * value;
}

}  // namespace

HeldOutResult holdOut(const Linearization& linear, const std::vector<Candidate>& effects,
                      const EffectParameters<double>& values, const NoiseModel& noise, const BatchData& data,
                      const HeldOutOptions& options) {
  const Eigen::SparseMatrix<double> physics = columnsOf(linear, effects);
  Eigen::VectorXd found(physics.cols());
  Eigen::Index scalar = 0;
  for (const Candidate& effect : effects)
    for (const std::size_t c : columnsOf(linear, effect.effect))
      found[scalar++] = values.values[linear.columns[c].scalar];
  const WhitenedModel model(withoutEffects(linear, physics, found), noise, data);
  const Linearization& bare = model.linear();
  const std::vector<BatchChannel> channels = channelsOf(bare, physics * found);
  std::vector<BatchChannel> corrected;
  for (const BatchChannel channel : channels)
    if (corrected.empty() && options.yardsticks) corrected.push_back(channel);

  // All that is fitted, side by side: physics, black box, every candidate (for the placebo).
  std::vector<double> box_sigma;
  const Eigen::SparseMatrix<double> box = blackBox(bare, corrected, box_sigma);
  const std::vector<Candidate> all = options.yardsticks ? lastingCandidates(bare) : std::vector<Candidate>{};
  const Eigen::SparseMatrix<double> candidates = columnsOf(bare, all);
  Eigen::MatrixXd columns(model.residual().size(), physics.cols() + box.cols() + candidates.cols());
  columns << Eigen::MatrixXd(model.whitened(columnsOf(bare, effects))), Eigen::MatrixXd(model.whitened(box)),
      Eigen::MatrixXd(model.whitened(candidates));
  std::vector<Eigen::Index> first, size;
  Eigen::Index at = 0;
  for (const Candidate& candidate : all) {
    first.push_back(at);
    size.push_back(std::ssize(columnsOf(bare, candidate.effect)));
    at += size.back();
  }
  Placebo placebo(first, size, priorSigmas(bare, all));
  Random random(options.seed);
  Eigen::MatrixXd simulated(model.residual().size(), options.yardsticks ? kPlacebos : 0);
  for (Eigen::Index i = 0; i < simulated.size(); ++i) simulated.data()[i] = random.normal();

  const int stretch_count = options.folds * kStretches;
  const double span_s = (data.last_s - data.first_s) / stretch_count;
  const auto stretchOf = [&](double t_s) {
    return std::clamp(static_cast<int>((t_s - data.first_s) / span_s), 0, stretch_count - 1);
  };
  HeldOutGain gain;
  gain.by_effect.assign(effects.size(), 0);
  std::vector<Piece> pieces(static_cast<std::size_t>(stretch_count) * kParts);
  Progress progress("holding out");
  for (int fold = 0; fold < options.folds; ++fold) {
    progress.update(static_cast<double>(fold) / options.folds);
    std::vector<Eigen::Index> in_train, in_test;
    for (Eigen::Index i = 0; i < model.residual().size(); ++i) {
      const bool is_prior =
          i >= std::ssize(bare.rows) || bare.rows[static_cast<std::size_t>(i)].channel == BatchChannel::prior;
      const bool is_test =
          !is_prior && stretchOf(bare.rows[static_cast<std::size_t>(i)].t_s) % options.folds == fold;
      if (is_prior || is_test) in_test.push_back(i);
      if (!is_test) in_train.push_back(i);
    }
    const Part train = partOf(model, std::move(in_train), columns, simulated);
    const Part test = partOf(model, std::move(in_test), columns, simulated);
    if (options.yardsticks) placebo.add(train, test, physics.cols() + box.cols());
    const auto left = [&](Eigen::Index column, Eigen::Index count, const Eigen::VectorXd& sigma) {
      const Eigen::VectorXd value = fit(train.columns.middleCols(column, count), train.residual, sigma);
      return Eigen::VectorXd(test.residual + test.columns.middleCols(column, count) * value);
    };
    const Eigen::VectorXd after = left(0, physics.cols(), priorSigmas(bare, effects));
    for (std::size_t e = 0; e < effects.size(); ++e)
      gain.by_effect[e] +=
          0.5 * (leftWithout(bare, effects, e, train, test).squaredNorm() - after.squaredNorm());
    const Eigen::VectorXd black_box = left(
        physics.cols(), box.cols(), Eigen::Map<Eigen::VectorXd>(box_sigma.data(), std::ssize(box_sigma)));
    for (Eigen::Index row = 0; row < std::ssize(test.rows); ++row) {
      const auto i = static_cast<std::size_t>(test.rows[static_cast<std::size_t>(row)]);
      if (i >= bare.rows.size() || bare.rows[i].channel == BatchChannel::prior) continue;
      const double place = (bare.rows[i].t_s - data.first_s) / span_s * kParts;
      Piece& piece = pieces[static_cast<std::size_t>(
          std::clamp(static_cast<int>(place), 0, stretch_count * kParts - 1))];
      Piece::Sums& sums = piece.channels[bare.rows[i].channel];
      const double b = test.residual[row] * test.residual[row], a = after[row] * after[row],
                   x = black_box[row] * black_box[row];
      sums.before += b;
      sums.after += a;
      sums.black_box += x;
      if (options.yardsticks) sums.floor += test.noise.row(row).head(kFloorDraws).squaredNorm() / kFloorDraws;
      ++sums.rows;
      piece.physics += 0.5 * (b - a);
      piece.black_box += 0.5 * (b - x);
    }
  }

  HeldOutResult result;
  result.gain = gain;
  const auto rms = [&](const std::vector<const Piece*>& of, BatchChannel channel, double Piece::Sums::*what) {
    double sum = 0, rows = 0;
    for (const Piece* piece : of)
      if (const auto it = piece->channels.find(channel); it != piece->channels.end()) {
        sum += it->second.*what;
        rows += static_cast<double>(it->second.rows);
      }
    return rows > 0 ? std::sqrt(sum / rows) : 0.0;
  };
  std::vector<const Piece*> every;
  for (const Piece& piece : pieces)
    if (!piece.channels.empty()) every.push_back(&piece);
  std::map<BatchChannel, std::vector<double>> resampled;
  std::vector<double> gains, over_box;
  for (int resample = 0; resample < kResamples && !every.empty(); ++resample) {
    std::vector<const Piece*> drawn;
    double physics_gain = 0, over = 0;
    for (std::size_t k = 0; k < every.size(); ++k) {
      drawn.push_back(every[static_cast<std::size_t>(random.uniform() * static_cast<double>(every.size()))]);
      physics_gain += drawn.back()->physics;
      over += drawn.back()->physics - drawn.back()->black_box;
    }
    gains.push_back(physics_gain);
    over_box.push_back(over);
    for (const BatchChannel channel : channels)
      resampled[channel].push_back(rms(drawn, channel, &Piece::Sums::after));
  }
  for (const BatchChannel channel : channels) {
    HeldOut held;
    held.channel = channel;
    held.metric = metricOf(channel);
    // What is left is in units of noise: back into the reading's.
    const double unit = rawPerUnit(linear, channel) * unitOf(channel).scale * noise.of(channel).scale /
                        noise.of(channel).independentScale();
    held.before = unit * rms(every, channel, &Piece::Sums::before);
    held.after = unit * rms(every, channel, &Piece::Sums::after);
    held.black_box = unit * rms(every, channel, &Piece::Sums::black_box);
    held.noise_floor = unit * rms(every, channel, &Piece::Sums::floor);
    held.after_ci95 = central95(resampled[channel]);
    for (double& limit : held.after_ci95) limit *= unit;
    for (int stretch = 0; stretch < stretch_count; ++stretch) {
      std::vector<const Piece*> own;
      for (int part = 0; part < kParts; ++part)
        own.push_back(&pieces[static_cast<std::size_t>(stretch) * kParts + static_cast<std::size_t>(part)]);
      const double from_s = data.first_s + stretch * span_s;
      held.blocks.push_back({from_s, from_s + span_s, unit * rms(own, channel, &Piece::Sums::before),
                             unit * rms(own, channel, &Piece::Sums::after),
                             unit * rms(own, channel, &Piece::Sums::black_box)});
    }
    result.channels.push_back(std::move(held));
  }
  for (const Piece* piece : every) {
    result.gain.physics += piece->physics;
    result.gain.black_box += piece->black_box;
  }
  if (!gains.empty()) {
    result.gain.physics_ci95 = central95(gains);
    result.gain.over_black_box_ci95 = central95(over_box);
  }
  result.gain.placebo = placebo.percentile95();
  return result;
}

}  // namespace fathom
