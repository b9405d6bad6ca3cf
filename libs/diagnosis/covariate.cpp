#include "diagnosis/covariate.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/constants.h"
#include "effects/registry.h"

namespace fathom {
namespace {

Covariate component(std::string name, std::string unit, Vector3d RowInfo::*member, int axis) {
  return {std::move(name), std::move(unit),
          [member, axis](const RowInfo& row) { return (row.*member)[axis]; }, 1, 6};
}

std::vector<Covariate> allOf(Channel channel) {
  std::vector<Covariate> all{
      {"time", "s", [](const RowInfo& row) { return row.t_s; }, 1, 10},
      {"speed", "m/s", [](const RowInfo& row) { return row.speed_m_s; }, 1, 6},
      {"turn rate", "deg/s", [](const RowInfo& row) { return row.turn_rate_rad_s; }, degrees(1.0), 6},
      {"depth", "m", [](const RowInfo& row) { return row.depth_m; }, 1, 6}};
  if (textOf(channel).is_of_images) {
    all.push_back({"range", "m", [](const RowInfo& row) { return row.range_m; }, 1, 6});
    all.push_back({"image radius", "1", [](const RowInfo& row) { return row.image_radius; }, 1, 6});
    all.push_back({"image x", "px", [](const RowInfo& row) { return row.pixel.x(); }, 1, 6,
                   [](const RowInfo& row) { return row.pixel_spread.x(); }});
    all.push_back({"image y", "px", [](const RowInfo& row) { return row.pixel.y(); }, 1, 6,
                   [](const RowInfo& row) { return row.pixel_spread.y(); }});
    if (channel == kChannel<EpipolarResidual>) return all;
    all.push_back(
        {"incidence", "deg", [](const RowInfo& row) { return row.incidence_rad; }, degrees(1.0), 6});
    all.push_back({"panel x", "m", [](const RowInfo& row) { return row.point_panel.x(); }, 1, 6,
                   [](const RowInfo& row) { return row.panel_spread.x(); }});
    all.push_back({"panel y", "m", [](const RowInfo& row) { return row.point_panel.y(); }, 1, 6,
                   [](const RowInfo& row) { return row.panel_spread.y(); }});
    if (channel == kChannel<Pixels>)
      all.push_back({"brightness", "DN", [](const RowInfo& row) { return row.level; }, 255, 6});
    return all;
  }
  for (const int axis : {0, 1, 2}) {
    const std::string name(1, "xyz"[axis]);
    all.push_back(component("velocity " + name, "m/s", &RowInfo::velocity_robot, axis));
    all.push_back(component("specific force " + name, "m/s²", &RowInfo::force_robot, axis));
  }
  return all;
}

}  // namespace

std::vector<Covariate> covariatesOf(const Linearization& linear, Channel channel) {
  std::vector<Covariate> varying;
  for (Covariate& covariate : allOf(channel)) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const RowInfo& row : linear.rows)
      if (row.channel == channel) {
        low = std::min(low, covariate.of(row));
        high = std::max(high, covariate.of(row));
      }
    if (high - low > kLeastSpread) varying.push_back(std::move(covariate));
  }
  return varying;
}

bool isCovariate(const std::string& name) {
  return std::any_of(kEveryChannel.begin(), kEveryChannel.end(), [&](Channel channel) {
    const std::vector<Covariate> all = allOf(channel);
    return std::any_of(all.begin(), all.end(), [&](const Covariate& c) { return c.name == name; });
  });
}

int componentOf(const RowInfo& row) {
  return row.channel == kChannel<Markers> ? row.component % 2 : row.component;
}

std::vector<Direction> directionsOf(const Linearization& linear, Channel channel) {
  const std::size_t rows = linear.rows.size();
  std::vector<Direction> directions;
  if (channel == kChannel<Markers>) {
    // A camera turned about its y axis sees all shifted to the side, about x up or down: by f per radian.
    const auto shift = [&](std::string name, std::size_t axis, int component) {
      Direction direction{std::move(name), std::vector<double>(rows, 0), component};
      const Eigen::Index column = columnOf(linear, kEffectIndex<CameraMisalignment>, axis);
      for (std::size_t i = 0; i < rows; ++i)
        if (linear.rows[i].channel == channel)
          direction.values[i] = linear.C(static_cast<Eigen::Index>(i), column);
      directions.push_back(std::move(direction));
    };
    shift("sideways", 1, 0);
    shift("up and down", 0, 1);
    // A pixel's worth: the columns are of a degree.
    const double noise_px = noiseUnit(linear, channel);
    for (Direction& direction : directions) {
      double square = 0, count = 0;
      for (const double value : direction.values)
        if (value != 0) square += value * value, ++count;
      // Half of the coordinates move.
      const double px = std::sqrt(2 * square / std::max(1.0, count)) * noise_px;
      for (double& value : direction.values) value /= px;
    }
    return directions;
  }
  for (int axis = 0; axis < 3; ++axis) {
    Direction direction{std::string(textOf(channel).components.at(static_cast<std::size_t>(axis))),
                        std::vector<double>(rows, 0), axis};
    bool any = false;
    for (std::size_t i = 0; i < rows; ++i)
      if (linear.rows[i].channel == channel && linear.rows[i].component == axis) {
        direction.values[i] = std::sqrt(linear.rows[i].robust_weight) * linear.rows[i].per_unit;
        any = true;
      }
    if (any) directions.push_back(std::move(direction));
  }
  return directions;
}

double noiseUnit(const Linearization& linear, Channel channel) {
  double information = 0, rows = 0;
  for (const RowInfo& row : linear.rows)
    if (row.channel == channel) {
      information += row.per_unit * row.per_unit;
      ++rows;
    }
  return rows > 0 ? std::sqrt(rows / information) : 0;
}

std::vector<double> binLimits(const Linearization& linear, Channel channel, const Covariate& covariate) {
  std::vector<double> values;
  for (const RowInfo& row : linear.rows)
    if (row.channel == channel && std::isfinite(covariate.of(row))) values.push_back(covariate.of(row));
  std::sort(values.begin(), values.end());
  std::vector<double> limits;
  for (int bin = 0; bin <= covariate.bins; ++bin) {
    const double limit = values[std::min(values.size() - 1, values.size() * static_cast<std::size_t>(bin) /
                                                                static_cast<std::size_t>(covariate.bins))];
    if (limits.empty() || limit > limits.back()) limits.push_back(limit);
  }
  if (limits.size() == 1) limits.push_back(limits[0]);
  return limits;
}

std::optional<std::size_t> binOf(const std::vector<double>& limits, double value) {
  if (!std::isfinite(value)) return std::nullopt;
  const auto above = std::upper_bound(limits.begin() + 1, limits.end() - 1, value);
  return static_cast<std::size_t>(above - limits.begin() - 1);
}

}  // namespace fathom
