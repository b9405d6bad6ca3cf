#include "diagnosis/shown_scatter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/chi_square.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "diagnosis/evidence.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

constexpr double kClearScatter = 4;  // from which on a scatter is more than chance
constexpr std::size_t kFewestMarkers = 4;
constexpr double kLargestTolerance_m = 1.0;
constexpr double kLeastBent_m = 0.0001, kMostBent_m = 0.002, kBentStep = 1.1;  // more than that matters
constexpr double kClearEvidence = 3;  // ln of a Bayes factor: one in twenty
constexpr std::size_t kFewestParts = 30;
constexpr std::size_t kFewestPlaces = 12;   // a place counts once for each colour
constexpr double kLargestPrint = 0.3;       // share of an albedo, px²
constexpr double kSigmasByMedian = 1.4826;  // of normal noise, times its median size
constexpr double kMedianScatter = 1.17;     // of a sigma by the median of n readings, times its root of n

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
  return square > 0 ? Markers::channel.systematic / std::sqrt(square / count) : 0;
}

/// The least scatter from which on all is as it should be; `largest` where there is none.
template <class Test>
double leastWhere(const Test& isWide, double largest) {
  double low = 0, high = largest;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (isWide(middle) ? high : low) = middle;
  }
  return high;
}

/// What these differ by, about zero, beyond what their covariance says. The one that is most off does not
/// count, it may be there for a reason, and by how much less the others scatter for that is known: the mean
/// of the largest of n is where all but exp(-gamma) / n are below (Gumbel 1958). 0 where it may be chance.
double scatterOf(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance, Eigen::Index together) {
  const auto statistic = [&](double sigma, std::optional<Eigen::Index> but) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!but || i / together != *but) kept.push_back(i);
    Eigen::MatrixXd S = covariance(kept, kept);
    S.diagonal().array() += sigma * sigma;
    const Eigen::VectorXd own = x(kept);
    return normalizedSquare(S, own);
  };
  const Eigen::Index count = x.size() / together;
  Eigen::Index most = 0;
  for (Eigen::Index k = 1; k < count; ++k)
    if (statistic(0, k) < statistic(0, most)) most = k;
  if (statistic(0, most) <= chiSquareQuantile(static_cast<double>(x.size() - together), 0.999)) return 0;
  const double usual =
      static_cast<double>(x.size()) -
      chiSquareQuantile(static_cast<double>(together), 1 - 0.56 / static_cast<double>(count));
  return leastWhere([&](double sigma) { return statistic(sigma, most) <= usual; }, kLargestTolerance_m);
}

/// Where effects can make up for a panel that is not plane, and no single one does it as well as a panel that
/// is bent a little: by how much it then is. 0: not so.
double bentPanel_m(const Linearization& linear, const std::vector<Candidate>& effects) {
  std::vector<Eigen::Index> sizes, off_face;
  Eigen::Index count = 0;
  for (const Candidate& effect : effects) {
    sizes.push_back(std::ssize(columnsOf(linear, effect.effect)));
    if (effect.effect == kEffectIndex<MarkerMoved>) off_face.push_back(count + kOffFace);
    count += sizes.back();
  }
  if (off_face.size() < kFewestMarkers) return 0;
  const Nuisances nuisances(linear.J);
  const Eigen::SparseMatrix<double> columns = columnsOf(linear, effects);
  const Eigen::VectorXd priors = priorSigmas(linear, effects);
  const Reduced apart = nuisances.reduce(columns, linear.residual, sizes);
  double best = 0;
  Eigen::Index first = 0;
  for (const Eigen::Index size : sizes) {
    best = std::max(best, logBayesFactor(apart.gram.block(first, first, size, size),
                                         apart.score.segment(first, size), priors.segment(first, size)));
    first += size;
  }
  best += kClearEvidence;
  Eigen::SparseMatrix<double> markers(columns.rows(), std::ssize(off_face));
  for (std::size_t k = 0; k < off_face.size(); ++k)
    markers.col(static_cast<Eigen::Index>(k)) = columns.col(off_face[k]);
  const Reduced together = nuisances.reduce(markers, linear.residual);
  double scatter_m = 0;
  for (double tried_m = kLeastBent_m; tried_m <= kMostBent_m; tried_m *= kBentStep)
    if (const double found = logBayesFactor(together.gram, together.score,
                                            Eigen::VectorXd::Constant(std::ssize(off_face), tried_m));
        found > best)
      best = found, scatter_m = tried_m;
  return scatter_m;
}

/// By which share of its albedo each place is brighter than the map has it, or its edges are softer than
/// rendered (px²), as its readings by themselves have it.
struct MeasuredPrint {
  Eigen::ArrayXd off, variance;

  MeasuredPrint(const Saturated& saturated, const Linearization& linear,
                const std::vector<PrintedPlace>& places) {
    Eigen::SparseMatrix<double, Eigen::RowMajor> columns = columnsOf(linear, places);
    columns.conservativeResize(saturated.residual.size(), columns.cols());
    const Reduced reduced =
        saturated.nuisances.reduce(columns, saturated.residual, std::vector<Eigen::Index>(places.size(), 1));
    const Eigen::ArrayXd information = reduced.gram.diagonal().array();
    off = reduced.score.array() / information;
    // About each place's own mean: what it differs by is none of it.
    std::map<Channel, std::vector<double>> noise;
    const auto channelOf = [&](std::size_t k) { return linear.rows[places[k].rows[0]].channel; };
    for (std::size_t k = 0; k < places.size(); ++k) {
      double square = 0;
      for (const std::size_t i : places[k].rows)
        square += std::pow(saturated.left[static_cast<Eigen::Index>(i)] -
                               off[static_cast<Eigen::Index>(k)] * sigmasPerUnit(linear.rows[i]),
                           2);
      if (places[k].rows.size() > 1)
        noise[channelOf(k)].push_back(square / (static_cast<double>(places[k].rows.size()) - 1));
    }
    std::map<Channel, double> usual;
    for (const auto& [channel, all] : noise) usual[channel] = upperMedian(all);
    variance = information.inverse();
    for (std::size_t k = 0; k < places.size(); ++k)
      if (usual.contains(channelOf(k))) variance[static_cast<Eigen::Index>(k)] *= usual.at(channelOf(k));
  }
};

/// Of the places of these kinds, about what those of one kind have in common in a colour. By the
/// median, as some may be off for a reason; and not what is likeliest but what it hardly exceeds, as much as
/// a sigma by the median of so few places is uncertain: too little of it is taken for an effect that lasts.
double printScatter(const std::vector<PrintedPlace>& places, const MeasuredPrint& measured,
                    const std::set<Printed>& kinds) {
  std::map<std::pair<Printed, int>, std::vector<double>> alike;
  std::vector<Eigen::Index> own;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (!kinds.contains(places[k].what)) continue;
    own.push_back(static_cast<Eigen::Index>(k));
    alike[{places[k].what, places[k].component}].push_back(measured.off[own.back()]);
  }
  if (own.size() < kFewestPlaces) return 0;
  std::map<std::pair<Printed, int>, double> common;
  for (const auto& [what, all] : alike) common[what] = upperMedian(all);
  // In sigmas, were albedos to scatter so much.
  const auto typical = [&](double scatter) {
    std::vector<double> off;
    for (const Eigen::Index k : own) {
      const PrintedPlace& place = places[static_cast<std::size_t>(k)];
      off.push_back(std::abs(measured.off[k] - common.at({place.what, place.component})) /
                    std::sqrt(measured.variance[k] + scatter * scatter));
    }
    return kSigmasByMedian * upperMedian(off);
  };
  // A sigma by the median of n scatters by kMedianScatter / sqrt(n) of itself. Noise has each colour for
  // itself, print has them together.
  const auto readings = static_cast<double>(own.size());
  if (typical(0) < 1 + kClearScatter * kMedianScatter / std::sqrt(readings)) return 0;
  const double prints = readings * static_cast<double>(kinds.size()) / static_cast<double>(alike.size());
  const double uncertain = kMedianScatter / std::sqrt(prints);
  return leastWhere([&](double scatter) { return typical(scatter) <= 1 / (1 + uncertain); }, kLargestPrint);
}

}  // namespace

MarkerScatter markerScatter(const Saturated& saturated, const Linearization& linear) {
  std::vector<Eigen::Index> in_face, off_face, both;
  Eigen::Index column = linear.J.cols();
  for (const Candidate& candidate : saturated.candidates) {
    if (candidate.effect == kEffectIndex<MarkerMoved>) {
      in_face.insert(in_face.end(), {column, column + 1});
      off_face.push_back(column + kOffFace);
      both.insert(both.end(), {column, column + 1, column + kOffFace});
    }
    column += std::ssize(columnsOf(linear, candidate.effect));
  }
  const double least_m = cornerBias_m(linear);
  if (off_face.size() < kFewestMarkers) return {least_m, least_m, least_m};
  const Eigen::VectorXd x = saturated.nuisances.step(saturated.residual);
  const auto beyond = [&](const std::vector<Eigen::Index>& own, Eigen::Index together) {
    return std::max(least_m, scatterOf(x(own), saturated.nuisances.covariance(own), together));
  };
  if (isCameraAlone(linear)) {
    const double any_m = beyond(both, 3);
    return {any_m, any_m, 0};
  }
  const double off_m = std::max(beyond(off_face, 1), bentPanel_m(linear, saturated.candidates));
  return {beyond(in_face, 2), off_m, off_m};
}

PrintScatter printScatter(const Saturated& saturated, const Linearization& linear) {
  const std::vector<PrintedPlace> places = printedPlaces(linear);
  if (places.empty()) return {};
  const MeasuredPrint measured(saturated, linear, places);
  const double markers = printScatter(places, measured, {Printed::black, Printed::white});  // of one printer
  return {markers, markers, printScatter(places, measured, {Printed::body}), 0,
          printScatter(places, measured, {Printed::edges})};
}

double partScatter(const Saturated& saturated, const Linearization& linear) {
  std::vector<double> parts, seen;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    if (row.channel != kChannel<Pixels> || !(row.reflected > 0)) continue;
    parts.push_back(partVariance(row));
    seen.push_back(std::pow(saturated.left[static_cast<Eigen::Index>(i)], 2));
  }
  if (parts.size() < kFewestParts) return 0;
  const Eigen::Map<const Eigen::ArrayXd> x(parts.data(), std::ssize(parts)), y(seen.data(), std::ssize(seen));
  const Eigen::ArrayXd weight = x - x.mean();
  const double excess = (weight * y).sum(), chance = y.mean() * std::sqrt(2 * weight.square().sum());
  return excess > kClearScatter * chance ? std::sqrt(excess / (weight * x).sum()) : 0;
}

}  // namespace fathom
