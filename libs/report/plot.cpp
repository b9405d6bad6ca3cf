#include "report/plot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <set>
#include <stdexcept>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/text.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Columns = std::vector<const std::vector<double>*>;

/// gnuplot draws text and axes in this colour, which no palette uses; it is then replaced by currentColor.
constexpr const char* kInk = "#010203";
constexpr const char* kGridInk = "#8a8f98";  // half-way, so that it shows on white and on dark

std::string number(double value) { return print("%.9g", value); }

/// A gnuplot string: in single quotes only the quote itself is special.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

Columns columnsOf(const Series& series) {
  Columns columns{&series.x};
  if (series.style != Series::Style::kBand) columns.push_back(&series.y);
  if (series.style == Series::Style::kBand || series.style == Series::Style::kErrorBars)
    columns.insert(columns.end(), {&series.lower, &series.upper});
  for (const auto* column : columns)
    if (column->size() != series.x.size())
      throw std::invalid_argument("plot series '" + series.name + "': columns of different lengths");
  return columns;
}

bool drawable(const Columns& columns, std::size_t i, bool log_y) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double value = (*columns[c])[i];
    if (!std::isfinite(value) || (log_y && c > 0 && value <= 0.0)) return false;
  }
  return true;
}

bool anyDrawable(const Plot& plot) {
  for (const auto& series : plot.series) {
    const Columns columns = columnsOf(series);
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (drawable(columns, i, plot.log_y)) return true;
  }
  return false;
}

/// A gnuplot data block, one point a line; an empty line lifts the pen.
std::string dataBlock(const std::string& name, const Series& series, bool log_y) {
  const Columns columns = columnsOf(series);
  std::string text = name + " << END_OF_DATA\n";
  for (const std::size_t i : thin(columns)) {
    if (drawable(columns, i, log_y))
      for (const auto* column : columns) text += number((*column)[i]) + " ";
    text += "\n";
  }
  return text + "END_OF_DATA\n";
}

std::string drawing(const std::string& data, const Series& series, const std::string& color) {
  const std::string paint = " lc rgb " + quoted(color);
  const std::string title = series.name.empty() ? " notitle" : " title " + quoted(series.name);
  switch (series.style) {
    case Series::Style::kLine:
      return data + " using 1:2 with lines lw 1.6" + paint + title;
    case Series::Style::kDashed:
      return data + " using 1:2 with lines dt (7,4) lw 1.6" + paint + title;
    case Series::Style::kPoints:
      return data + " using 1:2 with points pt 7 ps 0.4" + paint + title;
    case Series::Style::kErrorBars:
      // Not "with yerrorbars": to an SVG it paints a white ring about each point, over the bar.
      return data + " using 1:3:(0):($4-$3) with vectors nohead lw 1.4" + paint + " notitle, " + data +
             " using 1:2 with points pt 7 ps 0.6" + paint + title;
    case Series::Style::kBand:
      return data + " using 1:2:3 with filledcurves fs transparent solid 0.22 noborder" + paint + title;
  }
  throw std::logic_error("unknown series style");
}

/// Canvas in pixels. With equal axes as high as the data need, within reason, so that no paper is left empty.
std::string canvas(const Plot& plot) {
  if (!plot.equal_axes) return "860," + std::to_string(plot.height_px);
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (const auto& series : plot.series) {
    const Columns columns = columnsOf(series);
    for (std::size_t i = 0; i < series.x.size(); ++i)
      for (std::size_t c = 0; drawable(columns, i, plot.log_y) && c < columns.size(); ++c) {
        const std::size_t axis = c == 0 ? 0 : 1;
        low[axis] = std::min(low[axis], (*columns[c])[i]);
        high[axis] = std::max(high[axis], (*columns[c])[i]);
      }
  }
  const double across = high[0] - low[0], up = high[1] - low[1];
  const double height = across > 0 && up > 0 ? 140 + 620 * up / across : 500;
  return "760," + print("%.0f", std::clamp(height, 320.0, 760.0));
}

std::string axes(const Plot& plot) {
  const std::string ink = std::string(" tc rgb '") + kInk + "'";
  std::string text;
  text += "set terminal svg noenhanced size " + canvas(plot) + " font 'sans-serif,14'\n";
  text += "set encoding utf8\n";
  text += "set title " + quoted(plot.title) + ink + " font 'sans-serif,15'\n";
  text +=
      "set xlabel " + quoted(plot.x_label) + R"(."\n ")" + ink + " offset 0,0.4\n";  // keeps the legend off
  text += "set ylabel " + quoted(plot.y_label) + ink + "\n";
  text += std::string("set border 3 lw 1 lc rgb '") + kInk + "'\n";
  text += "set tics nomirror" + ink + "\n";
  text += std::string("set grid lw 0.5 lt 1 lc rgb '") + kGridInk + "'\n";
  text += "set key bmargin center horizontal" + ink + "\n";
  if (plot.equal_axes) text += "set size ratio -1\n";
  if (plot.log_y) text += "set logscale y\nset format y '%g'\n";
  if (plot.y_range)
    text += "set yrange [" + number(plot.y_range->first) + ":" + number(plot.y_range->second) + "]\n";
  return text;
}

std::string script(const Plot& plot) {
  std::string text = axes(plot);
  if (!anyDrawable(plot)) {
    text += "unset logscale\nset xrange [0:1]\nset yrange [0:1]\nset format ''\n";
    text += std::string("set label 'no data' at 0.5,0.5 center tc rgb '") + kInk + "'\nplot NaN notitle\n";
    return text;
  }
  std::string drawings;
  std::size_t next_color = 0;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    const std::string data = "$series" + std::to_string(i);
    text += dataBlock(data, series, plot.log_y);
    const std::string color =
        series.color.empty() ? kPalette[next_color++ % std::size(kPalette)] : series.color;
    drawings += (drawings.empty() ? "plot " : ", ") + drawing(data, series, color);
  }
  return text + drawings + "\n";
}

/// A folder of our own under the system's temporary folder, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "fathom-plot-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error(name, "", "cannot create a temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs gnuplot on a script file, its standard output to one file and its complaints to another. No shell, so
/// no file name is special. Returns the exit status.
int runGnuplot(const fs::path& script_file, const fs::path& svg_file, const fs::path& complaints_file) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, svg_file.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, complaints_file.c_str(), O_WRONLY | O_CREAT,
                                   0600);
  std::string program = "gnuplot", no_settings = "-d", file = script_file.string();
  std::array<char*, 4> arguments{program.data(), no_settings.data(), file.data(), nullptr};
  pid_t child = 0;
  const int problem = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0)
    throw Error("gnuplot", "", "cannot be run to draw a plot; is package gnuplot-nox installed?");
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void replaceAll(std::string& text, const std::string& what, const std::string& with) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
}

/// From gnuplot's SVG file to an <svg> element to be put into a page.
std::string tidied(std::string svg) {
  svg.erase(0, svg.find("<svg"));
  replaceAll(svg, "<svg", "<svg role=\"img\"");
  replaceAll(svg, "<title>Gnuplot</title>", "");  // would pop up over the plot
  for (const char* ink : {"rgb(  1,   2,   3)", "rgb(1,2,3)"}) replaceAll(svg, ink, "currentColor");
  replaceAll(svg, " color=\"black\"", "");  // what currentColor would mean otherwise
  return svg;
}

}  // namespace

std::vector<std::size_t> thin(const Columns& columns, std::size_t runs) {
  const std::size_t count = columns.empty() ? 0 : columns.front()->size();
  std::vector<std::size_t> kept;
  if (count <= 4 * runs) {
    for (std::size_t i = 0; i < count; ++i) kept.push_back(i);
    return kept;
  }
  for (std::size_t run = 0; run < runs; ++run) {
    const std::size_t first = run * count / runs, end = (run + 1) * count / runs;
    std::set<std::size_t> keep{first, end - 1};
    for (const auto* column : columns) {
      const auto at = [&](std::size_t i) { return (*column)[i]; };
      std::size_t low = first, high = first;
      for (std::size_t i = first; i < end; ++i) {
        // Written so that a NaN start gives way to the first number.
        if (!(at(low) <= at(i)) && !std::isnan(at(i))) low = i;
        if (!(at(high) >= at(i)) && !std::isnan(at(i))) high = i;
      }
      keep.insert({low, high});
      for (std::size_t i = first; i < end; ++i)
        if (std::isnan(at(i))) {
          keep.insert(i);
          break;
        }
    }
    kept.insert(kept.end(), keep.begin(), keep.end());
  }
  return kept;
}

std::string renderSvg(const Plot& plot) {
  const std::string text = script(plot);
  const TemporaryFolder folder;
  const auto script_file = folder.path() / "plot.gp", svg_file = folder.path() / "plot.svg",
             complaints_file = folder.path() / "complaints.txt";
  writeTextFile(script_file, text);
  const int status = runGnuplot(script_file, svg_file, complaints_file);
  if (interrupted()) throw Interrupted{};
  std::string svg = status == 0 ? readTextFile(svg_file) : "";
  if (svg.find("</svg>") == std::string::npos) {
    std::string complaint = readTextFile(complaints_file);
    replaceAll(complaint, "\n", " ");
    throw Error("gnuplot", "", "could not draw '" + plot.title + "': " + complaint);
  }
  return tidied(std::move(svg));
}

}  // namespace fathom
