#include "report/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

Plot sinePlot(std::size_t points) {
  Series sine{.name = "sine"};
  for (std::size_t i = 0; i < points; ++i) {
    sine.x.push_back(0.01 * static_cast<double>(i));
    sine.y.push_back(std::sin(sine.x.back()));
  }
  Plot plot;
  plot.title = "a sine";
  plot.x_label = "time [s]";
  plot.y_label = "y [m]";
  plot.series = {sine};
  return plot;
}

TEST(Plot, IsAnSvgElementWithItsTextInIt) {
  const std::string svg = renderSvg(sinePlot(100));
  EXPECT_TRUE(svg.starts_with("<svg")) << svg.substr(0, 100);
  for (const char* text : {"a sine", "time [s]", "y [m]", "</svg>", "currentColor"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

TEST(Plot, SamePlotSameBytes) { EXPECT_EQ(renderSvg(sinePlot(5000)), renderSvg(sinePlot(5000))); }

TEST(Plot, TextCannotBreakOutOfTheScriptOrTheSvg) {
  Plot plot = sinePlot(10);
  plot.title = "it's <b> & \"100%\" `date` $x @y _sub ^sup {a}";
  plot.series[0].name = "END_OF_DATA\nquit";
  const std::string svg = renderSvg(plot);
  EXPECT_NE(svg.find("it's &lt;b> &amp;"), std::string::npos);
  EXPECT_NE(svg.find("`date` $x @y _sub ^sup {a}"), std::string::npos);
}

TEST(Plot, DrawsEveryStyleAndGaps) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Plot plot = sinePlot(200);
  plot.series[0].y[50] = nan;
  Series band{.name = "3 sigma", .x = plot.series[0].x, .style = Series::Style::kBand};
  for (const double y : plot.series[0].y) {
    band.lower.push_back(y - 0.5);
    band.upper.push_back(y + 0.5);
  }
  Series points{.name = "gated", .x = {0.5, 1.0}, .y = {0.1, nan}, .style = Series::Style::kPoints};
  Series dashed{.name = "limit", .x = {0, 2}, .y = {1, 1}, .style = Series::Style::kDashed};
  plot.series.insert(plot.series.end(), {band, points, dashed});
  const std::string svg = renderSvg(plot);
  EXPECT_NE(svg.find("3 sigma"), std::string::npos);
  EXPECT_NE(svg.find("dasharray"), std::string::npos);
  EXPECT_NE(svg.find("polygon"), std::string::npos);
}

TEST(Plot, ErrorBarsReachFromLowerToUpper) {
  Series bars{.name = "means", .x = {1, 2}, .y = {0, 0}, .style = Series::Style::kErrorBars};
  Plot plot;
  plot.y_range = {-10, 10};
  bars.lower = {-1, -1};
  bars.upper = {1, 1};
  plot.series = {bars};
  const std::string small = renderSvg(plot);
  plot.series[0].upper = {9, 9};
  EXPECT_NE(renderSvg(plot), small);
  plot.series[0].lower.pop_back();
  EXPECT_THROW(renderSvg(plot), std::invalid_argument);
}

TEST(Plot, NothingToDrawIsSaidNotAnError) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Plot plot;
  EXPECT_NE(renderSvg(plot).find("no data"), std::string::npos);
  plot.series = {{.name = "never", .x = {0, 1}, .y = {nan, nan}}};
  EXPECT_NE(renderSvg(plot).find("no data"), std::string::npos);
  plot.series = {{.name = "negative", .x = {0, 1}, .y = {-1, -2}}};
  plot.log_y = true;
  EXPECT_NE(renderSvg(plot).find("no data"), std::string::npos);
}

TEST(Plot, OneValueOnlyIsDrawn) {
  Plot plot;
  plot.series = {{.name = "constant", .x = {0, 1}, .y = {0, 0}}, {.name = "one", .x = {1}, .y = {2}}};
  EXPECT_NE(renderSvg(plot).find("constant"), std::string::npos);
}

TEST(Plot, ColumnsOfDifferentLengthAreRefused) {
  Plot plot;
  plot.series = {{.name = "bad", .x = {0, 1}, .y = {0}}};
  EXPECT_THROW(renderSvg(plot), std::invalid_argument);
}

/// PATH is this folder alone while the object lives.
class OnlyPath {
 public:
  explicit OnlyPath(const std::filesystem::path& folder) {
    if (const char* path = std::getenv("PATH")) path_ = path;
    setenv("PATH", folder.c_str(), 1);
  }
  ~OnlyPath() { setenv("PATH", path_.c_str(), 1); }
  OnlyPath(const OnlyPath&) = delete;
  OnlyPath& operator=(const OnlyPath&) = delete;

 private:
  std::string path_;
};

TEST(Plot, MissingGnuplotIsAnError) {
  const OnlyPath nothing(test::scratchFolder());
  try {
    renderSvg(sinePlot(10));
    ADD_FAILURE() << "drew without gnuplot";
  } catch (const Error& error) {
    EXPECT_EQ(error.file, "gnuplot");
    EXPECT_NE(error.why.find("gnuplot-nox"), std::string::npos);
  }
}

TEST(Plot, FailingGnuplotIsAnErrorWithItsComplaint) {
  const auto folder = test::scratchFolder();
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\necho no such terminal >&2\nexit 1\n";
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const OnlyPath broken(folder);
  try {
    renderSvg(sinePlot(10));
    ADD_FAILURE() << "took a failed run for a plot";
  } catch (const Error& error) {
    EXPECT_NE(error.why.find("no such terminal"), std::string::npos) << error.what();
  }
}

TEST(Thin, ShortSeriesStayWhole) {
  const std::vector<double> x{0, 1, 2, 3};
  EXPECT_EQ(thin({&x}, 1), (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_TRUE(thin({}).empty());
}

TEST(Thin, KeepsEverySpikeAndEndAndGap) {
  std::vector<double> x(100000), y(100000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<double>(i);
    y[i] = std::sin(1e-3 * x[i]);
  }
  y[12345] = 50;
  y[12346] = -50;
  y[77777] = std::numeric_limits<double>::quiet_NaN();
  y[0] = std::numeric_limits<double>::quiet_NaN();  // the first of its run: must not hide the run's extremes
  y[100] = 40;
  const auto kept = thin({&x, &y}, 400);
  EXPECT_LE(kept.size(), 5u * 400u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  for (const std::size_t i : {0u, 100u, 12345u, 12346u, 77777u, 99999u})
    EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), i)) << i;
}

TEST(Thin, EnvelopeOfEveryRunIsExact) {
  // A deterministic ragged series: in each run, smallest and largest kept equal those of all points.
  std::vector<double> y(10007);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = static_cast<double>((i * 7919) % 10007);
  const std::size_t runs = 100;
  const auto kept = thin({&y}, runs);
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t first = run * y.size() / runs, end = (run + 1) * y.size() / runs;
    const auto [low, high] = std::minmax_element(y.begin() + static_cast<std::ptrdiff_t>(first),
                                                 y.begin() + static_cast<std::ptrdiff_t>(end));
    double kept_low = 1e9, kept_high = -1e9;
    for (const std::size_t i : kept)
      if (i >= first && i < end) {
        kept_low = std::min(kept_low, y[i]);
        kept_high = std::max(kept_high, y[i]);
      }
    EXPECT_EQ(kept_low, *low);
    EXPECT_EQ(kept_high, *high);
  }
}

}  // namespace
}  // namespace fathom
