#include "reports/diagnosis_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/text.h"

namespace fathom {
namespace {

constexpr const char* kBeforeColor = "#d55e00";
constexpr const char* kAfterColor = "#0072b2";
constexpr const char* kBlackBoxColor = "#009e73";
constexpr const char* kNoiseColor = "#cc79a7";

/// Whether its residuals have a sign.
bool hasMeans(const Mismatch& mismatch) { return !mismatch.direction.empty(); }

/// Means in each bin as far as noise lets them scatter; of what has no direction, how unlikely each bin is.
Series binSeries(const Mismatch& mismatch, const std::string& name, const char* color) {
  Series series{.name = name, .style = Series::Style::kPoints, .color = color};
  if (hasMeans(mismatch)) series.style = Series::Style::kErrorBars;
  for (const MismatchBin& bin : mismatch.bins) {
    if (bin.rows == 0) continue;
    series.x.push_back(0.5 * (bin.low + bin.high));
    series.y.push_back(hasMeans(mismatch) ? bin.mean_raw : bin.size_sigma);
    if (!hasMeans(mismatch)) continue;
    series.lower.push_back(bin.mean_raw - bin.sigma);
    series.upper.push_back(bin.mean_raw + bin.sigma);
  }
  return series;
}

std::string withUnit(const std::string& name, const std::string& unit) {
  return unit.empty() || unit == "1" ? name : name + " [" + unit + "]";
}

/// A level line a block, with a gap between blocks.
Series blockSeries(const HeldOut& heldout, double HeldOut::Block::*value, const char* name,
                   const char* color) {
  Series series{.name = name, .color = color};
  for (const HeldOut::Block& block : heldout.blocks) {
    series.x.insert(series.x.end(), {block.from_s, block.to_s, block.to_s});
    series.y.insert(series.y.end(), {block.*value, block.*value, std::nan("")});
  }
  return series;
}

// ---- raw residuals

/// Of one channel, a cloud a component.
std::vector<Series> clouds(Channel channel, const Linearization& linear) {
  const ChannelText& text = textOf(channel);
  const auto count = static_cast<std::size_t>(text.component_count);
  std::vector<Series> components;
  for (std::size_t c = 0; c < count; ++c)
    components.push_back(
        {.name = count > 1 ? std::string(text.components[c]) : "", .style = Series::Style::kPoints});
  const double scale = text.scale;
  for (const RowInfo& row : linear.rows) {
    if (row.channel != channel) continue;
    Series& series = components[static_cast<std::size_t>(row.component) % count];
    series.x.push_back(row.t_s);
    series.y.push_back(row.raw * scale);
  }
  return components;
}

Plot cloudPlot(Channel channel, const Linearization& linear, const char* when) {
  Plot plot{.title = "Residuals of " + nameOf(channel) + when,
            .x_label = "time [s]",
            .y_label = "residual [" + std::string(textOf(channel).unit) + "]",
            .series = clouds(channel, linear)};
  plot.height_px = 300;
  return plot;
}

double largest(const Plot& plot) {
  double value = 0;
  for (const Series& series : plot.series)
    for (const double y : series.y)
      if (std::isfinite(y)) value = std::max(value, std::abs(y));
  return value;
}

std::optional<Linearization> residualsOf(const BatchData& data, const BatchEstimate& estimate,
                                         const BatchOptions& options) {
  if (!estimate.succeeded) return {};
  return linearize(data, *problemAt(data, estimate, options), false);
}

// ---- brightness against range

constexpr int kRangeBins = 24;

bool isOn(const RowInfo& row, const BatchData& data, ImagePatch::Surface surface, int colour) {
  return row.patch >= 0 && row.component == colour &&
         data.patches[static_cast<std::size_t>(row.patch)].surface == surface;
}

Series recordedSeries(const Linearization& linear, const BatchData& data, ImagePatch::Surface surface,
                      int colour, const std::string& name, const char* color) {
  Series series{.name = name, .style = Series::Style::kPoints, .color = color};
  for (const RowInfo& row : linear.rows) {
    if (!isOn(row, data, surface, colour)) continue;
    series.x.push_back(row.range_m);
    series.y.push_back((row.level + row.raw) * Pixels::channel.scale);
  }
  return series;
}

/// Means in bins of range: what a patch should read depends on more than its range.
Series modelSeries(const Linearization& linear, const BatchData& data, ImagePatch::Surface surface,
                   int colour, const std::string& name, const char* color, Series::Style style) {
  struct Bin {
    double range_m = 0, level = 0, rows = 0;
  };
  const Series all = recordedSeries(linear, data, surface, colour, "", color);
  Series series{.name = name, .style = style, .color = color};
  if (all.x.empty()) return series;
  const auto [least, most] = std::minmax_element(all.x.begin(), all.x.end());
  std::array<Bin, kRangeBins> bins{};
  for (const RowInfo& row : linear.rows) {
    if (!isOn(row, data, surface, colour)) continue;
    const double at = (row.range_m - *least) / std::max(*most - *least, 1e-9) * kRangeBins;
    Bin& bin = bins[static_cast<std::size_t>(std::clamp(static_cast<int>(at), 0, kRangeBins - 1))];
    bin.range_m += row.range_m;
    bin.level += row.level * Pixels::channel.scale;
    ++bin.rows;
  }
  for (const Bin& bin : bins) {
    if (bin.rows == 0) continue;
    series.x.push_back(bin.range_m / bin.rows);
    series.y.push_back(bin.level / bin.rows);
  }
  return series;
}

}  // namespace

BeforeAndAfter::BeforeAndAfter(const DiagnosisStory& story) {
  const Diagnosis& d = story.diagnosis;
  before = residualsOf(story.read.input.data, d.before, d.before_options);
  if (!d.effects.empty()) after = residualsOf(story.read.input.data, d.after, d.after_options);
}

std::vector<Plot> brightnessPlots(const DiagnosisStory& story, const BeforeAndAfter& residuals) {
  using Surface = ImagePatch::Surface;
  const BatchData& data = story.read.input.data;
  const auto& [before, after] = residuals;
  if (data.patches.empty() || !before) return {};
  std::vector<Plot> plots;
  for (int colour = 0; colour < 3; ++colour) {
    Plot plot{.title = std::string("White and black of the markers, ") +
                       std::string(Pixels::channel.components[static_cast<std::size_t>(colour)]),
              .x_label = "range [m]",
              .y_label = "linear brightness [" + std::string(Pixels::channel.unit) + "]"};
    plot.height_px = 320;
    const auto model = [&](const Linearization& linear, Surface surface, const char* name, const char* color,
                           Series::Style style) {
      plot.series.push_back(
          modelSeries(linear, data, surface, colour, surface == Surface::white ? name : "", color, style));
    };
    plot.series.push_back(recordedSeries(*before, data, Surface::white, colour, "white", kPalette[4]));
    plot.series.push_back(recordedSeries(*before, data, Surface::black, colour, "black", kNoiseColor));
    for (const Surface surface : {Surface::white, Surface::black}) {
      model(*before, surface, "nominal model", kBeforeColor, Series::Style::kDashed);
      if (after) model(*after, surface, "with what was found", kAfterColor, Series::Style::kLine);
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

Plot covariatePlot(const Mismatch& before, const Mismatch* after) {
  Plot plot{.title = sensorOf(before) + ": " + before.statistic + " against " + before.against,
            .x_label = withUnit(before.against, before.unit),
            .y_label = hasMeans(before) ? withUnit("mean", before.raw_unit) : "size [sigma]"};
  plot.height_px = 320;
  plot.series.push_back(binSeries(before, after != nullptr ? "before" : "", kBeforeColor));
  if (after != nullptr) plot.series.push_back(binSeries(*after, "after", kAfterColor));
  return plot;
}

Plot heldOutPlot(const HeldOut& heldout) {
  Plot plot{.title = heldout.metric + " on stretches that the fit did not see",
            .x_label = "time [s]",
            .y_label = heldout.metric};
  using Block = HeldOut::Block;
  plot.series = {blockSeries(heldout, &Block::before, "before", kBeforeColor),
                 blockSeries(heldout, &Block::after, "after", kAfterColor),
                 blockSeries(heldout, &Block::black_box, "black box", kBlackBoxColor)};
  Series noise{.name = "noise alone", .style = Series::Style::kDashed, .color = kNoiseColor};
  if (!heldout.blocks.empty()) {
    noise.x = {heldout.blocks.front().from_s, heldout.blocks.back().to_s};
    noise.y = {heldout.noise_floor, heldout.noise_floor};
  }
  plot.series.push_back(noise);
  double most = heldout.noise_floor;
  for (const Block& block : heldout.blocks) most = std::max({most, block.before, block.after});
  if (most > 0) plot.y_range = {0, 1.1 * most};
  return plot;
}

std::vector<Plot> residualPlots(const DiagnosisStory& story, const BeforeAndAfter& residuals) {
  const auto& [before, after] = residuals;
  std::vector<Plot> plots;
  if (!before) return plots;
  for (const auto& [channel, residual] : story.diagnosis.before.residuals) {
    if (channel == kChannel<Prior> || residual.rows == 0) continue;
    plots.push_back(cloudPlot(channel, *before, after ? ", before" : ""));
    if (!after) continue;
    Plot then = cloudPlot(channel, *after, ", after");
    if (const double most = 1.05 * std::max(largest(plots.back()), largest(then)); most > 0)
      then.y_range = plots.back().y_range = {{-most, most}};
    plots.push_back(std::move(then));
  }
  return plots;
}

}  // namespace fathom
