// weft info: what a dataset is, without rendering it: sizes, directions, bytes, parameters,
// provenance.

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "btf/atomic_file.h"
#include "btf/btf_file.h"
#include "btf/direction.h"
#include "btf/error.h"
#include "cli/command.h"
#include "codecs/raw/raw_representation.h"
#include "codecs/representation.h"
#include "study/asymmetry.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::uintmax_t bytes_on_disk(const fs::path& folder) {
  std::uintmax_t sum = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) sum += entry.file_size();
  }
  return sum;
}

ordered_json describe_directions(const HemisphereSampling& sampling) {
  float lowest = 0;
  for (const Direction& d : sampling.directions()) lowest = std::max(lowest, theta_of(d));
  return {{"count", sampling.size()}, {"largest_theta", degrees(lowest)}};
}

/// The header only: a raw BTF's pixels may be gigabytes.
ordered_json describe_raw(const fs::path& folder) {
  const BtfHeader header = read_btf_header(folder);
  const std::size_t pairs = header.views.size() * header.lights.size();
  const std::size_t bytes =
      raw_texture_bytes(header.width, header.height, pairs, header.pixel_type);
  return {{"codec", "raw"},
          {"quantity", header.quantity},
          {"texels", {header.width, header.height}},
          {"tile_size", header.tile_size},
          {"views", describe_directions(header.views)},
          {"lights", describe_directions(header.lights)},
          {"pixel", header.pixel_type == PixelType::half ? "half" : "float"},
          {"bytes", bytes},
          {"ratio", compression_ratio({header.width, header.height}, pairs, bytes)}};
}

ordered_json describe_compressed(const fs::path& folder) {
  const auto representation = open_representation(folder);
  const Imath::V2i texels = representation->texels();
  return {{"codec", representation->codec()},
          {"texels", {texels.x, texels.y}},
          {"views", describe_directions(representation->views())},
          {"lights", describe_directions(representation->lights())},
          {"levels_of_detail", representation->has_lod()},
          {"bytes", representation->bytes()},
          {"constant_bytes", representation->constant_bytes()},
          {"ratio", compression_ratio(*representation)}};
}

void append_numbers(const ordered_json& value, std::vector<double>& numbers) {
  if (value.is_number()) numbers.push_back(value.get<double>());
  if (!value.is_array()) return;
  for (const ordered_json& item : value) append_numbers(item, numbers);
}

/// A value on one line; of a matrix that would fill the terminal (the noise of every pair), what it
/// spans.
std::string in_a_line(const ordered_json& value) {
  constexpr std::size_t shown_whole = 16;
  if (value.is_string()) return value.get<std::string>();
  std::vector<double> numbers;
  append_numbers(value, numbers);
  if (numbers.size() <= shown_whole) return value.dump();
  const auto [least, largest] = std::ranges::minmax(numbers);
  const double mean = std::accumulate(numbers.begin(), numbers.end(), 0.0) / numbers.size();
  return fmt::format("{} numbers: least {:.4g}, mean {:.4g}, largest {:.4g}", numbers.size(), least,
                     mean, largest);
}

/// One line a value; tables indented below their name.
void print(const ordered_json& value, const Session& session, const std::string& indent) {
  for (const auto& [key, item] : value.items()) {
    const bool table = item.is_object() && !item.empty();
    session.say(
        fmt::format("{}{:<{}} {}", indent, key, 20 - indent.size(), table ? "" : in_a_line(item)));
    if (table) print(item, session, indent + "  ");
  }
}

struct InfoOptions {
  fs::path folder;
  bool asymmetry = false;
  std::vector<int> texel;
};

ordered_json describe_fields(const HemisphereSampling& sampling,
                             const std::vector<double>& series) {
  ordered_json rows = ordered_json::array();
  for (std::size_t i = 0; i < series.size(); ++i)
    rows.push_back({degrees(theta_of(sampling[i])), degrees(phi_of(sampling[i])), series[i]});
  return {{"roughness", roughness(sampling, series)}, {"theta_phi_energy", rows}};
}

/// Figure 3 of paper 003, of one texel.
ordered_json describe_asymmetry(const InfoOptions& options, bool raw) {
  if (!raw) {
    throw bad_input(options.folder.string(),
                    "--asymmetry is of raw BTFs; this is a compressed one");
  }
  const Btf btf = read_btf(options.folder);
  const std::vector<int> texel =
      options.texel.empty() ? std::vector{btf.width() / 2, btf.height() / 2} : options.texel;
  if (texel[0] < 0 || texel[0] >= btf.width() || texel[1] < 0 || texel[1] >= btf.height()) {
    throw bad_input("--texel", fmt::format("{},{}; the BTF has {} x {} texels", texel[0], texel[1],
                                           btf.width(), btf.height()));
  }
  const FieldEnergies energies = field_energies(btf, texel[0], texel[1]);
  return {{"texel", texel},
          {"asymmetry", asymmetry(btf, energies)},
          {"light_fields", describe_fields(btf.lights(), energies.light_fields)},
          {"reflectance_fields", describe_fields(btf.views(), energies.reflectance_fields)}};
}

void print_asymmetry(const ordered_json& told, const Session& session) {
  const auto& light_fields = told["light_fields"];
  const auto& reflectance_fields = told["reflectance_fields"];
  session.say(fmt::format(
      "\nEnergies of texel {}, 1/sr: sums of B / cos(theta_light) over all views, or all lights\n"
      "asymmetry {:.3g}; roughness of light fields {:.3g}, of reflectance fields {:.3g}\n\n"
      "{:>7} {:>7} {:>12}   {:>7} {:>7} {:>12}",
      told["texel"].dump(), told["asymmetry"].get<double>(),
      light_fields["roughness"].get<double>(), reflectance_fields["roughness"].get<double>(),
      "theta_l", "phi_l", "light field", "theta_v", "phi_v", "refl. field"));
  const auto row = [](const ordered_json& fields, std::size_t i) {
    if (i >= fields["theta_phi_energy"].size()) return std::string();
    const auto& r = fields["theta_phi_energy"][i];
    return fmt::format("{:7.2f} {:7.2f} {:12.5g}", r[0].get<double>(), r[1].get<double>(),
                       r[2].get<double>());
  };
  const std::size_t rows = std::max(light_fields["theta_phi_energy"].size(),
                                    reflectance_fields["theta_phi_energy"].size());
  for (std::size_t i = 0; i < rows; ++i) {
    session.say(fmt::format("{:28}   {}", row(light_fields, i), row(reflectance_fields, i)));
  }
}

void info(const InfoOptions& options, Session& session) {
  const fs::path& folder = options.folder;
  const bool raw = fs::exists(folder / "btf.json");
  ordered_json& measured = session.measured;
  measured["path"] = folder.string();
  measured.update(raw ? describe_raw(folder) : describe_compressed(folder));
  measured["file_bytes"] = bytes_on_disk(folder);
  // Opened without complaint above, so the text is JSON; these keys are there where somebody wrote
  // them.
  const auto json = ordered_json::parse(read_text(folder / (raw ? "btf.json" : "codec.json")));
  for (const char* key : {"parameters", "noise", "provenance"}) {
    if (json.contains(key)) measured[key] = json[key];
  }
  // Before anything is printed, since it may be refused.
  const ordered_json energies =
      options.asymmetry ? describe_asymmetry(options, raw) : ordered_json();
  print(measured, session, "");
  if (!options.asymmetry) return;
  measured["asymmetry"] = energies;
  print_asymmetry(energies, session);
}

}  // namespace

void add_info(CLI::App& app, Session& session) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand("info", "Tells what a dataset is");
  command->add_option("dataset", options->folder, "Dataset folder, raw or compressed")->required();
  CLI::Option* asymmetry = command->add_flag(
      "--asymmetry", options->asymmetry,
      "Energy of each light field and each reflectance field of a texel of a raw BTF");
  command
      ->add_option("--texel", options->texel, "Column and row of that texel; default: the middle")
      ->expected(2)
      ->delimiter(',')
      ->needs(asymmetry);
  command->callback([options, &session] { info(*options, session); });
}

}  // namespace weft::cli
