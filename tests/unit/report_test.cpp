#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/error.h"
#include "core/files.h"
#include "core/version.h"
#include "report/html_report.h"
#include "report/run_info.h"
#include "report/table.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

TEST(Table, AlignsNumbersRightAndTextLeft) {
  const Table table{{"label", "samples", "rate"},
                    {{"INS", "12345", "100.0 Hz"}, {"DVL", "7", "5.0 Hz"}, {"X"}}};
  EXPECT_EQ(formatTable(table),
            "label  samples      rate\n"
            "INS      12345  100.0 Hz\n"
            "DVL          7    5.0 Hz\n"
            "X\n");
}

TEST(Table, CountsCharactersNotBytes) {
  const Table table{{"axis", "σ"}, {{"αβ", "1"}, {"x", "22"}}};
  EXPECT_EQ(formatTable(table),
            "axis   σ\n"
            "αβ     1\n"
            "x     22\n");
}

TEST(Table, KnowsNumericColumns) {
  const Table table{{"a", "b", "c", "d", "e"},
                    {{"-0.5", "±2 cm", "2D", "-", "1e-3"}, {"inf", "12 %", "3", "", "10:30"}}};
  EXPECT_TRUE(isNumeric(table, 0));
  EXPECT_TRUE(isNumeric(table, 1));
  EXPECT_FALSE(isNumeric(table, 2));
  EXPECT_FALSE(isNumeric(table, 3)) << "nothing in it";
  EXPECT_TRUE(isNumeric(table, 4));
}

TEST(Table, FixedNumbers) {
  EXPECT_EQ(fixed(1.005, 1), "1.0");
  EXPECT_EQ(fixed(-0.0001, 2), "0.00");
  EXPECT_EQ(fixed(-1.5, 1), "-1.5");
  EXPECT_EQ(fixed(std::nan(""), 3), "-");
  EXPECT_EQ(fixed(-std::numeric_limits<double>::infinity(), 3), "-inf");
  EXPECT_EQ(fixed(1e300, 0).size(), 301u);
}

TEST(RunInfo, SaysHowToRepeatTheRun) {
  const auto json = toJson(RunInfo{.command_line = "fathom simulate --seed 7", .seed = 7});
  EXPECT_EQ(json["program"], "fathom");
  EXPECT_EQ(json["version"], programVersion());
  EXPECT_EQ(json["command_line"], "fathom simulate --seed 7");
  EXPECT_EQ(json["seed"], 7);
  EXPECT_TRUE(toJson(RunInfo{})["seed"].is_null());
}

TEST(RunInfo, JsonKeepsOrderAndTurnsNaNToNull) {
  const auto file = test::scratchFolder() / "new" / "result.json";
  nlohmann::ordered_json json;
  json["z_m"] = std::nan("");
  json["a_m"] = 0.1;
  json["name"] = "caf\xe9";  // Latin-1: not UTF-8
  writeJson(file, json);
  EXPECT_EQ(readTextFile(file), "{\n  \"z_m\": null,\n  \"a_m\": 0.1,\n  \"name\": \"caf\xEF\xBF\xBD\"\n}\n");
}

Plot smallPlot() {
  Plot plot;
  plot.title = "drift";
  plot.series = {{.name = "x", .x = {0, 1, 2}, .y = {0, 1, 0}, .style = Series::Style::kPoints}};
  return plot;
}

TEST(HtmlReport, ColoursAHeatMapsCells) {
  HtmlReport report("heat");
  report.table({{"sensor", "time"}, {{"dvl", "9.1"}, {"gyro", "1.0"}}, {{0, 5.0}}});
  const std::string html = report.html();
  EXPECT_NE(html.find("<td class=\"n\" style=\"background: rgb(213 94 0 / 60%)\">9.1</td>"),
            std::string::npos);
  EXPECT_NE(html.find("<td>dvl</td>"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"n\">1.0</td>"), std::string::npos);
}

TEST(HtmlReport, EscapesEveryText) {
  HtmlReport report("<script>alert(1)</script>");
  const std::string evil = "<b>\"&'";
  report.heading(evil);
  report.subheading(evil);
  report.paragraph(evil);
  report.warning(evil);
  report.preformatted(evil);
  report.keyValues({{evil, evil}});
  report.table({{evil}, {{evil}}}, evil);
  report.plot(smallPlot(), evil);
  report.footer({.command_line = evil, .seed = 3});
  const std::string html = report.html();
  EXPECT_EQ(html.find("<b>"), std::string::npos);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_NE(html.find("&lt;b&gt;&quot;&amp;'"), std::string::npos);
}

TEST(HtmlReport, NeedsNothingBesideIt) {
  HtmlReport report("alone");
  report.plot(smallPlot());
  const std::string html = report.html();
  // References to places within the page (#...) and the names of XML dialects are all there may be.
  const std::regex reference(R"((src|href)\s*=\s*["'](?!#))");
  EXPECT_FALSE(std::regex_search(html, reference));
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
}

TEST(HtmlReport, IdsStandOnceAndReferencesFindThem) {
  HtmlReport report("two plots");
  report.plot(smallPlot());
  report.plot(smallPlot());
  const std::string html = report.html();
  std::set<std::string> ids;
  const std::regex id(R"(\sid\s*=\s*["']([^"']+)["'])");
  for (std::sregex_iterator match(html.begin(), html.end(), id), end; match != end; ++match)
    EXPECT_TRUE(ids.insert((*match)[1]).second) << (*match)[1];
  EXPECT_GT(ids.size(), 2u);
  const std::regex reference(R"(href\s*=\s*["']#([^"']+)["'])");
  int references = 0;
  for (std::sregex_iterator match(html.begin(), html.end(), reference), end; match != end;
       ++match, ++references)
    EXPECT_TRUE(ids.contains((*match)[1])) << (*match)[1];
  EXPECT_GT(references, 0) << "points are drawn by reference";
}

TEST(HtmlReport, SameCallsSameBytes) {
  const auto make = [] {
    HtmlReport report("same");
    report.plot(smallPlot());
    return report.html();
  };
  EXPECT_EQ(make(), make());
}

TEST(HtmlReport, WritesWholeFileOrNone) {
  const auto folder = test::scratchFolder();
  HtmlReport("title").write(folder / "a" / "report.html");
  EXPECT_TRUE(readTextFile(folder / "a" / "report.html").ends_with("</html>\n"));
  writeTextFile(folder / "file", "");
  EXPECT_THROW(HtmlReport("title").write(folder / "file" / "report.html"), Error);
}

}  // namespace
}  // namespace fathom
