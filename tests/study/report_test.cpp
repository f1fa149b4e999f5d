// The report is one folder that needs nothing else, and no text of its data becomes markup.
#include "study/report.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "images/image_file.h"
#include "tests/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

weft::Report sample() {
  weft::Image grey(8, 6, 3);
  std::fill(grey.values.begin(), grey.values.end(), 0.5F);
  weft::Report report;
  report.title = "Checker & <rings>";
  report.text = "Said \"so\".";
  report.footer = "2 cores";
  report.sections = {
      {"Scene <1>",
       "text",
       {{"Path tracer", {{"cube_raw", "raw <b>", "1.5 s", grey}, {"cube_cmf", "cmf", "", grey}}}},
       {{"Table", {{"name", "", false}, {"RMSE", "1/sr", true}}, {{"a<b", "0.5"}}, "note"}}}};
  return report;
}

}  // namespace

TEST_CASE("HTML's own characters are escaped") {
  CHECK(weft::html_escaped("<a href=\"x\">'&'</a>") ==
        "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  CHECK(weft::html_escaped("B \u2265 0") == "B \u2265 0");
}

TEST_CASE("A report has its page and its pictures in one folder and fetches nothing") {
  const TemporaryFolder folder;
  const fs::path index = weft::write_report(folder.path / "demo", sample());
  CHECK(index == folder.path / "demo" / "index.html");
  const std::string html = weft::read_text(index);
  CHECK_THAT(html, Contains("<title>Checker &amp; &lt;rings&gt;</title>"));
  CHECK_THAT(html, Contains("raw &lt;b&gt;") && Contains("a&lt;b") && Contains("Scene &lt;1&gt;"));
  CHECK_THAT(html, Contains("<img src=\"cube_raw.png\" width=\"8\" height=\"6\""));
  CHECK_THAT(html, Contains("prefers-color-scheme: dark"));
  for (const char* foreign : {"http:", "https:", "//", "<script", "@import", "url("}) {
    CHECK_THAT(html, !Contains(foreign));
  }
  CHECK(weft::read_image(folder.path / "demo" / "cube_raw.png", weft::Encoding::colour).values[0] ==
        Approx(0.5).margin(0.005));
  CHECK(fs::exists(folder.path / "demo" / "cube_cmf.png"));
}

TEST_CASE("A report that cannot be laid out is refused before anything is written") {
  const TemporaryFolder folder;
  weft::Report twice = sample();
  twice.sections[0].rows[0].pictures[1].name = "cube_raw";
  CHECK_THROWS_AS(weft::write_report(folder.path / "report", twice), weft::Error);
  weft::Report outside = sample();
  outside.sections[0].rows[0].pictures[1].name = "../cube";
  CHECK_THROWS_AS(weft::write_report(folder.path / "report", outside), weft::Error);
  weft::Report ragged = sample();
  ragged.sections[0].tables[0].rows[0].pop_back();
  CHECK_THROWS_AS(weft::write_report(folder.path / "report", ragged), weft::Error);
  CHECK_FALSE(fs::exists(folder.path / "report"));
}
