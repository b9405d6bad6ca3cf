#include "diagnosis/scatter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "diagnosis/candidate.h"
#include "effects/catalogue.h"
#include "panel/panel_map.h"

namespace fathom {
namespace {

constexpr double kLeastSeen = 0.1;  // of a place; less counts as that

/// What of its place a row reads; nothing where it reads none. An edge's two variances have no covariance on
/// their own account.
std::optional<Printed> printedOf(const RowInfo& row) {
  constexpr int kCovariance = 1;
  if (row.channel == kChannel<Edges> && row.component != kCovariance) return Printed::edges;
  if (row.channel != kChannel<Pixels> || !(row.reflected > 0)) return {};
  switch (row.surface) {
    case ImagePatch::Surface::black:
      return Printed::black;
    case ImagePatch::Surface::white:
      return Printed::white;
    case ImagePatch::Surface::body:
      return Printed::body;
    default:
      return {};
  }
}

}  // namespace

bool isCameraAlone(const Linearization& linear) {
  return std::none_of(linear.rows.begin(), linear.rows.end(),
                      [](const RowInfo& row) { return textOf(row.channel).shows_motion; });
}

double partVariance(const RowInfo& row) {
  if (row.channel != kChannel<Pixels> || !(row.reflected > 0)) return 0;
  return (1 / std::max(kLeastSeen, row.seen_share) - 1) * std::pow(row.reflected * row.per_unit, 2);
}

std::vector<PrintedPlace> printedPlaces(const Linearization& linear) {
  std::map<std::tuple<Channel, int, int>, PrintedPlace> places;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    const std::optional<Printed> what = printedOf(row);
    if (!what) continue;
    const auto [place, is_new] =
        places.try_emplace({row.channel, row.place, row.component}, PrintedPlace{*what, row.component, {}});
    place->second.rows.push_back(i);
  }
  std::vector<PrintedPlace> all;
  for (auto& [key, place] : places) all.push_back(std::move(place));
  return all;
}

double sigmasPerUnit(const RowInfo& row) {
  const double unit = row.channel == kChannel<Edges> ? 1 : row.reflected;
  return unit * row.per_unit * std::sqrt(row.robust_weight);
}

Eigen::SparseMatrix<double> columnsOf(const Linearization& linear, const std::vector<PrintedPlace>& places) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < places.size(); ++k)
    for (const std::size_t i : places[k].rows)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(k), sigmasPerUnit(linear.rows[i]));
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), std::ssize(places));
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

HeldColumns placeColumns(const Linearization& linear, const MarkerScatter& scatter,
                         const std::map<int, double>& half_sizes_m) {
  constexpr Eigen::Index kMoved = 4;
  const Eigen::Index tilts = scatter.tilted_m > 0 ? 2 : 0, all = kMoved + tilts;
  const std::set<int> ids = markersOf(linear);
  HeldColumns held{{std::ssize(linear.rows), all * std::ssize(ids)}, Eigen::VectorXd(all * std::ssize(ids))};
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index first = 0;
  for (const int id : ids) {
    const Eigen::SparseMatrix<double> moved =
        columnsOf(linear, {Candidate{kEffectIndex<MarkerMoved>, id, {}, {}, {}, {}}});
    const auto add = [&](const auto& entry, Eigen::Index column, double share) {
      entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(first + column),
                           share * entry.value());
    };
    for (Eigen::Index c = 0; c < kMoved; ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(moved, c); entry; ++entry) {
        add(entry, c, 1);
        const int corner = linear.rows[static_cast<std::size_t>(entry.row())].component / 2;
        for (Eigen::Index axis = 0; c == kOffFace && axis < tilts; ++axis)
          add(entry, kMoved + axis,
              kMarkerCorners[static_cast<std::size_t>(corner)][static_cast<std::size_t>(axis)]);
      }
    held.sigma.segment<kMoved>(first) << scatter.in_face_m, scatter.in_face_m, scatter.off_face_m,
        degrees(scatter.in_face_m / half_sizes_m.at(id));
    held.sigma.segment(first + kMoved, tilts).setConstant(scatter.tilted_m);
    first += all;
  }
  held.columns.setFromTriplets(entries.begin(), entries.end());
  return held;
}

HeldColumns printColumns(const Linearization& linear, const PrintScatter& scatter) {
  std::vector<PrintedPlace> places = printedPlaces(linear);
  std::erase_if(places, [&](const PrintedPlace& place) { return scatter.of(place.what) == 0; });
  HeldColumns held{columnsOf(linear, places), Eigen::VectorXd(std::ssize(places))};
  for (std::size_t k = 0; k < places.size(); ++k)
    held.sigma[static_cast<Eigen::Index>(k)] = scatter.of(places[k].what);
  return held;
}

}  // namespace fathom
