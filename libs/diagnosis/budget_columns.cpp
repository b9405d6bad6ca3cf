#include "diagnosis/budget_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "core/linear_algebra.h"
#include "core/text.h"
#include "diagnosis/constants.h"
#include "diagnosis/covariate.h"
#include "effects/catalogue.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

using Each = VarianceComponent::Each;

/// What each row changes by, of one unit's worth.
using Change = std::vector<std::pair<Eigen::Index, double>>;

std::invalid_argument unknown(const VarianceComponent& component, const std::string& what) {
  return std::invalid_argument("of " + component.name + ": " + what);
}

struct Name {
  std::string first, second, third;

  explicit Name(const std::string& text) {
    const auto dot = text.find('.');
    first = text.substr(0, dot);
    if (dot == std::string::npos) return;
    const auto next = text.find('.', dot + 1);
    second = text.substr(dot + 1, next == std::string::npos ? next : next - dot - 1);
    if (next != std::string::npos) third = text.substr(next + 1);
  }
};

int axisOf(const std::string& text) { return text.size() == 1 ? static_cast<int>(text[0] - 'x') : -1; }

/// By an effect's scalar.
Change changeBy(const Linearization& linear, std::size_t effect, std::size_t scalar) {
  const Eigen::Index column = columnOf(linear, effect, scalar);
  Change change;
  for (Eigen::Index i = 0; i < linear.C.rows(); ++i)
    if (linear.C(i, column) != 0) change.emplace_back(i, linear.C(i, column));
  return change;
}

/// What a name is of: an effect's parameter, or a channel.
struct Acting {
  const EffectInfo* effect = nullptr;  ///< null: a channel
  std::size_t scalar = 0;              ///< the parameter's first, in EffectParameters::values
  Channel channel{};
};

/// Throws std::invalid_argument where it names none.
Acting actingOf(const Name& name) {
  if (const EffectInfo* effect = findEffect(name.first)) {
    std::size_t scalar = effect->first_scalar;
    for (const Parameter& parameter : effect->parameters) {
      const int axis = axisOf(name.third);
      const bool has_axis = name.third.empty() || (axis >= 0 && axis < parameter.size);
      if (parameter.name == name.second && has_axis) return {effect, scalar};
      scalar += static_cast<std::size_t>(parameter.size);
    }
    throw std::invalid_argument("`" + name.second + "` is no parameter of " + name.first);
  }
  for (const Channel channel : kEveryChannel)
    if (nameOf(channel) == name.first) return {.channel = channel};
  throw std::invalid_argument("`" + name.first + "` is neither an effect nor a channel");
}

std::vector<Change> changesByEffect(const Linearization& linear, const Acting& acting, const Name& name) {
  std::vector<Change> changes;
  const std::size_t first = acting.scalar - acting.effect->first_scalar;
  for (int k = 0; k < parameterOf(acting.scalar).size; ++k)
    if (!linear.columns.empty() && (name.third.empty() || k == axisOf(name.third)))
      changes.push_back(changeBy(linear, acting.effect->index, first + static_cast<std::size_t>(k)));
  return changes;
}

/// The reading itself: what one unit of it is in its row.
std::vector<Change> changesOfReading(const Linearization& linear, const VarianceComponent& component,
                                     Channel channel, const Name& name) {
  const bool of_level = name.second == "level", of_reflected = name.second == "reflected";
  const int axis = axisOf(name.second);
  if (!name.second.empty() && !of_level && !of_reflected && (axis < 0 || axis > 2))
    throw unknown(component, "`" + name.second + "` is none of x, y, z, level, reflected");
  Change change;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    if (row.channel != channel || (axis >= 0 && axis < 3 && componentOf(row) != axis)) continue;
    const double unit = of_level ? row.level : of_reflected ? row.reflected : 1.0;
    if (std::isfinite(unit) && unit != 0)
      change.emplace_back(static_cast<Eigen::Index>(i), unit * row.per_unit * std::sqrt(row.robust_weight));
  }
  return {change};
}

std::vector<Change> changesBy(const Linearization& linear, const VarianceComponent& component,
                              const std::string& by) {
  const Name name(by);
  Acting acting;
  try {
    acting = actingOf(name);
  } catch (const std::invalid_argument& e) {
    throw unknown(component, e.what());
  }
  return acting.effect != nullptr ? changesByEffect(linear, acting, name)
                                  : changesOfReading(linear, component, acting.channel, name);
}

/// Whose a row's value is. Instruments are numbered as they come.
Owner ownerOf(const RowInfo& row, Each each, std::map<Instance, int>& instances) {
  switch (each) {
    case Each::recording:
      break;
    case Each::sensor:
      return {sensorKindOf(row.channel), 0};
    case Each::instrument:
      return {instances.try_emplace(row.instance, static_cast<int>(instances.size())).first->second, 0};
    case Each::marker:
      return {row.markerSeen(), 0};
    case Each::place:
      return {row.place, row.component};
    case Each::spot:
      return {row.place, 0};
    case Each::image:
      return {0, row.image};
    case Each::image_colour:
      return {row.component, row.image};
    case Each::reading:
      return {0, static_cast<std::ptrdiff_t>(row.reading)};
  }
  return {0, 0};
}

/// Rows that have a value of their own, by whose it is.
std::map<Owner, Change> byOwner(const Linearization& linear, Each each, const Change& change) {
  std::map<Owner, Change> by_owner;
  std::map<Instance, int> instances;
  for (const auto& [i, value] : change)
    by_owner[ownerOf(linear.rows[static_cast<std::size_t>(i)], each, instances)].emplace_back(i, value);
  return by_owner;
}

/// Nodes along one covariate.
struct Axis {
  Covariate covariate;
  double first = 0, step = 1, length = 1;
  int nodes = 1;

  /// Its mean where one of the two is not a place but all within so much of it.
  double kernel(double apart, double half = 0) const {
    const double root = length * std::numbers::sqrt2;
    if (half < kPointLike * length) return std::exp(-std::pow(apart / root, 2));
    return root * std::sqrt(std::numbers::pi) / (4 * half) *
           (std::erf((apart + half) / root) - std::erf((apart - half) / root));
  }
  /// What a row is the mean over, to either side, were all of it as likely.
  double half(const RowInfo& row) const { return std::numbers::sqrt3 * covariate.spread(row) * unit(row); }
  /// Between a row, were it the mean over as much as `like`, and each node.
  Eigen::VectorXd kernelOf(const RowInfo& row, const RowInfo& like) const {
    const double beside = half(like);
    Eigen::VectorXd own(nodes);
    for (int node = 0; node < nodes; ++node) own[node] = kernel(at(row) - first - node * step, beside);
    return own;
  }
  double at(const RowInfo& row) const { return covariate.of(row) * unit(row); }
  /// In the image in focal lengths, so that cameras of any resolution have the same.
  double unit(const RowInfo& row) const {
    return covariate.unit == "px" ? 1 / row.focal_px : covariate.scale;
  }
};

/// A change that goes with a smooth field: what its values at nodes say of it elsewhere, k(x, Z) K^-1 u with
/// u ~ N(0, K) (subset of regressors; Quiñonero-Candela & Rasmussen 2005). At a third of a length apart that
/// is the field but for 1e-6 of its variance; straight lines between nodes would leave a twentieth of it,
/// many times what thousands of readings of light resolve.
class Field {
 public:
  /// `covariates`: those of the change's channel. `of_places`: it is a mean over as much as there is of each
  /// place, however much of that an image shows.
  Field(const Linearization& linear, const SmoothField& smooth, const std::vector<Covariate>& covariates,
        const Change& change, bool of_places)
      : linear_(linear) {
    if (of_places) noteWholePlaces(change);
    for (std::size_t k = 0; k < smooth.over.size(); ++k) {
      const auto found = std::find_if(covariates.begin(), covariates.end(),
                                      [&](const Covariate& c) { return c.name == smooth.over[k]; });
      if (found != covariates.end()) axes_.push_back(axis(*found, smooth.length[k], change));
    }
    root_ = rootOfInverse();
  }

  /// Of each row that changes: by how much with each independent value, those that the readings tell most of
  /// last, without those that they tell nothing of, although it may be as large as `largest`.
  Eigen::MatrixXd columns(const Change& change, double largest) const {
    Eigen::MatrixXd all(std::ssize(change), root_.cols());
    for (Eigen::Index r = 0; r < all.rows(); ++r) {
      const auto& [row, value] = change[static_cast<std::size_t>(r)];
      all.row(r) = value * at(linear_.rows[static_cast<std::size_t>(row)]);
    }
    const SymmetricEigen told = eigenOf(transposedTimesItself(all));
    Eigen::Index first = 0;
    while (first < told.values.size() && told.values[first] * largest * largest < kLeastTold) ++first;
    return all * told.vectors.rightCols(told.values.size() - first);
  }

 private:
  void noteWholePlaces(const Change& change) {
    for (const auto& [i, value] : change) {
      const RowInfo& row = linear_.rows[static_cast<std::size_t>(i)];
      if (row.patch < 0) continue;
      const RowInfo*& whole = whole_places_[row.place];
      if (whole == nullptr || row.seen_share > whole->seen_share) whole = &row;
    }
  }
  /// The row that tells over how much a row's value is a mean.
  const RowInfo& likeWhich(const RowInfo& row) const {
    const auto whole = row.patch < 0 ? whole_places_.end() : whole_places_.find(row.place);
    return whole == whole_places_.end() ? row : *whole->second;
  }

  /// Each independent value's share at a row. What has no place in it, as open water on the panel, has
  /// nothing of it.
  Eigen::RowVectorXd at(const RowInfo& row) const {
    const RowInfo& like = likeWhich(row);
    Eigen::VectorXd kernel = Eigen::VectorXd::Ones(1);
    for (const Axis& axis : axes_) {
      const Eigen::VectorXd own = axis.kernelOf(row, like);
      kernel = (own * kernel.transpose()).reshaped().eval();
    }
    if (!kernel.allFinite()) return Eigen::RowVectorXd::Zero(root_.cols());
    return kernel.transpose() * root_;
  }

  Axis axis(const Covariate& covariate, double length, const Change& change) const {
    Axis axis{covariate, 0, 1, length, 1};
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& [i, value] : change) {
      const RowInfo& row = linear_.rows[static_cast<std::size_t>(i)];
      const double at = axis.at(row), half = axis.half(likeWhich(row));
      low = std::min(low, at - half);
      high = std::max(high, at + half);
    }
    if (!(low <= high)) return axis;
    axis.first = low;
    const double lengths = (high - low) / length;
    axis.nodes = std::clamp(static_cast<int>(std::ceil(kNodesPerLength * lengths)) + 1, 1, kMostNodes);
    if (axis.nodes > 1) axis.step = (high - low) / (axis.nodes - 1);
    return axis;
  }

  /// R with R R^T = K^-1, but for directions that hardly any of the field is in.
  Eigen::MatrixXd rootOfInverse() const {
    Eigen::MatrixXd kernel = Eigen::MatrixXd::Ones(1, 1);
    for (const Axis& axis : axes_) {
      Eigen::MatrixXd next(kernel.rows() * axis.nodes, kernel.cols() * axis.nodes);
      for (Eigen::Index i = 0; i < kernel.rows(); ++i)
        for (Eigen::Index j = 0; j < kernel.cols(); ++j)
          for (int a = 0; a < axis.nodes; ++a)
            for (int b = 0; b < axis.nodes; ++b)
              next(i * axis.nodes + a, j * axis.nodes + b) = kernel(i, j) * axis.kernel((a - b) * axis.step);
      kernel = std::move(next);
    }
    const SymmetricEigen eigen = eigenOf(kernel);
    Eigen::Index first = 0;
    double dropped = 0;
    while (first + 1 < eigen.values.size() &&
           dropped + std::max(0.0, eigen.values[first]) < kDropped * kernel.trace())
      dropped += std::max(0.0, eigen.values[first++]);
    const Eigen::Index kept = eigen.values.size() - first;
    return eigen.vectors.rightCols(kept) * eigen.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  }

  const Linearization& linear_;
  std::map<int, const RowInfo*> whole_places_;  ///< as they are seen most of, where that is asked for
  std::vector<Axis> axes_;
  Eigen::MatrixXd root_;
};

/// Of fields over the panel that all places share. Where a part of a place is seen the field has another
/// value, as there is another place; but the mean over more or less of it differs far less than by how evenly
/// it is printed, which has columns of its own: else what a footprint's spread leaves out of those looks like
/// a field that is ever rougher.
bool isOfPlaces(const VarianceComponent& component) {
  const std::vector<std::string>& over = component.smooth->over;
  return component.each == Each::recording && std::find(over.begin(), over.end(), "panel x") != over.end();
}

}  // namespace

std::string unitOf(const std::string& by) {
  const Name name(by);
  const Acting acting = actingOf(name);
  if (acting.effect != nullptr) return std::string(parameterOf(acting.scalar).unit);
  if (name.second == "level" || name.second == "reflected") return "1";
  const ChannelText& text = textOf(acting.channel);
  std::string unit(text.unit);
  if (text.scale == 1) return unit;
  return text.scale == 1000 && unit.starts_with("mm") ? unit.substr(1) : "";
}

OwnedColumns columnsOf(const Linearization& linear, const VarianceComponent& component) {
  OwnedColumns all_columns;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index columns = 0;
  const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
    if (value != 0) entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  for (const std::string& by : component.by)
    for (const Change& all : changesBy(linear, component, by)) {
      if (all.empty()) continue;
      std::vector<Covariate> covariates;
      if (component.smooth) {
        const auto first = static_cast<std::size_t>(all.front().first);
        covariates = covariatesOf(linear, linear.rows[first].channel);
      }
      for (const auto& [owner, change] : byOwner(linear, component.each, all)) {
        if (!component.smooth) {
          for (const auto& [row, value] : change) add(row, columns, value);
          ++columns;
          all_columns.owners.push_back(owner);
          continue;
        }
        const Eigen::MatrixXd own =
            Field(linear, *component.smooth, covariates, change, isOfPlaces(component))
                .columns(change, component.sigma * component.factor);
        for (Eigen::Index r = 0; r < own.rows(); ++r)
          for (Eigen::Index k = 0; k < own.cols(); ++k)
            add(change[static_cast<std::size_t>(r)].first, columns + k, own(r, k));
        columns += own.cols();
        all_columns.owners.resize(static_cast<std::size_t>(columns), owner);
      }
    }
  all_columns.columns.resize(std::ssize(linear.rows), columns);
  all_columns.columns.setFromTriplets(entries.begin(), entries.end());
  return all_columns;
}

std::string whereIs(const Owner& owner, Each each, const Linearization& linear) {
  if (each == Each::marker) return print("marker %d", owner.first);
  std::map<Instance, int> instances;
  Vector2d sum = Vector2d::Zero();
  int count = 0;
  for (const RowInfo& row : linear.rows) {
    const bool has_place = (each == Each::place || each == Each::spot) && row.point_panel.allFinite();
    if (!has_place || ownerOf(row, each, instances) != owner) continue;
    sum += row.point_panel;
    ++count;
  }
  return count == 0 ? "" : print("%.2f m, %.2f m of the panel", sum.x() / count, sum.y() / count);
}

bool isOfOnePlace(Each each) { return each == Each::place || each == Each::spot || each == Each::reading; }

HeldColumns localFirst(const HeldColumns& held, const ErrorBudget& budget) {
  std::vector<Eigen::Index> local, others;
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < held.sizes.size(); first += held.sizes[k++]) {
    const Each each = budget.components[k].each;
    auto& own = each == Each::image || each == Each::image_colour || isOfOnePlace(each) ? local : others;
    for (Eigen::Index c = 0; c < held.sizes[k]; ++c) own.push_back(first + c);
  }
  for (; first < held.sigma.size(); ++first) others.push_back(first);
  HeldColumns sorted;
  sorted.local = std::ssize(local);
  local.insert(local.end(), others.begin(), others.end());
  sorted.columns = columnsOf(held.columns, local);
  sorted.sigma = held.sigma(local);
  return sorted;
}

}  // namespace fathom
