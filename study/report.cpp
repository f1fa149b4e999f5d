#include "study/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <system_error>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "images/image_file.h"

namespace weft {

namespace {

// Colours follow the reader's light or dark setting; pictures of a row shrink to fit and open in
// full size.
constexpr std::string_view style = R"css(
:root { color-scheme: light dark; --ink: #1d2127; --soft: #5b6570; --line: #d5dae0; --page: #fbfbfa; --card: #ffffff; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e8eb; --soft: #9aa4af; --line: #363c44; --page: #16181b; --card: #1f2226; }
}
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 1320px; margin: 0 auto; padding: 2rem 1.25rem 3rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .5rem; }
h2 { font-size: 1.35rem; margin: 2.5rem 0 .25rem; padding-top: 1rem; border-top: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.4rem 0 .5rem; color: var(--soft); font-weight: 600; }
p { max-width: 75ch; margin: .25rem 0 .75rem; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; align-items: flex-start; }
figure { margin: 0; padding: .6rem; background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  box-sizing: border-box; min-width: 0; }
figure img { display: block; width: 100%; height: auto; }
figcaption { margin-top: .45rem; font-weight: 600; }
figcaption small { display: block; color: var(--soft); font-weight: 400; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .86rem; }
th, td { padding: .35rem .5rem; border-bottom: 1px solid var(--line); text-align: left; white-space: nowrap; }
thead th { vertical-align: bottom; border-bottom-width: 2px; }
th small { display: block; color: var(--soft); font-weight: 400; }
.number { text-align: right; }
footer, .note { color: var(--soft); font-size: .88rem; }
footer { margin-top: 2.5rem; padding-top: 1rem; border-top: 1px solid var(--line); }
)css";

void check_names(const Report& report) {
  std::set<std::string> names;
  for (const ReportSection& section : report.sections) {
    for (const ReportRow& row : section.rows) {
      for (const ReportPicture& picture : row.pictures) {
        const bool fit = !picture.name.empty() &&
                         std::all_of(picture.name.begin(), picture.name.end(), [](unsigned char c) {
                           return std::isalnum(c) != 0 || c == '-' || c == '_';
                         });
        if (!fit)
          throw bad_input("report", "'" + picture.name + "' is no name for a picture's file");
        if (!names.insert(picture.name).second) {
          throw bad_input("report", "two pictures are named '" + picture.name + "'");
        }
      }
    }
  }
}

std::string paragraph(const std::string& text, const std::string& attributes = {}) {
  return text.empty() ? "" : fmt::format("<p{}>{}</p>\n", attributes, html_escaped(text));
}

std::string small(const std::string& text) {
  return text.empty() ? "" : fmt::format("<small>{}</small>", html_escaped(text));
}

/// Figures of a row grow in proportion to their aspect, so that all are equally high, a map with
/// its legend too.
std::string figure_html(const ReportPicture& picture) {
  constexpr double least_height = 220;  // pixels; a row that would be lower breaks instead
  constexpr int padding = 22;           // of a figure, both sides, with its border
  const double aspect = static_cast<double>(picture.image.width) / picture.image.height;
  const std::string caption = html_escaped(picture.caption);
  return fmt::format(
      "<figure style=\"flex: {5:.4f} 1 {6:.0f}px; max-width: {7}px\"><a href=\"{0}.png\"><img "
      "src=\"{0}.png\" "
      "width=\"{1}\" height=\"{2}\" alt=\"{3}\"></a><figcaption>{3}{4}</figcaption></figure>\n",
      picture.name, picture.image.width, picture.image.height, caption, small(picture.note), aspect,
      aspect * least_height, picture.image.width + padding);
}

std::string row_html(const ReportRow& row) {
  std::string html = row.title.empty() ? "" : fmt::format("<h3>{}</h3>\n", html_escaped(row.title));
  html += "<div class=\"row\">\n";
  for (const ReportPicture& picture : row.pictures) html += figure_html(picture);
  return html + "</div>\n";
}

std::string table_html(const ReportTable& table) {
  const auto alignment = [&](std::size_t i) {
    return table.columns[i].is_number ? " class=\"number\"" : "";
  };
  std::string html =
      table.title.empty() ? "" : fmt::format("<h3>{}</h3>\n", html_escaped(table.title));
  html += "<div class=\"scroll\"><table>\n<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    html += fmt::format("<th scope=\"col\"{}>{}{}</th>", alignment(i),
                        html_escaped(table.columns[i].name), small(table.columns[i].unit));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() != table.columns.size()) {
      throw bad_input("report", fmt::format("table '{}': a row has {} cells, expected {}",
                                            table.title, row.size(), table.columns.size()));
    }
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += fmt::format("<td{}>{}</td>", alignment(i), html_escaped(row[i]));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n" + paragraph(table.note, " class=\"note\"");
}

std::string page_html(const Report& report) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n",
      html_escaped(report.title), style);
  html += paragraph(report.text);
  for (const ReportSection& section : report.sections) {
    html += fmt::format("<section>\n<h2>{}</h2>\n", html_escaped(section.title));
    html += paragraph(section.text);
    for (const ReportRow& row : section.rows) html += row_html(row);
    for (const ReportTable& table : section.tables) html += table_html(table);
    html += "</section>\n";
  }
  if (!report.footer.empty())
    html += fmt::format("<footer>{}</footer>\n", html_escaped(report.footer));
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace

std::string html_escaped(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::filesystem::path write_report(const std::filesystem::path& folder, const Report& report) {
  check_names(report);
  const std::string page = page_html(report);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw failed(folder.string(), "cannot be made: " + error.message());
  for (const ReportSection& section : report.sections) {
    for (const ReportRow& row : section.rows) {
      for (const ReportPicture& picture : row.pictures) {
        write_image(folder / (picture.name + ".png"), picture.image, Encoding::colour);
      }
    }
  }
  const std::filesystem::path index = folder / "index.html";
  write_text_atomically(index, page);
  return index;
}

}  // namespace weft
