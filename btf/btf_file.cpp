#include "btf/btf_file.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "btf/sampling_json.h"
#include "btf/view_file.h"

namespace weft {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int file_version = 1;
constexpr const char* unfinished = "unfinished.json";

std::string pixel_type_name(PixelType type) {
  return type == PixelType::half ? "half" : "float";
}

/// "LINE:COLUMN" of a byte of the text, counted from 1; one more than it has is its end.
std::string place_of_byte(const std::string& text, std::size_t byte) {
  const std::string_view before = std::string_view(text).substr(0, byte > 0 ? byte - 1 : 0);
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;
  return fmt::format("{}:{}", line, column);
}

Json parse(const fs::path& path) {
  const std::string text = read_text(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw bad_input(fmt::format("{}:{}", path.string(), place_of_byte(text, error.byte)),
                    error.byte > text.size() ? "is not JSON: the file ends here, in the middle"
                                             : "is not JSON from here on",
                    "the file is truncated or was changed; copy or trace the dataset again");
  } catch (const Json::out_of_range&) {
    throw bad_input(path.string(), "holds a number that is too large");
  }
}

// A view that is whole but another one than the description was written for.
void check_checksum(const fs::path& path, const Json& checksums) {
  const std::string name = path.filename().string();
  if (!fs::exists(path)) throw bad_input(path.string(), "is missing");
  if (!checksums.contains(name) || file_checksum(path) != checksums.at(name)) {
    throw bad_input(path.string(), "is not the file that btf.json tells of: its checksum differs",
                    "`weft validate` lists all that differ; copy or trace the dataset again");
  }
}

Error other_settings(const fs::path& folder, const std::string& file, const std::string& found,
                     const BtfHeader& header) {
  const Json difference =
      Json::diff(Json::parse(found, nullptr, false), Json::parse(header.provenance));
  const std::string where =
      difference.empty() ? "" : "; they differ in " + difference[0].value("path", "");
  return bad_input(folder.string(), "holds views of other settings (" + file + where + ")",
                   "choose another folder, or remove this one");
}

// A codec's folder keeps its own description: with both in it, nobody could say what it holds.
void check_place(const fs::path& folder) {
  if (folder.empty()) throw bad_input("dataset", "its folder has no name", "expected NAME.btf");
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw bad_input(folder.string(), "is a file; a dataset is a folder", "choose another name");
  }
  if (fs::exists(folder / "codec.json")) {
    throw bad_input(folder.string(), "holds a compressed dataset, as its codec.json says",
                    "choose another folder, or remove this one");
  }
}

// Runs `body` on [0, count) with all threads. What the first of them throws is thrown, whatever the
// threads.
template <typename Body>
void for_each_in_parallel(std::size_t count, const Body& body) {
  std::vector<std::exception_ptr> failures(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    try {
      body(i);
    } catch (...) {
      failures[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

// Whether there is any view. Throws where one is of other settings.
bool check_views(const fs::path& folder, const BtfHeader& header) {
  std::vector<fs::path> views;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("view_") && entry.path().extension() == ".exr")
      views.push_back(entry.path());
  }
  std::ranges::sort(views);
  for_each_in_parallel(views.size(), [&](std::size_t i) {
    const std::string found = read_view_header(views[i]).provenance;
    if (found != header.provenance)
      throw other_settings(folder, views[i].filename().string(), found, header);
  });
  return !views.empty();
}

// Says whose the folder is while no view does, so that a run of other settings that begins at the
// same time is refused before it works.
void claim(const fs::path& folder, const BtfHeader& header) {
  const Json json = {{"provenance", Json::parse(header.provenance)}};
  const fs::path path = folder / unfinished;
  if (create_text_atomically(path, json.dump(1) + "\n")) return;
  const Json found = parse(path);
  if (found != json) {
    throw other_settings(folder, unfinished, found.value("provenance", Json()).dump(), header);
  }
}

}  // namespace

std::string view_file_name(std::size_t view) {
  return fmt::format("view_{:03}.exr", view);
}

BtfWriter::BtfWriter(fs::path folder, BtfHeader header)
    : folder_(std::move(folder)),
      header_(std::move(header)),
      exceptions_(std::uncaught_exceptions()) {
  check_place(folder_);
  made_folder_ = !fs::exists(folder_);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw failed(folder_.string(), "cannot be created: " + error.message());
  remove_abandoned(folder_);
  if (!check_views(folder_, header_)) claim(folder_, header_);
}

BtfWriter::~BtfWriter() {
  if (!made_folder_ || std::uncaught_exceptions() == exceptions_) return;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    if (entry.path().filename() != unfinished) return;
  }
  fs::remove(folder_ / unfinished, ignored);
  fs::remove(folder_, ignored);
}

fs::path BtfWriter::view_path(std::size_t view) const {
  return folder_ / view_file_name(view);
}

bool BtfWriter::has_view(std::size_t view) const {
  return fs::exists(view_path(view));
}

void BtfWriter::write_view(std::size_t view, const ViewData& data) {
  check_storable(view, data.values, header_.width, header_.height, header_.pixel_type);
  std::error_code ignored;                   // told by what follows
  fs::create_directories(folder_, ignored);  // another writer that failed may have removed it
  const ViewFileHeader file{header_.width, header_.height, header_.pixel_type, header_.provenance};
  write_view_file(view_path(view), file, header_.views[view], header_.lights.directions(), data);
}

namespace {

std::vector<std::size_t> views_without_file(const fs::path& folder, const BtfHeader& header) {
  std::vector<std::size_t> missing;
  for (std::size_t v = 0; v < header.views.size(); ++v) {
    if (!fs::exists(folder / view_file_name(v))) missing.push_back(v);
  }
  return missing;
}

}  // namespace

std::vector<std::size_t> missing_views(const fs::path& folder, const BtfHeader& header) {
  check_place(folder);
  if (fs::is_directory(folder)) check_views(folder, header);
  return views_without_file(folder, header);
}

void finish_btf(const fs::path& folder, const BtfHeader& header) {
  check_place(folder);
  const std::vector<std::size_t> missing = views_without_file(folder, header);
  if (!missing.empty()) {
    throw bad_input(folder.string(), "has no " + view_file_name(missing.front()) + " yet");
  }
  std::vector<std::vector<float>> errors(header.views.size());
  std::vector<std::string> checksums(header.views.size());
  for_each_in_parallel(header.views.size(), [&](std::size_t v) {
    const fs::path path = folder / view_file_name(v);
    ViewNotes notes = read_view_notes(path);
    if (notes.provenance != header.provenance)
      throw other_settings(folder, view_file_name(v), notes.provenance, header);
    errors[v] = std::move(notes.standard_errors);
    checksums[v] = file_checksum(path);
  });
  Json files = Json::object();
  Json noise = Json::array();
  for (std::size_t v = 0; v < header.views.size(); ++v) {
    if (!errors[v].empty()) noise.push_back(errors[v]);
    files[view_file_name(v)] = checksums[v];
  }
  Json json = {{"format", "weft-btf"},
               {"version", file_version},
               {"quantity", header.quantity},
               {"texels", {header.width, header.height}},
               {"pixel", pixel_type_name(header.pixel_type)},
               {"tile_size", header.tile_size},
               {"views", sampling_to_json(header.views)},
               {"lights", sampling_to_json(header.lights)},
               {"provenance", Json::parse(header.provenance)}};
  if (noise.size() == header.views.size()) {
    json["noise"] = {{"standard_error_of_pair_means", noise}};
  }
  json["xxh3_128"] = files;
  write_text_atomically(folder / "btf.json", json.dump(1) + "\n");
  remove_abandoned(folder);
  fs::remove(folder / unfinished);
}

BtfHeader read_btf_header(const fs::path& folder) {
  const fs::path path = folder / "btf.json";
  if (!fs::is_directory(folder))
    throw bad_input(folder.string(), "is not a BTF dataset (a folder)");
  if (!fs::exists(path) && fs::exists(folder / "codec.json")) {
    throw bad_input(folder.string(), "is compressed already: it holds codec.json and no btf.json",
                    "name the raw BTF that it was made of");
  }
  if (!fs::exists(path)) {
    throw bad_input(path.string(), "is missing",
                    "an unfinished acquisition has none: run it again to continue");
  }
  const Json json = parse(path);
  const std::string where = path.string();
  try {
    if (json.value("format", "") != "weft-btf")
      throw bad_input(where, "is not the description of a BTF");
    if (const int version = json.at("version"); version != file_version) {
      throw bad_input(where,
                      fmt::format("has version {}; this program reads {}", version, file_version));
    }
    BtfHeader header{
        .version = file_version,
        .quantity = json.at("quantity"),
        .width = json.at("texels").at(0),
        .height = json.at("texels").at(1),
        .views = sampling_from_json(json.at("views"), where + ", views"),
        .lights = sampling_from_json(json.at("lights"), where + ", lights"),
        .pixel_type = json.at("pixel") == "half" ? PixelType::half : PixelType::float32,
        .tile_size = json.at("tile_size"),
        .provenance = json.at("provenance").dump(),
        .standard_errors = {},
    };
    if (json.contains("noise")) {
      for (const auto& view : json.at("noise").at("standard_error_of_pair_means")) {
        for (const auto& light : view) header.standard_errors.push_back(light);
      }
    }
    if (header.width < 1 || header.height < 1)
      throw bad_input(where, "texels must be at least 1 x 1");
    return header;
  } catch (const Json::exception& error) {
    throw bad_input(where, std::string("cannot be understood: ") + error.what());
  }
}

namespace {

// How many threads may hold a view's floats at once.
int readers(const Btf& btf, std::size_t values) {
  const int threads = tbb::this_task_arena::max_concurrency();
  if (!btf.memory()) return threads;
  const std::size_t fit = btf.memory()->left() / (values * sizeof(float));
  return static_cast<int>(std::clamp<std::size_t>(fit, 1, threads));
}

// Views `first` and on of a dataset, all that `part` has.
void read_views(const fs::path& folder, const Json& checksums, std::size_t first, Btf& part) {
  const std::size_t values =
      3 * static_cast<std::size_t>(part.width()) * part.height() * part.lights().size();
  tbb::task_arena arena(readers(part, values));
  // Views are independent, and no two write to the same values.
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, part.views().size(), [&](std::size_t v) {
      const fs::path path = folder / view_file_name(first + v);
      check_checksum(path, checksums);
      part.set_view(v, read_view_values(path, part.width(), part.height(), part.lights().size()));
    });
  });
}

}  // namespace

Btf read_btf(const fs::path& folder, std::shared_ptr<MemoryBudget> memory) {
  const BtfHeader header = read_btf_header(folder);
  Btf btf(header.width, header.height, header.views, header.lights, header.pixel_type,
          std::move(memory));
  btf.tile_size = header.tile_size;
  btf.provenance = header.provenance;
  const Json checksums = parse(folder / "btf.json").at("xxh3_128");
  if (!btf.mapped()) {
    read_views(folder, checksums, 0, btf);
    return btf;
  }
  // Many views together are written texel by texel, so that each page is filled at once.
  const std::size_t at_once = btf.views_at_once();
  for (std::size_t first = 0; first < header.views.size(); first += at_once) {
    Btf part = btf.blank_views(first, std::min(at_once, header.views.size() - first));
    read_views(folder, checksums, first, part);
    btf.set_views(first, part);
  }
  return btf;
}

void write_btf(const fs::path& folder, const Btf& btf) {
  BtfHeader header{.width = btf.width(),
                   .height = btf.height(),
                   .views = btf.views(),
                   .lights = btf.lights(),
                   .pixel_type = btf.pixel_type(),
                   .tile_size = btf.tile_size,
                   .provenance = btf.provenance,
                   .standard_errors = {}};
  BtfWriter writer(folder, std::move(header));
  for_some_views(btf, [&](std::size_t first, const Btf& part) {
    for (std::size_t v = 0; v < part.views().size(); ++v) {
      const std::vector<float> values = part.view_values(v);
      writer.write_view(first + v, {.values = values});
    }
  });
  writer.finish();
}

std::vector<std::string> corrupted_files(const fs::path& folder) {
  const Json json = parse(folder / "btf.json");
  std::vector<std::string> corrupted;
  for (const auto& [name, checksum] : json.at("xxh3_128").items()) {
    if (!fs::exists(folder / name) || file_checksum(folder / name) != checksum)
      corrupted.push_back(name);
  }
  return corrupted;
}

}  // namespace weft
