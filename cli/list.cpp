// weft list codecs|mesostructures|scenes: what there is to choose from, with its parameters.

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "acquisition/mesostructure.h"
#include "cli/command.h"
#include "cli/scene_folder.h"
#include "codecs/representation.h"

namespace weft::cli {

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// One entry: its name and summary, then its parameters, a line each.
nlohmann::ordered_json show(const Session& session, const std::string& name,
                            const std::string& summary, const std::string& parameters) {
  session.say(fmt::format("{}: {}", name, summary));
  for (const std::string& line : lines_of(parameters)) session.say("    " + line);
  return {{"name", name}, {"summary", summary}, {"parameters", lines_of(parameters)}};
}

void list_codecs(Session& session) {
  auto& list = session.measured["codecs"] = nlohmann::ordered_json::array();
  for (const Codec& codec : codecs()) {
    const std::string source = codec.reference.empty() ? "" : fmt::format(" ({})", codec.reference);
    auto entry = show(session, codec.name, codec.summary + source, codec.parameters);
    entry["summary"] = codec.summary;
    entry["reference"] = codec.reference;
    list.push_back(std::move(entry));
  }
}

void list_mesostructures(Session& session) {
  auto& list = session.measured["mesostructures"] = nlohmann::ordered_json::array();
  session.say("Keys of every type, with --set or in the file:");
  const std::string shared =
      "type                  one of those below\n"
      "tile_size = 1         world units a tile; all else is in tiles\n"
      "reference_height      of the BTF plane, not below the structure; default: the highest "
      "point\n"
      "offset = [0, 0]       shifts the content, in tiles\n"
      "smooth = false        smooth shading normals; false: the triangles' own\n"
      "floor = { height = 0, material = \"floor\" }   adds a plane\n"
      "[materials.NAME]      type = \"lambert\" | \"conductor\" | \"plastic\" and its parameters:\n"
      "    lambert           albedo = 0.5\n"
      "    conductor         f0, or eta and k (default: gold's); alpha = 0.2\n"
      "    plastic           albedo = 0.5, ior = 1.5, alpha = 0.2";
  for (const std::string& line : lines_of(shared)) session.say("    " + line);
  for (const MesostructureType& type : mesostructure_types()) {
    auto entry = show(session, type.name, type.summary, type.parameters);
    auto& materials = entry["materials"] = nlohmann::ordered_json::array();
    std::string names;
    for (const auto& [name, settings] : type.default_materials) {
      materials.push_back(name);
      names += (names.empty() ? "" : ", ") + name;
    }
    session.say("    materials: " + (names.empty() ? "the names in the file" : names));
    list.push_back(std::move(entry));
  }
  session.measured["shared_parameters"] = lines_of(shared);
}

/// The comment that a text file begins with, up to its first other line.
std::string heading(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line) && line.starts_with('#');) {
    line.erase(0, std::min(line.find_first_not_of("# "), line.size()));
    text += (text.empty() ? "" : " ") + line;
  }
  return text;
}

void list_scenes(Session& session, const std::filesystem::path& chosen) {
  const std::filesystem::path folder = scene_folder(chosen);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  auto& list = session.measured["scenes"] = nlohmann::ordered_json::array();
  for (const std::filesystem::path& file : files) {
    const std::string summary = heading(file);
    session.say(fmt::format("{}: {}", file.string(), summary));
    list.push_back({{"file", file.string()}, {"summary", summary}});
  }
}

}  // namespace

void add_list(CLI::App& app, Session& session) {
  CLI::App* command =
      app.add_subcommand("list", "List what there is to choose from, with its parameters");
  command->require_subcommand(1);
  command->add_subcommand("codecs", "Representations for `weft compress --codec`")
      ->callback([&session] { list_codecs(session); });
  command->add_subcommand("mesostructures", "Types of mesostructures and their keys")
      ->callback([&session] { list_mesostructures(session); });
  CLI::App* scenes = command->add_subcommand(
      "scenes", "Files that come with Weft: mesostructures to acquire and scenes to render");
  auto folder = std::make_shared<std::string>();
  scenes->add_option("folder", *folder, "Folder to look in; default: the one that comes with Weft")
      ->option_text("FOLDER");
  scenes->callback([&session, folder] { list_scenes(session, *folder); });
}

}  // namespace weft::cli
