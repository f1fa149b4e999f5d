// A report as a folder that anyone can open: index.html with its pictures beside it, nothing
// fetched from elsewhere.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "images/image.h"

namespace weft {

/// Every text here is plain: it is escaped when the page is written.
struct ReportPicture {
  std::string
      name;  ///< of its file, without ".png": letters, digits, '-', '_'; unique in the report
  std::string caption;  ///< what it shows
  std::string note;     ///< a smaller second line, e.g. numbers; may be empty
  Image image;          ///< linear, shown with 1 as white
};

/// Pictures that belong side by side.
struct ReportRow {
  std::string title;
  std::vector<ReportPicture> pictures;
};

struct ReportTable {
  struct Column {
    std::string name;
    std::string unit;       ///< in the head, below the name; may be empty
    bool is_number = true;  ///< numbers are set flush right
  };
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;  ///< as many cells each as columns
  std::string note;                            ///< below the table; may be empty
};

struct ReportSection {
  std::string title;
  std::string text;
  std::vector<ReportRow> rows;
  std::vector<ReportTable> tables;
};

struct Report {
  std::string title;
  std::string text;
  std::vector<ReportSection> sections;
  std::string footer;  ///< machine, command, date
};

/// Writes the pictures, then index.html. @return path of index.html.
/// @throws Error  where the folder cannot be written, a picture's name is unfit or used twice, or a
/// row of a table
///                has another number of cells than its columns.
std::filesystem::path write_report(const std::filesystem::path& folder, const Report& report);

/// The five characters that HTML gives a meaning, escaped for text and for attributes.
std::string html_escaped(std::string_view text);

}  // namespace weft
