#include "diagnosis/black_box.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "effects/catalogue.h"

namespace fathom {
namespace {

/// Intrinsics and distortion; how sensors are mounted, and the scale of the one that is calibrated by runs.
constexpr std::array kRemedies{
    kEffectIndex<FocalScale>,      kEffectIndex<LensDistortion>,  kEffectIndex<CameraMisalignment>,
    kEffectIndex<InsMisalignment>, kEffectIndex<DvlMisalignment>, kEffectIndex<DvlLeverArm>,
    kEffectIndex<DvlScale>};

bool actsOnChannel(const Linearization& linear, std::size_t column, Channel channel) {
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == channel &&
        linear.C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) != 0)
      return true;
  return false;
}

}  // namespace

bool BlackBox::isRemedy(std::size_t effect) {
  return std::find(kRemedies.begin(), kRemedies.end(), effect) != kRemedies.end();
}

BlackBox::BlackBox(const Linearization& linear, Channel channel) : channel_(channel) {
  Eigen::Index count = 0;
  for (const Direction& direction : directionsOf(linear, channel))
    for (const Covariate& covariate : covariatesOf(linear, channel)) {
      if (covariate.name == "time") continue;
      splines_.push_back({direction.name, covariate.name, binLimits(linear, channel, covariate)});
      count += std::ssize(splines_.back().limits) - 1;
    }
  std::vector<double> sigmas(static_cast<std::size_t>(count), noiseUnit(linear, channel));
  for (std::size_t c = 0; c < linear.columns.size(); ++c) {
    const EffectColumn& column = linear.columns[c];
    if (!isRemedy(column.effect) || !actsOnChannel(linear, c, channel)) continue;
    remedies_.push_back(column.scalar);
    sigmas.push_back(column.prior_sigma);
  }
  sigma_ = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), std::ssize(sigmas));
}

Eigen::SparseMatrix<double> BlackBox::columns(const Linearization& linear) const {
  std::map<std::string, Direction> directions;
  for (Direction& direction : directionsOf(linear, channel_))
    directions.emplace(direction.name, std::move(direction));
  std::map<std::string, Covariate> covariates;
  for (Covariate& covariate : covariatesOf(linear, channel_))
    covariates.emplace(covariate.name, std::move(covariate));
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index first = 0;
  for (const Spline& spline : splines_) {
    const auto direction = directions.find(spline.direction);
    const auto covariate = covariates.find(spline.covariate);
    if (direction != directions.end() && covariate != covariates.end())
      for (std::size_t i = 0; i < linear.rows.size(); ++i)
        if (const double value = direction->second.values[i];
            linear.rows[i].channel == channel_ && value != 0)
          if (const auto bin = binOf(spline.limits, covariate->second.of(linear.rows[i])))
            entries.emplace_back(static_cast<int>(i), static_cast<int>(first) + static_cast<int>(*bin),
                                 value);
    first += std::ssize(spline.limits) - 1;
  }
  for (const std::size_t scalar : remedies_) {
    const auto column = std::find_if(linear.columns.begin(), linear.columns.end(),
                                     [&](const EffectColumn& c) { return c.scalar == scalar; });
    if (column != linear.columns.end()) {
      const auto of = linear.C.col(column - linear.columns.begin());
      for (Eigen::Index i = 0; i < of.size(); ++i)
        if (of[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(first), of[i]);
    }
    ++first;
  }
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), sigma_.size());
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

}  // namespace fathom
