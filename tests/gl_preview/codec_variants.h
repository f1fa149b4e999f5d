// Every registered codec in the variants that its parameters offer, fitted to one BTF.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "codecs/representation.h"

struct FittedVariant {
  std::string name;  ///< codec and parameters
  std::unique_ptr<weft::Representation> representation;
};

/// By its help of `bits`.
inline bool takes_8_bits(const weft::Codec& codec) {
  const std::string line = codec.parameters.substr(codec.parameters.find("bits "));
  return line.substr(0, line.find('\n')).find('8') != std::string::npos;
}

/// For each codec, each combination of those of the parameters below that it has (halfs where there
/// are no 8 bits); a new codec is fitted with its defaults.
inline std::vector<FittedVariant> fitted_variants(const std::shared_ptr<const weft::Btf>& btf) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> offered = {
      {"bits", {"bits=8", "bits=float"}}, {"clustered", {"clustered=true", "clustered=false"}}};
  std::vector<FittedVariant> variants;
  for (const weft::Codec& codec : weft::codecs()) {
    std::vector<std::vector<std::string>> combinations = {{}};
    for (const auto& [key, choices] : offered) {
      if (codec.parameters.find(key + " ") == std::string::npos) continue;
      std::vector<std::vector<std::string>> longer;
      for (const auto& combination : combinations) {
        for (const std::string& choice : choices) {
          longer.push_back(combination);
          longer.back().push_back(choice == "bits=8" && !takes_8_bits(codec) ? "bits=half"
                                                                             : choice);
        }
      }
      combinations = longer;
    }
    if (codec.name == "cmf") {
      combinations.push_back({"rotate=false"});
      combinations.push_back({"clustered=false", "rotate=true", "bits=float"});
      const std::string four = "factors=light,half,difference,view";
      combinations.push_back({four, "terms=2", "bits=8", "rotate=true"});
      combinations.push_back({four, "terms=3", "bits=float", "clustered=false", "levels=false"});
    }
    if (codec.name == "laplacian") {
      combinations.push_back({"directions=interpolated", "filters=box2", "bits=half"});
      combinations.push_back({"directions=interpolated", "filters=linear", "chroma_mean=cosine"});
      combinations.push_back({"filters=linear", "levels=1", "components_cb=3", "top=mean"});
      if (btf->width() >= 8 && btf->height() >= 8) combinations.push_back({"levels=3"});
    }
    // Half the maps' resolution is found in a fraction of the time; the defaults keep theirs.
    if (codec.name == "cmf" || codec.name == "hf") {
      for (auto& combination : std::span(combinations).subspan(1))
        combination.push_back("resolution=16");
    }
    // Its descents take long, and decoders agree wherever they stop.
    if (codec.name == "srbf") {
      combinations.push_back({"modes=in-out", "kernels=17", "quantity=f"});
      for (auto& combination : combinations)
        combination.insert(combination.end(), {"iterations=8", "starts=1"});
    }
    if (codec.name.starts_with("pca")) combinations.push_back({"bits=half", "components=5"});
    if (codec.name == "lobes") combinations.push_back({"lobes=1"});
    if (codec.name == "lafortune") combinations.push_back({"lobes=3"});
    if (codec.name == "ptm")
      combinations.insert(combinations.end(), {{"cosine=inside"}, {"colour=channels"}});
    for (const auto& overrides : combinations) {
      std::string name = codec.name;
      for (const std::string& choice : overrides) name += " " + choice;
      weft::Progress silent;
      const auto settings = weft::Settings::from_text("", "--set", overrides);
      variants.push_back({name, codec.fit(btf, settings, silent)});
    }
  }
  return variants;
}
