// weft validate: whether a dataset is whole. Each finding is one numbered line; exit 3 where there
// is any.
//
//   1  a file is missing
//   2  a file is not what it was when its checksum was written
//   3  the dataset cannot be opened, or its parts do not fit together
//   4  a value is not finite, or negative

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "btf/appearance.h"
#include "btf/atomic_file.h"
#include "btf/error.h"
#include "cli/command.h"
#include "codecs/representation.h"

namespace weft::cli {

namespace {

namespace fs = std::filesystem;

struct Finding {
  int number;
  std::string what;
};

bool is_sound(const Rgb& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z) && c.x >= 0 && c.y >= 0 &&
         c.z >= 0;
}

/// Decodes every texel for each pair of a view and a light, or, where these are too many, for pairs
/// spread evenly among them.
std::optional<Finding> check_values(const Representation& tile, std::size_t& decoded) {
  constexpr std::size_t most = 4'000'000;
  const Imath::V2i texels = tile.texels();
  const std::size_t count = static_cast<std::size_t>(texels.x) * texels.y;
  const std::size_t pairs = tile.views().size() * tile.lights().size();
  const std::size_t step = std::max<std::size_t>(1, pairs * count / most);
  std::vector<AppearanceQuery> queries(count);
  std::vector<Rgb> answers(count);
  std::size_t bad = 0;
  std::string first;
  for (std::size_t pair = 0; pair < pairs; pair += step) {
    const std::size_t view = pair / tile.lights().size();
    const std::size_t light = pair % tile.lights().size();
    for (std::size_t i = 0; i < count; ++i) {
      const auto x = static_cast<float>(i % texels.x);
      const auto y = static_cast<float>(i / texels.x);
      queries[i] = {{(x + 0.5F) / static_cast<float>(texels.x),
                     1 - (y + 0.5F) / static_cast<float>(texels.y)},
                    tile.lights()[light],
                    tile.views()[view],
                    0};
    }
    tile.evaluate(queries, answers);
    for (std::size_t i = 0; i < count; ++i) {
      if (is_sound(answers[i])) continue;
      if (bad++ == 0) {
        first = fmt::format("({}, {}, {}) at view {}, light {}, texel ({}, {})", answers[i].x,
                            answers[i].y, answers[i].z, view, light, i % texels.x, i / texels.x);
      }
    }
    decoded += count;
  }
  if (bad == 0) return std::nullopt;
  return Finding{4, fmt::format("{} of {} values are not finite or are negative; the first is {}",
                                bad, decoded, first)};
}

/// Every file that the dataset's JSON names, against the checksum that stands beside it there.
std::vector<Finding> check_files(const fs::path& folder, const nlohmann::json& json) {
  std::vector<Finding> findings;
  for (const auto& [name, checksum] :
       json.at(json.contains("codec") ? "files" : "xxh3_128").items()) {
    const fs::path file = folder / name;
    if (!fs::exists(file)) {
      findings.push_back({1, file.string() + ": is missing"});
    } else if (const std::string found = file_checksum(file); found != checksum) {
      findings.push_back({2, fmt::format("{}: its checksum is {}, it was written with {}",
                                         file.string(), found, checksum.get<std::string>())});
    }
  }
  return findings;
}

std::vector<Finding> check(const fs::path& folder, std::size_t& decoded) {
  const fs::path raw = folder / "btf.json";
  const fs::path json = fs::exists(raw) ? raw : folder / "codec.json";
  if (!fs::exists(json)) {
    return {{1, folder.string() +
                    ": has neither btf.json (of a raw BTF; an unfinished acquisition has none yet) "
                    "nor codec.json (of a compressed one)"}};
  }
  std::vector<Finding> findings;
  try {
    findings = check_files(folder, nlohmann::json::parse(read_text(json)));
    if (!findings.empty()) return findings;
    const auto tile = open_representation(folder);
    if (auto finding = check_values(*tile, decoded)) findings.push_back(std::move(*finding));
  } catch (const nlohmann::json::exception& error) {
    findings.push_back(
        {3, fmt::format("{}: cannot be understood: {}", json.string(), error.what())});
  } catch (const Error& error) {
    findings.push_back({3, error.what()});
  }
  return findings;
}

void validate(const fs::path& folder, Session& session) {
  if (!fs::is_directory(folder)) throw bad_input(folder.string(), "is not a dataset (a folder)");
  std::size_t decoded = 0;
  const std::vector<Finding> findings = check(folder, decoded);
  session.measured["dataset"] = folder.string();
  session.measured["values_decoded"] = decoded;
  session.measured["findings"] = nlohmann::json::array();
  for (const Finding& finding : findings) {
    session.measured["findings"].push_back({{"number", finding.number}, {"what", finding.what}});
    if (!session.json) fmt::print(stderr, "weft: {}: {}\n", finding.number, finding.what);
  }
  if (!findings.empty()) session.exit_code = difference;
  session.say(findings.empty()
                  ? fmt::format("{}: whole; {} values decoded", folder.string(), decoded)
                  : fmt::format("{}: {} finding{}", folder.string(), findings.size(),
                                findings.size() == 1 ? "" : "s"));
}

}  // namespace

void add_validate(CLI::App& app, Session& session) {
  const auto folder = std::make_shared<fs::path>();
  CLI::App* command = app.add_subcommand(
      "validate", "Checks a dataset's files, sizes and values; exit 3 where something is wrong");
  command->add_option("dataset", *folder, "Dataset folder, raw or compressed")->required();
  command->callback([folder, &session] { validate(*folder, session); });
}

}  // namespace weft::cli
