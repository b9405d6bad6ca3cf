#include "diagnosis/held_out.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "core/progress.h"
#include "core/random.h"
#include "diagnosis/bare.h"
#include "diagnosis/black_box.h"
#include "diagnosis/constants.h"
#include "diagnosis/placebo.h"
#include "diagnosis/residual_metrics.h"
#include "diagnosis/stretches.h"
#include "effects/catalogue.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

/// Columns of what is left of a fold's rows; then one without each effect, what each changes by itself, and
/// draws of noise.
constexpr Eigen::Index kBefore = 0, kAfter = 1, kBlackBox = 2, kFirstWithout = 3;

/// Sums over a piece of a held-out stretch.
struct Piece {
  struct Sums {
    double before = 0, after = 0, black_box = 0, floor = 0;
    std::size_t rows = 0;
  };
  std::map<Channel, Sums> channels;
  double physics = 0, black_box = 0;  // gains
};

std::array<double, 2> central95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return {at(0.025), at(0.975)};
}

/// Columns that are fitted together, among all.
struct Fitted {
  std::vector<Eigen::Index> columns;
  Eigen::VectorXd sigma;
  std::vector<bool> is_positive;  // none: any can be less than nothing
};

/// Fold by fold: the physics and its yardsticks trained on all stretches but its own, and what is left there.
class HoldOut {
 public:
  HoldOut(const Linearization& linear, const std::vector<Candidate>& effects, const BatchState& found,
          const NoiseModel& noise, const BatchData& data, const HeldOutOptions& options);
  HeldOutResult run();

 private:
  /// What effects gain on one fold; its pieces are nobody else's.
  HeldOutGain holdOutFold(int fold);
  /// What is best where the reduction is from.
  Eigen::VectorXd valuesOf(const Fitted& what, const Reduced& trained) const {
    return fitted(trained.gram(what.columns, what.columns), trained.score(what.columns), what.sigma,
                  what.is_positive);
  }
  /// The same, but what is drawn for each image is found in each, held out or not: a part by itself could not
  /// tell what all of its draws have in common from how bright all is.
  Eigen::VectorXd valuesWithDraws(const Fitted& what, const Reduced& trained) const;
  Eigen::VectorXd changeBy(const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& values) const;
  void add(const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& left);
  void shareOut(const HeldOutGain& gain, const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& left);
  bool isPrior(Eigen::Index row) const {
    return row >= std::ssize(bare_.rows) ||
           bare_.rows[static_cast<std::size_t>(row)].channel == kChannel<Prior>;
  }
  Piece& pieceOf(const RowInfo& row) { return pieces_[static_cast<std::size_t>(stretches_.partOf(row))]; }
  std::vector<Eigen::Index> columnsOf(std::size_t effect) const;
  /// Columns of all effects, or of all but one.
  Fitted physics(std::optional<std::size_t> but) const;
  void resample(HeldOutResult& result, std::map<Channel, std::vector<double>>& rms);
  HeldOut summary(Channel channel, const std::vector<double>& resampled) const;

  const Linearization& linear_;
  const std::vector<Candidate>& effects_;
  const NoiseModel& noise_;
  HeldOutOptions options_;
  Bare without_;
  Eigen::VectorXd sigma_;  // what the effects' values may be off by
  WhitenedModel model_;
  const Linearization& bare_;
  std::vector<Channel> channels_;  // that the effects act on, those they change most first
  Stretches stretches_;
  Random random_;
  Eigen::SparseMatrix<double> columns_;        // physics, black box
  std::vector<bool> is_draw_, is_positive_;    // of those of physics
  std::vector<Eigen::Index> first_column_{0};  // of each effect, and the one behind the last
  std::optional<Reduced> whole_;               // of all rows, where something is drawn
  Fitted box_;
  Eigen::MatrixXd simulated_;
  std::optional<Placebo> placebo_;
  std::vector<Piece> pieces_;
  std::vector<const Piece*> filled_;
};

/// Of a peak's time at most as far from the one found as it is wide: beyond that its columns, which were
/// taken there, tell nothing. What is drawn for each image scatters as it was found to: with the prior, which
/// is far wider, what a few images cannot tell from the water would be noise.
Eigen::VectorXd trainedSigmas(const Linearization& linear, const std::vector<Candidate>& effects,
                              const BatchState& found) {
  Eigen::VectorXd sigma = priorSigmas(linear, effects);
  Eigen::Index column = 0;
  for (const Candidate& effect : effects)
    for (const CandidateColumn& c : columnsOf(linear, effect.effect)) {
      double& own = sigma[column++];
      if (parameterOf(linear.columns[c.column].scalar).kind == ParameterKind::peak_time)
        own = std::min(own, peakOf(found.effects, effect.effect).width_s);
      const double scatter = found.effects.values[linear.columns[c.column].scalar];
      if (c.image >= 0 && scatter > 0) own = std::min(own, scatter);
    }
  return sigma;
}

HoldOut::HoldOut(const Linearization& linear, const std::vector<Candidate>& effects, const BatchState& found,
                 const NoiseModel& noise, const BatchData& data, const HeldOutOptions& options)
    : linear_(linear),
      effects_(effects),
      noise_(noise),
      options_(options),
      without_(bareOf(linear, effects, found)),
      model_(withoutEffects(linear, without_), noise),
      bare_(model_.linear()),
      stretches_(data, options.folds),
      random_(options.seed),
      pieces_(static_cast<std::size_t>(stretches_.count()) * kPartsOfStretch) {
  sigma_ = trainedSigmas(bare_, effects, found);
  columns_ = model_.whitened(fathom::columnsOf(bare_, effects));
  channels_ = channelsOf(model_, columns_ * without_.values);
  for (const Candidate& effect : effects) {
    for (const CandidateColumn& c : fathom::columnsOf(bare_, effect.effect)) {
      is_draw_.push_back(c.image >= 0);
      is_positive_.push_back(c.image < 0 && parameterOf(bare_.columns[c.column].scalar).positive);
    }
    first_column_.push_back(std::ssize(is_draw_));
  }
  if (std::find(is_draw_.begin(), is_draw_.end(), true) != is_draw_.end())
    whole_ = model_.nuisances().reduce(columns_, model_.residual());
  simulated_ = random_.normals(model_.residual().size(), options.yardsticks ? kPlacebos : 0);
  if (!options.yardsticks) return;
  placebo_.emplace(model_, simulated_, options.folds);
  // A physics-free correction of the readings that the effects change most.
  const BlackBox black_box(bare_, channels_.front());
  const Eigen::SparseMatrix<double> box = model_.whitened(black_box.columns(bare_));
  for (Eigen::Index c = 0; c < box.cols(); ++c) box_.columns.push_back(columns_.cols() + c);
  box_.sigma = black_box.priorSigma();
  columns_ = sideBySide(columns_, box);
}

std::vector<Eigen::Index> HoldOut::columnsOf(std::size_t effect) const {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index c = first_column_[effect]; c < first_column_[effect + 1]; ++c) columns.push_back(c);
  return columns;
}

Fitted HoldOut::physics(std::optional<std::size_t> but) const {
  Fitted what;
  for (std::size_t e = 0; e < effects_.size(); ++e)
    if (const std::vector<Eigen::Index> own = columnsOf(e); e != but)
      what.columns.insert(what.columns.end(), own.begin(), own.end());
  what.sigma = sigma_(what.columns);
  for (const Eigen::Index c : what.columns)
    what.is_positive.push_back(is_positive_[static_cast<std::size_t>(c)]);
  return what;
}

HeldOutGain HoldOut::holdOutFold(int fold) {
  std::vector<Eigen::Index> in_train, in_test;
  for (Eigen::Index i = 0; i < model_.residual().size(); ++i) {
    const bool is_test = !isPrior(i) && stretches_.foldOf(bare_.rows[static_cast<std::size_t>(i)]) == fold;
    if (options_.yardsticks && (is_test || isPrior(i))) in_test.push_back(i);
    if (!is_test) in_train.push_back(i);
  }
  const RowsAlone train(model_, std::move(in_train));
  std::optional<RowsAlone> test;
  if (options_.yardsticks) test.emplace(model_, std::move(in_test));
  if (placebo_) placebo_->take(fold, train);
  const Reduced trained = train.reduce(columns_);
  const Fitted all = physics({});
  const Eigen::VectorXd all_values = valuesWithDraws(all, trained);
  const Eigen::Index floor_draws = placebo_ ? kFloorDraws : 0, count = std::ssize(effects_),
                     first_alone = kFirstWithout + count, behind = first_alone + count;
  Eigen::MatrixXd with(model_.residual().size(), behind + floor_draws);
  with.col(kBefore) = model_.residual();
  with.col(kAfter) = model_.residual() + changeBy(all.columns, all_values);
  with.col(kBlackBox) = model_.residual() + changeBy(box_.columns, valuesOf(box_, trained));
  with.rightCols(floor_draws) = simulated_.leftCols(floor_draws);
  for (Eigen::Index e = 0; e < count; ++e) {
    const Fitted rest = physics(static_cast<std::size_t>(e));
    with.col(kFirstWithout + e) = model_.residual() + changeBy(rest.columns, valuesWithDraws(rest, trained));
    const std::vector<Eigen::Index> own = columnsOf(static_cast<std::size_t>(e));
    with.col(first_alone + e) = changeBy(own, all_values(own));
  }
  // Of the likelihood of what is held out, given what is not: p(all) / p(trained), all that is unknown being
  // as well as it can in each. What both show of the panel or the lens is held against them once.
  const Eigen::MatrixXd fits = with.leftCols(behind), all_left = model_.nuisances().project(fits),
                        trained_left = train.project(fits);
  const auto added = [&](const auto& of) {
    return 0.5 * (of(all_left).squaredNorm() - of(trained_left).squaredNorm());
  };
  const auto addedBy = [&](Eigen::Index column) {
    return added([&](const Eigen::MatrixXd& left) { return left.col(column); });
  };
  HeldOutGain gain;
  gain.physics = addedBy(kBefore) - addedBy(kAfter);
  gain.black_box = addedBy(kBefore) - addedBy(kBlackBox);
  for (Eigen::Index e = 0; e < count; ++e) {
    const double changed = added([&](const Eigen::MatrixXd& left) {
      return Eigen::VectorXd(left.col(kFirstWithout + e) - left.col(kAfter));
    });
    gain.by_effect.push_back(addedBy(kFirstWithout + e) - addedBy(kAfter));
    gain.expected_by_effect.push_back(std::min(changed, addedBy(first_alone + e)));
  }
  if (options_.yardsticks) {
    add(test->rows(), test->project(with));
    shareOut(gain, test->rows(), all_left);
  }
  return gain;
}

Eigen::VectorXd HoldOut::changeBy(const std::vector<Eigen::Index>& columns,
                                  const Eigen::VectorXd& values) const {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(model_.residual().size());
  for (std::size_t k = 0; k < columns.size(); ++k)
    change += columns_.col(columns[k]) * values[static_cast<Eigen::Index>(k)];
  return change;
}

Eigen::VectorXd HoldOut::valuesWithDraws(const Fitted& what, const Reduced& trained) const {
  struct Part {
    std::vector<Eigen::Index> places, columns;  // in `what`, and of all
  } drawn, lasting;
  for (std::size_t k = 0; k < what.columns.size(); ++k) {
    Part& part = is_draw_[static_cast<std::size_t>(what.columns[k])] ? drawn : lasting;
    part.places.push_back(static_cast<Eigen::Index>(k));
    part.columns.push_back(what.columns[k]);
  }
  // Trained with the draws of the images there, of which the held-out ones know nothing.
  Eigen::VectorXd values = valuesOf(what, trained);
  if (drawn.places.empty()) return values;
  const Eigen::VectorXd kept = values(lasting.places);
  const Eigen::VectorXd score =
      whole_->score(drawn.columns) + whole_->gram(drawn.columns, lasting.columns) * kept;
  values(drawn.places) = fitted(whole_->gram(drawn.columns, drawn.columns), score, what.sigma(drawn.places));
  return values;
}

void HoldOut::add(const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& left) {
  for (Eigen::Index k = 0; k < std::ssize(rows); ++k) {
    const Eigen::Index row = rows[static_cast<std::size_t>(k)];
    if (isPrior(row)) continue;
    const RowInfo& info = bare_.rows[static_cast<std::size_t>(row)];
    Piece::Sums& sums = pieceOf(info).channels[info.channel];
    const auto square = [&](Eigen::Index what) { return left(k, what) * left(k, what); };
    // In full: what a robust fit makes light of is there all the same.
    sums.before += square(kBefore) / info.robust_weight;
    sums.after += square(kAfter) / info.robust_weight;
    sums.black_box += square(kBlackBox) / info.robust_weight;
    if (placebo_) sums.floor += left.row(k).tail(kFloorDraws).squaredNorm() / kFloorDraws;
    ++sums.rows;
  }
}

/// A fold's gains to the pieces whose rows they show in; what shows in other rows evenly.
void HoldOut::shareOut(const HeldOutGain& gain, const std::vector<Eigen::Index>& rows,
                       const Eigen::MatrixXd& left) {
  std::set<Piece*> own;
  double physics = gain.physics, black_box = gain.black_box;  // what is left of them
  for (const Eigen::Index row : rows) {
    if (isPrior(row)) continue;
    Piece& piece = pieceOf(bare_.rows[static_cast<std::size_t>(row)]);
    own.insert(&piece);
    const auto lost = [&](Eigen::Index what) {
      return 0.5 * (left(row, kBefore) * left(row, kBefore) - left(row, what) * left(row, what));
    };
    piece.physics += lost(kAfter);
    piece.black_box += lost(kBlackBox);
    physics -= lost(kAfter);
    black_box -= lost(kBlackBox);
  }
  for (Piece* piece : own) {
    piece->physics += physics / static_cast<double>(own.size());
    piece->black_box += black_box / static_cast<double>(own.size());
  }
}

double rmsOf(const std::vector<const Piece*>& pieces, Channel channel, double Piece::Sums::*what) {
  double sum = 0, rows = 0;
  for (const Piece* piece : pieces)
    if (const auto it = piece->channels.find(channel); it != piece->channels.end()) {
      sum += it->second.*what;
      rows += static_cast<double>(it->second.rows);
    }
  return rows > 0 ? std::sqrt(sum / rows) : 0.0;
}

/// Block bootstrap: pieces drawn with replacement.
void HoldOut::resample(HeldOutResult& result, std::map<Channel, std::vector<double>>& rms) {
  std::vector<double> gains, over_box;
  for (int resample = 0; resample < kResamples; ++resample) {
    std::vector<const Piece*> drawn;
    double gain = 0, over = 0;
    for (std::size_t k = 0; k < filled_.size(); ++k) {
      const auto which = static_cast<std::size_t>(random_.uniform() * static_cast<double>(filled_.size()));
      drawn.push_back(filled_[which]);
      gain += drawn.back()->physics;
      over += drawn.back()->physics - drawn.back()->black_box;
    }
    gains.push_back(gain);
    over_box.push_back(over);
    for (const Channel channel : channels_)
      rms[channel].push_back(rmsOf(drawn, channel, &Piece::Sums::after));
  }
  result.gain.physics_ci95 = central95(gains);
  result.gain.over_black_box_ci95 = central95(over_box);
}

HeldOut HoldOut::summary(Channel channel, const std::vector<double>& resampled) const {
  HeldOut held;
  held.channel = channel;
  held.metric = textOf(channel).metric;
  const double unit = printedUnit(linear_, noise_, channel);
  held.before = unit * rmsOf(filled_, channel, &Piece::Sums::before);
  held.after = unit * rmsOf(filled_, channel, &Piece::Sums::after);
  held.black_box = unit * rmsOf(filled_, channel, &Piece::Sums::black_box);
  held.noise_floor = unit * rmsOf(filled_, channel, &Piece::Sums::floor);
  held.after_ci95 = central95(resampled);
  for (double& limit : held.after_ci95) limit *= unit;
  for (int stretch = 0; stretches_.areOfTime() && stretch < stretches_.count(); ++stretch) {
    std::vector<const Piece*> own;
    for (int k = 0; k < kPartsOfStretch; ++k) {
      const int part = stretch * kPartsOfStretch + k;
      own.push_back(&pieces_[static_cast<std::size_t>(part)]);
    }
    held.blocks.push_back({stretches_.begin_s(stretch), stretches_.begin_s(stretch + 1),
                           unit * rmsOf(own, channel, &Piece::Sums::before),
                           unit * rmsOf(own, channel, &Piece::Sums::after),
                           unit * rmsOf(own, channel, &Piece::Sums::black_box)});
  }
  return held;
}

HeldOutResult HoldOut::run() {
  Progress progress("holding out");
  std::mutex one_at_a_time;
  int begun = 0;
  std::vector<HeldOutGain> by_fold(static_cast<std::size_t>(options_.folds));
  parallelFor(by_fold.size(), [&](std::size_t fold) {
    {
      const std::scoped_lock lock(one_at_a_time);
      progress.update(static_cast<double>(begun++) / options_.folds);
    }
    by_fold[fold] = holdOutFold(static_cast<int>(fold));
  });
  for (const Piece& piece : pieces_)
    if (!piece.channels.empty()) filled_.push_back(&piece);
  HeldOutResult result;
  result.gain.by_effect.assign(effects_.size(), 0);
  result.gain.expected_by_effect.assign(effects_.size(), 0);
  result.gain.scatter_by_effect.assign(effects_.size(), 0);
  for (const HeldOutGain& own : by_fold)
    for (std::size_t e = 0; e < effects_.size(); ++e) {
      result.gain.by_effect[e] += own.by_effect[e];
      result.gain.expected_by_effect[e] += own.expected_by_effect[e];
      result.gain.scatter_by_effect[e] += std::sqrt(2 * std::max(0.0, own.expected_by_effect[e]));
    }
  if (filled_.empty()) return result;
  std::map<Channel, std::vector<double>> resampled;
  resample(result, resampled);
  for (const Channel channel : channels_) result.channels.push_back(summary(channel, resampled[channel]));
  for (const HeldOutGain& own : by_fold) {
    result.gain.physics += own.physics;
    result.gain.black_box += own.black_box;
  }
  if (placebo_) result.gain.placebo = placebo_->percentile95();
  return result;
}

}  // namespace

double heldOutStretch_s(const BatchData& data, const HeldOutOptions& options) {
  return Stretches(data, options.folds).length_s();
}

HeldOutResult holdOut(const Linearization& linear, const std::vector<Candidate>& effects,
                      const BatchState& found, const NoiseModel& noise, const BatchData& data,
                      const HeldOutOptions& options) {
  return HoldOut(linear, effects, found, noise, data, options).run();
}

}  // namespace fathom
