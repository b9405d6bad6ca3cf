#include "diagnosis/mismatch.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <span>
#include <unsupported/Eigen/FFT>

#include "core/chi_square.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "diagnosis/constants.h"
#include "diagnosis/screening.h"
#include "effects/registry.h"

namespace fathom {
namespace {

/// "2.1 to 2.4 m".
std::string rangeOf(double low, double high, const std::string& unit) {
  return print("%.3g to %.3g", low, high) + (unit == "1" ? "" : " " + unit);
}

/// A map before it is computed.
struct Plan {
  Mismatch map;
  std::vector<std::vector<std::size_t>> rows;  // of each bin
  std::vector<Eigen::Index> widths;            // columns of each bin; all side by side
  std::optional<int> component;                // of the direction
  /// So many bins are taken together, as what the estimate has taken up of one shows in others. Of images
  /// those far from each other hardly have anything in common.
  std::size_t together = std::numeric_limits<std::size_t>::max();
};

/// Bins that are taken together.
struct Group {
  std::size_t first_bin = 0, behind = 0;
  Eigen::Index columns = 0;
};
std::vector<Group> groupsOf(const Plan& plan) {
  std::vector<Group> groups;
  for (std::size_t bin = 0; bin < plan.widths.size(); ++bin) {
    if (groups.empty() || bin - groups.back().first_bin == plan.together) groups.push_back({bin, bin, 0});
    groups.back().behind = bin + 1;
    groups.back().columns += plan.widths[bin];
  }
  return groups;
}

class Planner {
 public:
  explicit Planner(const Linearization& linear) : linear_(linear) {}

  void addCovariates(Channel channel) {
    const std::vector<Direction> directions = directionsOf(linear_, channel);
    for (const Covariate& covariate : covariatesOf(linear_, channel)) {
      const std::vector<double> limits = binLimits(linear_, channel, covariate);
      for (const Direction& direction : directions) {
        Plan plan = begin(channel, "mean residual", covariate.name, covariate.unit);
        plan.map.direction = direction.name;
        plan.component = direction.component;
        for (std::size_t bin = 0; bin + 1 < limits.size(); ++bin) {
          const double low = limits[bin] * covariate.scale, high = limits[bin + 1] * covariate.scale;
          addBin(plan, low, high, rangeOf(low, high, covariate.unit));
        }
        for (std::size_t i = 0; i < linear_.rows.size(); ++i)
          if (linear_.rows[i].channel == channel && direction.values[i] != 0)
            if (const auto bin = binOf(limits, covariate.of(linear_.rows[i]))) plan.rows[*bin].push_back(i);
        for (std::size_t bin = 0; bin < plan.rows.size(); ++bin)
          addColumn(plan.rows[bin], direction.values, plan.widths[bin]);
        plans.push_back(std::move(plan));
      }
    }
  }

  /// Every marker somewhere else.
  void addMarkers() {
    Plan plan = begin(kChannel<Markers>, "mean corner residual", "marker id", "1");
    for (const int id : markersOf(linear_)) {
      const std::size_t bin = addBin(plan, id, id, print("id %d", id));
      for (std::size_t i = 0; i < linear_.rows.size(); ++i)
        if (linear_.rows[i].marker_id == id) plan.rows[bin].push_back(i);
      for (const std::size_t axis : {1u, 2u, 3u})
        addColumn(plan.rows[bin], effectColumn(kEffectIndex<MarkerMoved>, axis), plan.widths[bin]);
    }
    plans.push_back(std::move(plan));
  }

  /// Every image taken in another direction: a camera that shakes.
  void addImages() {
    std::map<std::ptrdiff_t, std::vector<std::size_t>> images;
    for (std::size_t i = 0; i < linear_.rows.size(); ++i)
      if (linear_.rows[i].image >= 0) images[linear_.rows[i].image].push_back(i);
    if (images.size() < 4) return;
    Plan plan = begin(kChannel<Markers>, "shift of an image", "image", "s");
    plan.together = kImagesTogether;
    for (const auto& [image, rows] : images) {
      const double t_s = linear_.rows[rows[0]].t_s;
      const std::size_t bin = addBin(plan, t_s, t_s, print("the image at %.1f s", t_s));
      plan.rows[bin] = rows;
      for (const std::size_t axis : {0u, 1u, 2u})
        addColumn(rows, effectColumn(kEffectIndex<CameraMisalignment>, axis), plan.widths[bin]);
    }
    plans.push_back(std::move(plan));
  }

  Eigen::SparseMatrix<double> columns() const {
    Eigen::SparseMatrix<double> all(std::ssize(linear_.rows), static_cast<Eigen::Index>(count_));
    all.setFromTriplets(entries_.begin(), entries_.end());
    return all;
  }

  /// How many columns each group of each plan has: they are side by side.
  std::vector<Eigen::Index> widths() const {
    std::vector<Eigen::Index> widths;
    for (const Plan& plan : plans)
      for (const Group& group : groupsOf(plan)) widths.push_back(group.columns);
    return widths;
  }

  std::vector<Plan> plans;

 private:
  static Plan begin(Channel channel, std::string statistic, std::string against, std::string unit) {
    Plan plan;
    plan.map.channel = channel;
    plan.map.statistic = std::move(statistic);
    plan.map.against = std::move(against);
    plan.map.unit = std::move(unit);
    return plan;
  }
  static std::size_t addBin(Plan& plan, double low, double high, std::string label) {
    MismatchBin bin;
    bin.low = low;
    bin.high = high;
    bin.label = std::move(label);
    plan.map.bins.push_back(std::move(bin));
    plan.rows.emplace_back();
    plan.widths.push_back(0);
    return plan.rows.size() - 1;
  }
  std::vector<double> effectColumn(std::size_t effect, std::size_t scalar) const {
    const auto column = linear_.C.col(columnOf(linear_, effect, scalar));
    return {column.begin(), column.end()};
  }
  void addColumn(const std::vector<std::size_t>& rows, const std::vector<double>& values,
                 Eigen::Index& width) {
    for (const std::size_t i : rows)
      if (values[i] != 0) entries_.emplace_back(static_cast<int>(i), static_cast<int>(count_), values[i]);
    ++count_;
    ++width;
  }

  const Linearization& linear_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::size_t count_ = 0;
};

struct Score {
  double statistic = 0;
  int dof = 0;
};
/// Of columns one behind the other.
Score scoreOf(const Reduced& reduced, Eigen::Index first, Eigen::Index count) {
  const Information information(reduced.gram.block(first, first, count, count),
                                reduced.norms.segment(first, count));
  const auto g = reduced.score.segment(first, count);
  return {g.dot(information.inverse * g), information.rank};
}

struct Scatter {
  double sum = 0, square = 0, rows = 0;
  double mean() const { return sum / rows; }
  double variance() const { return std::max(0.0, square / rows - mean() * mean()); }
};

void describeBin(const Linearization& linear, const std::vector<std::size_t>& rows,
                 std::optional<int> component, MismatchBin& bin) {
  bin.rows = rows.size();
  if (rows.empty()) return;
  std::map<int, Scatter> scatters;  // by component
  for (const std::size_t i : rows) {
    const RowInfo& row = linear.rows[i];
    if (component && componentOf(row) != *component) continue;
    Scatter& scatter = scatters[componentOf(row)];
    scatter.sum += row.raw;
    scatter.square += row.raw * row.raw;
    ++scatter.rows;
  }
  const double scale = textOf(linear.rows[rows[0]].channel).scale;
  double square = 0, variance = 0;
  for (const auto& [axis, scatter] : scatters) {
    square += scatter.mean() * scatter.mean();
    variance += scatter.variance() / scatter.rows / static_cast<double>(scatters.size());
  }
  const bool is_signed = component && !scatters.empty();
  bin.mean_raw = scale * (is_signed ? scatters.begin()->second.mean() : std::sqrt(square));
  bin.sigma = scale * std::sqrt(variance);
}

/// `reduced`: of its groups.
void finish(Plan& plan, const WhitenedModel& model, std::span<const Reduced> reduced) {
  const Linearization& linear = model.linear();
  Mismatch& map = plan.map;
  std::size_t worst = 0, rows = 0;
  Score score;
  for (const Group& group : groupsOf(plan)) {
    Eigen::Index column = 0;
    for (std::size_t bin = group.first_bin; bin < group.behind; column += plan.widths[bin++]) {
      describeBin(linear, plan.rows[bin], plan.component, map.bins[bin]);
      map.bins[bin].size_sigma =
          std::sqrt(std::max(0.0, scoreOf(reduced.front(), column, plan.widths[bin]).statistic));
      if (map.bins[bin].size_sigma > map.bins[worst].size_sigma) worst = bin;
      rows += plan.rows[bin].size();
    }
    const Score own = scoreOf(reduced.front(), 0, group.columns);
    score.statistic += own.statistic;
    score.dof += own.dof;
    reduced = reduced.subspan(1);
  }
  map.statistic_value = score.statistic;
  map.dof = score.dof;
  const double noise_freedom = model.noise().of(map.channel).freedom;
  map.log_p = score.dof > 0 ? chiSquareLogTail(score.dof, score.statistic, noise_freedom) : 0;
  map.size_sigma = map.bins[worst].size_sigma;
  map.where = map.bins[worst].label;
  map.size_raw = std::sqrt(std::max(0.0, score.statistic - score.dof) /
                           static_cast<double>(std::max<std::size_t>(1, rows))) *
                 noiseUnit(linear, map.channel);
  for (const std::size_t i : plan.rows[worst]) {
    if (map.when_s == Interval{}) map.when_s = {linear.rows[i].t_s, linear.rows[i].t_s};
    map.when_s.from_s = std::min(map.when_s.from_s, linear.rows[i].t_s);
    map.when_s.to_s = std::max(map.when_s.to_s, linear.rows[i].t_s);
  }
}

/// |FFT|² of each column, of the positive frequencies.
Eigen::MatrixXd powersOf(const Eigen::MatrixXd& series) {
  Eigen::FFT<double> fft;
  const Eigen::Index count = series.rows() / 2;
  Eigen::MatrixXd powers(count, series.cols());
  for (Eigen::Index c = 0; c < series.cols(); ++c) {
    const std::vector<double> in(series.col(c).begin(), series.col(c).end());
    std::vector<std::complex<double>> out;
    fft.fwd(out, in);
    for (Eigen::Index k = 0; k < count; ++k) powers(k, c) = std::norm(out[static_cast<std::size_t>(k + 1)]);
  }
  return powers;
}

/// Peaks in the spectra of the sensors' axes, against what the estimate leaves of white noise.
std::vector<Mismatch> spectra(const WhitenedModel& model, std::uint64_t seed) {
  const Linearization& linear = model.linear();
  Random random(seed);
  Eigen::MatrixXd all = random.normals(model.residual().size(), kSpectrumDraws + 1);
  all.col(0) = model.residual();
  all = model.nuisances().project(all);
  // A few outliers have a spectrum of their own by chance: in full measure, as the fit takes them, they count
  // by the root of their size.
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    all(static_cast<Eigen::Index>(i), 0) *= std::sqrt(linear.rows[i].robust_weight);
  std::vector<Mismatch> maps;
  for (const auto& track : linear.tracks) {
    const RowInfo& first = linear.rows[track[0]];
    if (track.size() < kShortestSpectrum || textOf(first.channel).is_of_images) continue;
    Eigen::MatrixXd own(std::ssize(track), all.cols());
    for (std::size_t k = 0; k < track.size(); ++k)
      own.row(static_cast<Eigen::Index>(k)) = all.row(static_cast<Eigen::Index>(track[k]));
    const Eigen::MatrixXd powers = powersOf(own);
    // The draws' mean, smoothed over neighbours: a spectrum of noise has no lines.
    const Eigen::VectorXd mean = powers.rightCols(kSpectrumDraws).rowwise().mean();
    Mismatch map;
    map.channel = first.channel;
    map.statistic = "spectrum";
    map.direction = std::string(1, "xyz"[first.component % 3]);
    map.against = "frequency";
    map.unit = "Hz";
    const double span_s = linear.rows[track.back()].t_s - first.t_s;
    constexpr Eigen::Index kHalf = 4;
    double largest = 0, excess = 0, peak_hz = 0;
    for (Eigen::Index k = 0; k < mean.size(); ++k) {
      const Eigen::Index low = std::max<Eigen::Index>(0, k - kHalf),
                         high = std::min(mean.size(), k + kHalf + 1);
      const double expected = mean.segment(low, high - low).mean();
      const double ratio = powers(k, 0) / std::max(expected, 1e-12);
      if (ratio > largest) {
        largest = ratio;
        excess = powers(k, 0) - expected;
        peak_hz = static_cast<double>(k + 1) / span_s;
      }
    }
    map.statistic_value = 2 * largest;  // chi-square of 2
    map.dof = 2;
    map.log_p = std::min(0.0, -largest + std::log(static_cast<double>(mean.size())));
    map.size_sigma = std::sqrt(2 * largest);
    // A line's power |X|² stands for a root mean square of sqrt(2 |X|²)/n.
    map.size_raw = std::sqrt(2 * std::max(0.0, excess)) / static_cast<double>(track.size()) *
                   noiseUnit(linear, first.channel);
    map.where = print("%.3g Hz", peak_hz);
    map.when_s = {first.t_s, linear.rows[track.back()].t_s};
    maps.push_back(std::move(map));
  }
  return maps;
}

/// What all images have alike and only a prior holds: an estimate takes it up, so that no residual of an edge
/// or a count shows it, but the prior's does.
std::vector<Mismatch> imageFlaws(const WhitenedModel& model) {
  const Linearization& linear = model.linear();
  const auto block = std::find_if(linear.blocks.begin(), linear.blocks.end(),
                                  [](const UnknownBlock& b) { return b.kind == UnknownBlock::Kind::flaws; });
  std::vector<Mismatch> maps;
  if (block == linear.blocks.end()) return maps;
  const Eigen::VectorXd left = model.nuisances().project(model.residual());
  for (int flaw = 0; flaw < kFlaws; ++flaw)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(linear.J, block->column + flaw); entry; ++entry) {
      const bool is_prior = linear.rows[static_cast<std::size_t>(entry.row())].channel == kChannel<Prior>;
      if (!is_prior || entry.value() == 0) continue;
      const double sigmas = std::abs(left[entry.row()]);
      Mismatch map;
      map.channel = flaw == kLensBlur      ? kChannel<Edges>
                    : flaw == kFalseSpecks ? kChannel<Specks>
                                           : kChannel<Pixels>;
      if (flaw >= kFalseLight)
        map.direction = textOf(map.channel).components[static_cast<std::size_t>(flaw - kFalseLight)];
      map.statistic = "size beyond what is usual";
      map.against = "all images";
      map.where = "all alike";
      map.size_sigma = sigmas;
      map.size_raw = sigmas / entry.value();
      map.statistic_value = sigmas * sigmas;
      map.dof = 1;
      map.log_p = chiSquareLogTail(1, map.statistic_value);
      map.when_s = readingsSpan(linear);
      maps.push_back(std::move(map));
    }
  return maps;
}

}  // namespace

std::vector<Mismatch> mismatchMaps(const WhitenedModel& model, std::uint64_t seed) {
  const Linearization& linear = model.linear();
  Planner planner(linear);
  for (const Channel channel : kEveryChannel) {
    const bool present = std::any_of(linear.rows.begin(), linear.rows.end(),
                                     [&](const RowInfo& row) { return row.channel == channel; });
    if (channel == kChannel<Prior> || !present) continue;
    planner.addCovariates(channel);
  }
  if (!markersOf(linear).empty()) {
    planner.addMarkers();
    planner.addImages();
  }
  const std::vector<Reduced> reduced =
      model.nuisances().reduceEach(model.whitened(planner.columns()), model.residual(), planner.widths());
  std::vector<std::size_t> first{0};  // of each plan's groups
  for (const Plan& plan : planner.plans) first.push_back(first.back() + groupsOf(plan).size());
  std::vector<Mismatch> maps = spectra(model, seed);
  for (Mismatch& map : imageFlaws(model)) maps.push_back(std::move(map));
  parallelFor(planner.plans.size(), [&](std::size_t i) {
    finish(planner.plans[i], model, std::span(reduced).subspan(first[i], first[i + 1] - first[i]));
  });
  for (Plan& plan : planner.plans)
    if (plan.map.dof > 0) maps.push_back(std::move(plan.map));
  for (Mismatch& map : maps) {
    map.log_p = std::min(0.0, map.log_p + std::log(static_cast<double>(maps.size())));
    map.p_value = std::exp(map.log_p);
    const ChannelText& text = textOf(map.channel);
    map.material = map.size_raw > text.material;
    map.size_raw *= text.scale;
    map.raw_unit = text.unit;
  }
  stableSort(maps, [](const Mismatch& a, const Mismatch& b) { return a.log_p < b.log_p; });
  return maps;
}

}  // namespace fathom
