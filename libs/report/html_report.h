#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/plot.h"
#include "report/run_info.h"
#include "report/table.h"

namespace fathom {

/// A report for people: one HTML file that needs nothing beside it (CSS and SVG inside; the little script
/// there is moves sliders and copies tables), for light and dark screens and for paper. Parts appear in the
/// order of the calls; all text is escaped.
class HtmlReport {
 public:
  explicit HtmlReport(std::string title);

  void heading(const std::string& text);     ///< a section
  void subheading(const std::string& text);  ///< within it
  void paragraph(const std::string& text);
  void warning(const std::string& text);  ///< a box that cannot be overlooked
  /// What matters most, each a large value above its name: {"final error", "0.42 m"}.
  void keyValues(const std::vector<std::pair<std::string, std::string>>& values);
  /// What something is made of, as one bar: names and shares, which are 1 together.
  void shares(const std::vector<std::pair<std::string, double>>& parts, const std::string& caption = "");
  void table(const Table& table, const std::string& caption = "");
  /// Draws at once. Throws as renderSvg does.
  void plot(const Plot& plot, const std::string& caption = "");
  /// The bytes of a PNG or JPEG file, kept inside the page.
  void picture(const std::string& image, const std::string& caption = "");
  /// Two images of one size, one over the other: left of a slider the first, right of it the second.
  void slider(const std::string& left, const std::string& right, const std::string& caption);
  /// Text as it is, in a fixed-width font: a file's content, a command.
  void preformatted(const std::string& text);
  void footer(const RunInfo& run);

  std::string html() const;
  /// Throws Error where the file cannot be written.
  void write(const std::filesystem::path& file) const;

 private:
  std::string title_, body_;
  int plots_ = 0;
};

}  // namespace fathom
