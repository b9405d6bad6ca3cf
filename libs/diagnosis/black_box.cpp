#include "diagnosis/black_box.h"

#include <map>

namespace fathom {

BlackBox::BlackBox(const Linearization& linear, Channel channel)
    : channel_(channel), sigma_(noiseUnit(linear, channel)) {
  for (const Direction& direction : directionsOf(linear, channel))
    for (const Covariate& covariate : covariatesOf(linear, channel)) {
      if (covariate.name == "time") continue;
      splines_.push_back({direction.name, covariate.name, binLimits(linear, channel, covariate)});
      count_ += std::ssize(splines_.back().limits) - 1;
    }
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
  Eigen::SparseMatrix<double> columns(std::ssize(linear.rows), count_);
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

}  // namespace fathom
