#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fathom {

/// One curve, cloud of points, with error bars or without, or shaded band. NaN in any column makes a gap.
struct Series {
  enum class Style { kLine, kDashed, kPoints, kErrorBars, kBand };

  std::string name{};       ///< legend; empty: not listed
  std::vector<double> x{};  ///< plot units, see Plot's labels
  std::vector<double> y{};  ///< as long as x; empty for a band
  Style style = Style::kLine;
  std::vector<double> lower{}, upper{};  ///< band and error bars only, as long as x
  std::string color{};                   ///< "#rrggbb"; empty: the next of the palette
};

/// Okabe & Ito's colours (2008), which colour-blind readers tell apart, without its black and yellow: these
/// six show on white and on dark paper.
inline constexpr const char* kPalette[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

struct Plot {
  std::string title{};
  std::string x_label{}, y_label{};  ///< with unit, "time [s]"
  std::vector<Series> series{};
  bool equal_axes = false;  ///< one metre is as long across as up: for maps
  bool log_y = false;
  int height_px = 380;  ///< of the canvas, legend included; not with equal axes
  std::optional<std::pair<double, double>> y_range{};  ///< absent: what the data needs
};

/// The plot as the text of an `<svg>` element, drawn by gnuplot. The same plot gives the same bytes. Text and
/// axes are in currentColor, so that a page's own text colour holds in light and dark. A long series is drawn
/// from the points that thin() keeps. Throws Error where gnuplot is missing or fails, std::invalid_argument
/// where a series' columns differ in length.
std::string renderSvg(const Plot& plot);

/// Indices, ascending, of the points to draw so that a line through them looks as through all: of each run of
/// consecutive points the first, the last and every column's smallest and largest stay, so no spike is lost
/// (Jugel et al. 2014, "M4"), and one NaN stays where there is any, so no gap is bridged. Columns are of
/// equal length; all indices where that length is at most 4 * runs.
std::vector<std::size_t> thin(const std::vector<const std::vector<double>*>& columns, std::size_t runs = 400);

}  // namespace fathom
