#include "codecs/fitted_folder.h"

#include <fmt/core.h>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "btf/sampling_json.h"
#include "codecs/atomic_folder.h"
#include "codecs/stencil_glsl.h"

namespace weft {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

FittedHead head_of(const Json& json, const std::string& codec, int version,
                   const std::string& where) {
  if (json.at("codec") != codec || json.at("version") != version) {
    throw bad_input("version", fmt::format("{} {}; this build reads {} {}", json.at("codec").dump(),
                                           json.at("version").dump(), codec, version));
  }
  FittedHead head{.width = json.at("texels").at(0),
                  .height = json.at("texels").at(1),
                  .views = sampling_from_json(json.at("views"), where + ": views"),
                  .lights = sampling_from_json(json.at("lights"), where + ": lights"),
                  .parameters = json.at("parameters").dump(),
                  .provenance = json.at("provenance").dump()};
  if (head.width < 1 || head.height < 1)
    throw bad_input("texels", fmt::format("{} x {}", head.width, head.height));
  return head;
}

}  // namespace

FittedHead fitted_head(const Btf& btf, std::string parameters) {
  return {btf.width(),  btf.height(),          btf.views(),
          btf.lights(), std::move(parameters), btf.provenance};
}

std::size_t direction_table_bytes(const FittedHead& head) {
  std::size_t bytes = 0;
  for (const HemisphereSampling* sampling : {&head.views, &head.lights}) {
    for (const GlTexture& table : hemisphere_sampling_glsl(*sampling, "btf_any").textures)
      bytes += table.bytes.size();
  }
  return bytes;
}

void write_fitted(const fs::path& folder, const std::string& codec, int version,
                  const FittedHead& head, const std::function<Json(const fs::path&)>& write) {
  write_folder_atomically(folder, [&](const fs::path& aside) {
    Json json{{"codec", codec}, {"version", version}};
    json["parameters"] = Json::parse(head.parameters);
    json["texels"] = {head.width, head.height};
    json.update(write(aside));
    json["lights"] = sampling_to_json(head.lights);
    json["views"] = sampling_to_json(head.views);
    json["provenance"] = Json::parse(head.provenance);
    json["files"] = folder_checksums(aside);
    write_text_atomically(aside / "codec.json", json.dump(2) + "\n");
  });
}

void read_fitted(const fs::path& folder, const std::string& codec, int version,
                 const std::function<void(const Json&, FittedHead)>& read) {
  const Json json = read_checked_codec_json(folder);
  const std::string where = (folder / "codec.json").string();
  try {
    read(json, head_of(json, codec, version, where));
  } catch (const nlohmann::json::exception& error) {
    throw bad_input(where, error.what(), "a field is missing or of another type");
  } catch (const Error& error) {
    if (error.where().starts_with(folder.string())) throw;
    throw bad_input(where, error.what());  // a field's
  }
}

}  // namespace weft
