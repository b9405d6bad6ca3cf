#include "report/html_report.h"

#include <algorithm>
#include <array>

#include "core/files.h"
#include "core/text.h"

namespace fathom {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --ink: #1c2128; --soft: #59636e; --paper: #ffffff; --card: #f6f8fa;
        --line: #d1d9e0; --warn: #9a3412; --warn-paper: #fff4ed; --accent: #0072b2; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ed; --soft: #9aa4af; --paper: #14181d; --card: #1c2229; --line: #343c45;
          --warn: #ffb38a; --warn-paper: #33200f; --accent: #56b4e9; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
       font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 2rem 1.25rem 3rem; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 1rem; }
h2 { font-size: 1.25rem; margin: 2.4rem 0 .6rem; padding-top: .6rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.6rem 0 .4rem; }
p { max-width: 46rem; margin: .6rem 0; }
.keys { display: grid; grid-template-columns: repeat(auto-fit, minmax(10.5rem, 1fr)); gap: .75rem; margin: 1rem 0; }
.keys div { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: .6rem .8rem; }
.keys dt { color: var(--soft); font-size: .85rem; }
.keys dd { margin: 0; font-size: 1.2rem; font-weight: 600; overflow-wrap: anywhere; }
.keys div { display: flex; flex-direction: column-reverse; justify-content: flex-end; }
.warning { border-left: 4px solid var(--warn); background: var(--warn-paper); padding: .6rem .9rem; margin: 1rem 0; }
.warning strong { color: var(--warn); }
.scroll { overflow-x: auto; margin: .8rem 0; }
.scroll button { float: right; position: sticky; right: 0; font-size: .75rem; color: var(--soft); background: var(--card);
                 border: 1px solid var(--line); border-radius: 4px; padding: .1rem .5rem; cursor: pointer; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); padding: .2rem 0; }
th, td { padding: .3rem .8rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { color: var(--soft); font-weight: 600; border-bottom-width: 2px; }
td.n, th.n { text-align: right; white-space: nowrap; }
figure { margin: 1rem 0; }
figure svg, figure img { display: block; width: 100%; height: auto; }
figure.square svg { max-width: 48rem; }
.slider { --at: 50%; max-width: 42rem; } .slider div { position: relative; } .slider input { width: 100%; margin: .4rem 0; }
.slider img + img { position: absolute; inset: 0; clip-path: inset(0 0 0 var(--at)); }
.shares div { display: flex; height: 1.6rem; border-radius: 4px; overflow: hidden; border: 1px solid var(--line); }
.shares ul { list-style: none; display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; padding: 0; margin: .5rem 0; }
.shares li i { display: inline-block; width: .8rem; height: .8rem; margin-right: .4rem; border-radius: 2px; }
figcaption { color: var(--soft); font-size: .92rem; max-width: 46rem; }
pre { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: .7rem .9rem;
      overflow-x: auto; font-size: .87rem; }
footer { margin-top: 3rem; padding-top: .8rem; border-top: 1px solid var(--line); color: var(--soft);
         font-size: .85rem; overflow-wrap: anywhere; }
@media print {
  :root { --ink: #000; --soft: #444; --paper: #fff; --card: #fff; --line: #bbb; --warn: #9a3412; --warn-paper: #fff; }
  main { max-width: none; padding: 0; }
  figure, tr, .warning, .keys div { break-inside: avoid; } h2, h3 { break-after: avoid; }
  .scroll { overflow: visible; } .scroll button { display: none; } }
)css";

/// Told apart by people who see colours differently (Okabe & Ito 2008).
constexpr std::array kShareColors{"#0072b2", "#e69f00", "#009e73", "#cc79a7",
                                  "#56b4e9", "#d55e00", "#f0e442"};

/// RFC 4180: a cell that holds what separates cells is quoted.
constexpr const char* kScript = R"js(
function csvOf(table) {
  const cell = c => /[",\n]/.test(c.textContent) ? '"' + c.textContent.replaceAll('"', '""') + '"' : c.textContent;
  return [...table.rows].map(row => [...row.cells].map(cell).join(',') + '\n').join('');
}
async function copyTable(button) {
  await navigator.clipboard.writeText(csvOf(button.parentNode.querySelector('table')));
  button.textContent = 'copied';
}
)js";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string element(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + escaped(text) + "</" + tag + ">\n";
}

/// An id may stand only once in a page, and gnuplot gives every plot the same ones.
std::string withOwnIds(std::string svg, const std::string& prefix) {
  for (const std::string before : {" id=\"", " id='", "\tid='", "href='#", "href=\"#", "url(#"})
    for (auto at = svg.find(before); at != std::string::npos; at = svg.find(before, at + 1))
      svg.insert(at + before.size(), prefix);
  return svg;
}

/// RFC 4648.
std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string dataUrl(const std::string& image) {
  const std::string kind = image.starts_with("\x89PNG") ? "png" : "jpeg";
  return "data:image/" + kind + ";base64," + base64(image);
}

/// Orange, through which white and dark paper show.
std::string shadeOf(const std::vector<double>& shades, std::size_t column) {
  if (column >= shades.size() || !(shades[column] > 0)) return "";
  return " style=\"background: rgb(213 94 0 / " + fixed(60 * std::min(1.0, shades[column]), 0) + "%)\"";
}

std::string tableRow(const Table& table, const std::vector<std::string>& row, const std::string& tag,
                     const std::vector<double>& shades = {}) {
  std::string html = "<tr>";
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    html.append("<").append(tag).append(isNumeric(table, column) ? " class=\"n\"" : "");
    html.append(shadeOf(shades, column)).append(">");
    html.append(escaped(column < row.size() ? row[column] : "")).append("</").append(tag).append(">");
  }
  return html + "</tr>\n";
}

}  // namespace

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) { body_ = element("h1", title_); }

void HtmlReport::heading(const std::string& text) { body_ += element("h2", text); }
void HtmlReport::subheading(const std::string& text) { body_ += element("h3", text); }
void HtmlReport::paragraph(const std::string& text) { body_ += element("p", text); }
void HtmlReport::preformatted(const std::string& text) { body_ += element("pre", text); }

void HtmlReport::warning(const std::string& text) {
  body_ += "<div class=\"warning\" role=\"note\"><strong>Warning:</strong> " + escaped(text) + "</div>\n";
}

void HtmlReport::keyValues(const std::vector<std::pair<std::string, std::string>>& values) {
  body_ += "<dl class=\"keys\">\n";
  for (const auto& [name, value] : values)
    body_ += "<div><dt>" + escaped(name) + "</dt><dd>" + escaped(value) + "</dd></div>\n";
  body_ += "</dl>\n";
}

void HtmlReport::shares(const std::vector<std::pair<std::string, double>>& parts,
                        const std::string& caption) {
  std::string bar, legend;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto& [name, share] = parts[k];
    const std::string color = kShareColors[k % kShareColors.size()];
    bar += print("<i style=\"flex-grow:%.4f;background:%s\"></i>", share, color.c_str());
    legend += print("<li><i style=\"background:%s\"></i>%s: %.3g %%</li>", color.c_str(),
                    escaped(name).c_str(), 100 * share);
  }
  body_ += "<figure class=\"shares\"><div>" + bar + "</div><ul>" + legend + "</ul>\n";
  if (!caption.empty()) body_ += element("figcaption", caption);
  body_ += "</figure>\n";
}

void HtmlReport::table(const Table& table, const std::string& caption) {
  body_ +=
      "<div class=\"scroll\"><button type=\"button\" onclick=\"copyTable(this)\">copy as "
      "CSV</button>\n<table>\n";
  if (!caption.empty()) body_ += element("caption", caption);
  body_ += "<thead>" + tableRow(table, table.header, "th") + "</thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    body_ += tableRow(table, table.rows[i], "td",
                      i < table.shades.size() ? table.shades[i] : std::vector<double>{});
  body_ += "</tbody></table></div>\n";
}

void HtmlReport::plot(const Plot& plot, const std::string& caption) {
  ++plots_;
  body_ += plot.equal_axes ? "<figure class=\"square\">\n" : "<figure>\n";
  body_ += withOwnIds(renderSvg(plot), "plot" + std::to_string(plots_) + "-");
  if (!caption.empty()) body_ += element("figcaption", caption);
  body_ += "</figure>\n";
}

void HtmlReport::picture(const std::string& image, const std::string& caption) {
  body_ += "<figure>\n<img alt=\"" + escaped(caption) + "\" src=\"" + dataUrl(image) + "\">\n";
  if (!caption.empty()) body_ += element("figcaption", caption);
  body_ += "</figure>\n";
}

void HtmlReport::slider(const std::string& left, const std::string& right, const std::string& caption) {
  body_ += "<figure class=\"slider\"><div>\n<img alt=\"" + escaped(caption) + "\" src=\"" + dataUrl(left) +
           "\">\n<img alt=\"\" src=\"" + dataUrl(right) +
           "\">\n</div>\n<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"" +
           escaped(caption) + "\" oninput=\"parentNode.style.setProperty('--at', value + '%')\">\n" +
           element("figcaption", caption) + "</figure>\n";
}

void HtmlReport::footer(const RunInfo& run) {
  body_ += "<footer>fathom " + escaped(run.version) + "<br>" + escaped(run.command_line) +
           (run.seed ? "<br>seed " + std::to_string(*run.seed) : "") + "</footer>\n";
}

std::string HtmlReport::html() const {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title_) + "</title>\n<style>" + kStyle + "</style>\n<script>" + kScript +
         "</script>\n</head>\n<body>\n<main>\n" + body_ + "</main>\n</body>\n</html>\n";
}

void HtmlReport::write(const std::filesystem::path& file) const { writeTextFile(file, html()); }

}  // namespace fathom
