// The table of codecs, `raw` first: adding one adds a line here and a folder beside.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "codecs/cmf/cmf.h"
#include "codecs/dfmf/dfmf.h"
#include "codecs/hf/hf.h"
#include "codecs/lafortune/lafortune.h"
#include "codecs/laplacian/laplacian.h"
#include "codecs/lobes/lobes.h"
#include "codecs/pca/pca.h"
#include "codecs/pca_view/pca_view.h"
#include "codecs/ptm/ptm.h"
#include "codecs/raw/raw.h"
#include "codecs/representation.h"
#include "codecs/srbf/srbf.h"
#include "settings/nearest_name.h"

namespace weft {

namespace {

std::string hint_for(const std::string& name) {
  std::vector<std::string> names;
  for (const Codec& codec : codecs()) names.push_back(codec.name);
  return name_hint(name, names);
}

}  // namespace

std::span<const Codec> codecs() {
  static const std::array table{raw_codec(),      cmf_codec(),       hf_codec(),   pca_codec(),
                                pca_view_codec(), laplacian_codec(), dfmf_codec(), lobes_codec(),
                                ptm_codec(),      lafortune_codec(), srbf_codec()};
  return table;
}

const Codec& codec_named(const std::string& name) {
  const auto found = std::ranges::find(codecs(), name, &Codec::name);
  if (found == codecs().end()) {
    throw bad_input("codec", fmt::format("there is no codec '{}'", name), hint_for(name));
  }
  return *found;
}

std::unique_ptr<Representation> open_representation(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw bad_input(folder.string(),
                    std::filesystem::exists(folder) ? "is not a folder" : "is not there",
                    "a dataset is a folder with btf.json or codec.json");
  }
  if (std::filesystem::exists(folder / "btf.json")) return codec_named("raw").load(folder);
  const std::filesystem::path json_path = folder / "codec.json";
  if (!std::filesystem::exists(json_path)) {
    throw bad_input(folder.string(),
                    "holds neither btf.json (a raw BTF) nor codec.json (a compressed one)");
  }
  const auto json = nlohmann::json::parse(read_text(json_path), nullptr, false);
  if (!json.is_object() || !json.contains("codec") || !json["codec"].is_string()) {
    throw bad_input(json_path.string(), "is not a JSON object with a text `codec`",
                    "the file is truncated or not Weft's");
  }
  const std::string name = json["codec"];
  const auto found = std::ranges::find(codecs(), name, &Codec::name);
  if (found == codecs().end()) {
    throw bad_input(json_path.string(),
                    fmt::format("`codec` names '{}', which this build does not have", name),
                    hint_for(name));
  }
  return found->load(folder);
}

}  // namespace weft
