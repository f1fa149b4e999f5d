// What is special about the SRBF codec: data of its own come back, what a level's fit makes of bad
// parents, sizes, files, and a fit that goes on where it stopped.

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "btf/atomic_file.h"
#include "btf/random.h"
#include "codecs/sample_error.h"
#include "codecs/srbf/fit.h"
#include "codecs/srbf/srbf_representation.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/codecs/synthetic_kernels.h"
#include "tests/temporary_folder.h"

using namespace weft;
using namespace weft::srbf;

namespace {

std::unique_ptr<Representation> fitted(const std::shared_ptr<const Btf>& btf,
                                       const std::vector<std::string>& parameters,
                                       const std::filesystem::path& kept_in = {}) {
  Progress progress;
  progress.keep_in(kept_in);
  return codec_named("srbf").fit(btf, Settings::from_text("", "test", parameters), progress);
}

const Model& model_of(const Representation& representation) {
  return dynamic_cast<const SrbfRepresentation&>(representation).model();
}

nlohmann::json level_of(const Representation& representation, int level) {
  return nlohmann::json::parse(model_of(representation).report)["levels"][level];
}

}  // namespace

namespace {

// Relative RMSE at pairs of directions that ubo81 has not, up to its last ring: beyond, nothing
// holds a fit.
double error_between_samples(const Representation& found, const Kernels& wanted) {
  double error = 0;
  double square = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto angle = [&](int what, double most) {
      return radians(most) * unit_float(hash_coordinates(37, i, what));
    };
    const Direction light = from_spherical(angle(0, 75), angle(1, 360));
    const Direction view = from_spherical(angle(2, 75), angle(3, 360));
    const Rgb value = found.evaluate({0.5F, 0.5F}, light, view, 0);
    const auto truth = evaluate(wanted, light, view);
    for (int c = 0; c < 3; ++c) {
      error += std::pow(value[c] - truth[c], 2);
      square += std::pow(truth[c], 2);
    }
  }
  return std::sqrt(error / square);
}

}  // namespace

TEST_CASE("SRBF: data made of its own kernels come back to 1e-3, and between the samples to 5e-3") {
  for (const std::size_t modes : {std::size_t{1}, std::size_t{3}}) {
    for (const std::uint64_t seed : {0, 1, 2}) {
      const Kernels kernels = some_kernels({3, modes}, 5, seed);
      const auto btf = btf_of({kernels}, 1, "ubo81");
      const auto found = fitted(btf, {"kernels=6", "bits=float", "iterations=100",
                                      "modes_a_kernel=" + std::to_string(modes)});
      INFO("modes " << modes << ", seed " << seed);
      CHECK(sample_error(*btf, *found).relative_rmse < 1e-3);
      CHECK(error_between_samples(*found, kernels) < 5e-3);
    }
  }
}

TEST_CASE("SRBF: the paper's 20 kernels of 3 modes are 30 times below 24-bit input, mips too") {
  const Layout layout{{20, 3}};
  const std::size_t texels = MipSizes{64, 64}.first_texel(7);
  CHECK(texels == 5461);
  const double bytes = static_cast<double>(texels) * 8.0 * static_cast<double>(layout.quads());
  CHECK(3.0 * 81 * 81 * 64 * 64 / bytes >= 30);
}

TEST_CASE("SRBF: halfs err within 2 percent of what the fit did in double") {
  const auto btf = realistic_btf(4, "regular:3x6");
  const auto error = [&](const std::string& bits) {
    return sample_error(*btf, *fitted(btf, {"bits=" + bits})).relative_rmse;
  };
  const double whole = error("float");
  CHECK(whole > 0.005);
  CHECK(error("half") == Approx(whole).epsilon(0.02));
}

TEST_CASE("SRBF: the folder of 64 x 64 texels with mips is at most 1/30 of 24-bit data") {
  const auto btf = realistic_btf(64, "regular:2x4");
  Progress silent;
  const auto quick = codec_named("srbf").fit(
      btf,
      Settings::from_text(
          "", "test",
          {"modes=half-light-view", "iterations=1", "starts=1", "sweeps=0", "restarts=false"}),
      silent);
  Model model = model_of(*quick);
  const std::size_t pairs = 81 * 81;
  model.head.views = model.head.lights = HemisphereSampling(named_directions("ubo81"));
  const SrbfRepresentation whole(std::move(model));
  const TemporaryFolder folder;
  whole.save(folder.path / "saved");
  std::uintmax_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder.path / "saved"))
    bytes += file.file_size();
  CHECK(bytes > 1000000);
  CHECK(30 * bytes <= 3 * 64 * 64 * pairs);
  CHECK(30 * whole.bytes() <= 3 * 64 * 64 * pairs);
}

TEST_CASE("SRBF: modes that have a K of their own take no other") {
  const auto btf = realistic_btf(1, "regular:2x4");
  const auto fit_with = [&](const std::vector<std::string>& modes) {
    std::vector<std::string> parameters = {"kernels=2", "iterations=1", "starts=1"};
    parameters.insert(parameters.end(), modes.begin(), modes.end());
    return model_of(*fitted(btf, parameters)).shape.modes;
  };
  CHECK(fit_with({"modes_a_kernel=2"}) == 2);
  CHECK(fit_with({"modes=half-difference"}) == 2);
  CHECK(fit_with({"modes=half-difference", "modes_a_kernel=2"}) == 2);
  CHECK(fit_with({"multivariate=false", "modes_a_kernel=1"}) == 1);
  CHECK_THROWS_WITH(fit_with({"modes=half-difference", "modes_a_kernel=3"}),
                    Catch::Contains("modes_a_kernel = 3") &&
                        Catch::Contains("half-difference has 2") && Catch::Contains("optimal"));
  CHECK_THROWS_WITH(fit_with({"multivariate=false", "modes_a_kernel=4"}),
                    Catch::Contains("multivariate = false has 1"));
}

TEST_CASE("SRBF: numbers that are to be blended bring their pulls, each set by its key") {
  const auto options = [](const std::vector<std::string>& parameters) {
    return fit_options(Settings::from_text("", "test", parameters));
  };
  const FitOptions values = options({});
  CHECK(values.filtering == Filtering::values);
  CHECK(values.smooth_weight == 0);
  CHECK(values.mip_weight == 0);
  CHECK(values.robust);
  CHECK(values.sweeps == 1);
  const FitOptions numbers = options({"filtering=numbers"});
  CHECK(numbers.filtering == Filtering::numbers);
  CHECK(numbers.smooth_weight == 0.01);
  CHECK(numbers.mip_weight == 0.01);
  CHECK(!numbers.robust);
  CHECK(numbers.sweeps == 3);
  const FitOptions named =
      options({"filtering=numbers", "smooth_weight=0.5", "mip_weight=0.25", "sweeps=2"});
  CHECK(named.smooth_weight == 0.5);
  CHECK(named.mip_weight == 0.25);
  CHECK(named.sweeps == 2);
}

TEST_CASE("SRBF: pulls that could do nothing, or harm, are refused by name") {
  const auto options = [](const std::vector<std::string>& parameters) {
    return fit_options(Settings::from_text("", "test", parameters));
  };
  CHECK_THROWS_WITH(options({"smooth_weight=0.1", "sweeps=0"}),
                    Catch::Contains("smooth_weight = 0.1") && Catch::Contains("sweeps = 0"));
  CHECK_THROWS_WITH(options({"filtering=numbers", "sweeps=0"}),
                    Catch::Contains("smooth_weight = 0.01") && Catch::Contains("sweeps = 0"));
  CHECK_THROWS_WITH(options({"filtering=numbers", "robust=true"}),
                    Catch::Contains("robust = true") && Catch::Contains("numbers"));
  CHECK_NOTHROW(options({"sweeps=0", "mip_weight=1"}));
  CHECK_NOTHROW(options({"filtering=numbers", "sweeps=0", "smooth_weight=0"}));
  CHECK_NOTHROW(options({"filtering=numbers", "robust=false"}));
}

TEST_CASE("SRBF: between texels and levels lies the blend of what they are, or of their numbers") {
  const auto btf = realistic_btf(2, "regular:3x6");
  const auto found = fitted(btf, {"bits=float", "kernels=3", "iterations=20", "filtering=numbers",
                                  "smooth_weight=0", "mip_weight=0", "sweeps=1"});
  const Model& model = model_of(*found);
  const Layout layout = model.layout();
  const Texcoord uv(0.25F, 0.75F);  // texel (0, 0)
  const Direction light = from_spherical(0.4, 1);
  const Direction view = from_spherical(0.9, 4);
  for (const float lod : {0.0F, 0.3F, 1.0F, 7.0F}) {
    const double blend = std::min(lod, 1.0F);
    Kernels kernels(model.shape);
    const auto number = [&](std::size_t place) {
      const std::size_t top = 4 * model.row();
      return model.scale[place] *
             ((1 - blend) * model.values[place] + blend * model.values[top + place]);
    };
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t s = 0; s < 9; ++s) kernels.centre(j, 0)[s] = number(layout.place(j, s));
      for (std::size_t c = 0; c < 3; ++c)
        kernels.colours()[3 * j + c] = number(layout.place(j, 9 + c));
    }
    for (std::size_t k = 0; k < 3; ++k) kernels.angles()[k] = number(layout.angle_place(k));
    const Rgb answer = found->evaluate(uv, light, view, lod);
    const auto wanted = evaluate(kernels, light, view);
    for (int c = 0; c < 3; ++c)
      CHECK(answer[c] == Approx(std::max(wanted[c], 0.0)).epsilon(1e-4).margin(1e-5));
  }

  // The same numbers, blended as values: eight texels' own answers.
  Model of_values = model;
  of_values.filtering = Filtering::values;
  const SrbfRepresentation values(std::move(of_values));
  const Texcoord between(0.4F, 0.55F);
  const auto at = [&](float u, float v, float lod) {
    return values.evaluate({u, v}, light, view, lod);
  };
  const Rgb fine = (at(0.25F, 0.25F, 0) * 0.7F + at(0.75F, 0.25F, 0) * 0.3F) * 0.4F +
                   (at(0.25F, 0.75F, 0) * 0.7F + at(0.75F, 0.75F, 0) * 0.3F) * 0.6F;
  for (const float lod : {0.0F, 0.3F, 1.0F, 7.0F}) {
    const float blend = std::min(lod, 1.0F);
    const Rgb wanted = fine * (1 - blend) + at(0, 0, 1) * blend;
    const Rgb answer = values.evaluate(between, light, view, lod);
    CHECK((answer - wanted).length() < 1e-5F * wanted.length());
  }
}

TEST_CASE("SRBF: free angles err less than fixed ones, several modes less than one") {
  const auto btf = realistic_btf(4, "regular:3x6");
  const auto error = [&](const std::vector<std::string>& parameters) {
    return level_of(*fitted(btf, parameters), 0)["relative_rmse"].get<double>();
  };
  const double optimal = error({});
  CHECK(optimal < 0.7 * error({"modes=half-half-half"}));
  CHECK(optimal < 0.7 * error({"modes=half-difference"}));
  CHECK(optimal < error({"modes=half-light-view"}));
  CHECK(optimal < 0.5 * error({"multivariate=false"}));
}

TEST_CASE("SRBF: texels that their parent misleads start again from a neighbour") {
  // The edge between two materials runs through a column of parents; of one of them the other's
  // neighbours never find the best kernels.
  const Kernels a = some_kernels({3, 3}, 4, 1);
  const Kernels b = some_kernels({3, 3}, 16, 2);
  std::vector<Kernels> texels;
  for (std::size_t t = 0; t < 64; ++t) texels.push_back(t % 8 < 5 ? a : b);
  const auto btf = btf_of(texels, 8, "regular:3x8");
  const auto fit_with = [&](const std::string& restarts) {
    return fitted(btf,
                  {"kernels=3", "iterations=25", "modes=half-light-view", "restarts=" + restarts});
  };
  const auto with = fit_with("true");
  CHECK(level_of(*with, 0)["restarts"].get<int>() > 0);
  CHECK(level_of(*with, 0)["relative_rmse"].get<double>() <
        0.8 * level_of(*fit_with("false"), 0)["relative_rmse"].get<double>());
}

TEST_CASE("SRBF: free angles end no worse than fixed ones do by themselves, at every level") {
  const auto btf = realistic_btf(4, "regular:3x8");
  const auto fit_with = [&](const std::string& modes) {
    return fitted(btf, {"kernels=3", "iterations=10", "sweeps=3", "modes=" + modes});
  };
  const auto fixed = fit_with("half-light-view");
  const auto free = fit_with("optimal");
  for (const int level : {0, 1, 2}) {
    INFO("level " << level);
    CHECK(level_of(*free, level)["relative_rmse"].get<double>() <=
          level_of(*fixed, level)["relative_rmse"].get<double>());
  }
}

TEST_CASE("SRBF: descents that go on where little is won end lower, at every level") {
  const auto btf = realistic_btf(2, "regular:3x8");
  const auto fit_with = [&](const std::string& decrease) {
    return fitted(btf, {"kernels=4", "iterations=400", "sweeps=0", "decrease=" + decrease});
  };
  const auto early = fit_with("0.1");
  const auto late = fit_with("1e-5");
  for (const int level : {0, 1}) {
    INFO("level " << level);
    CHECK(level_of(*late, level)["relative_rmse"].get<double>() <
          0.95 * level_of(*early, level)["relative_rmse"].get<double>());
  }
  CHECK_NOTHROW(fit_options(Settings::from_text("", "test", {"decrease=0"})));
  CHECK_THROWS_WITH(fit_with("0.2"), Catch::Contains("decrease") && Catch::Contains("0.1"));
  CHECK_THROWS_WITH(fit_with("-1"), Catch::Contains("decrease"));
}

TEST_CASE("SRBF: a codec.json that names what there is not is refused") {
  const TemporaryFolder folder;
  fitted(realistic_btf(1, "regular:3x6"), {"kernels=2", "iterations=1"})->save(folder.path / "a");
  const auto json_path = folder.path / "a" / "codec.json";
  const std::string whole = read_text(json_path);
  for (const auto& [field, value] :
       {std::pair("filtering", "hardware"), std::pair("quantity", "f")}) {
    auto json = nlohmann::json::parse(whole);
    json[field] = value;
    write_text_atomically(json_path, json.dump());
    CHECK_THROWS_WITH(open_representation(folder.path / "a"), Catch::Contains(field));
  }
}

TEST_CASE("SRBF: an interrupted fit continues from its last level, to the same bytes") {
  const auto btf = realistic_btf(4, "regular:3x6");
  const std::vector<std::string> parameters = {"kernels=4", "iterations=15", "robust=false"};
  const TemporaryFolder folder;
  const auto kept = folder.path / "kept";
  const std::vector<float> whole = model_of(*fitted(btf, parameters, kept)).values;
  CHECK(std::filesystem::exists(kept / "level_2.f64"));
  std::filesystem::remove(kept / "level_0.f64");
  const bool same = model_of(*fitted(btf, parameters, kept)).values == whole;
  CHECK(same);
  CHECK(std::filesystem::exists(kept / "level_0.f64"));
  // Rounding and filtering come later: the pieces of 3 levels, fixed and free, serve others too,
  // whose pulls are the same.
  Progress progress;
  progress.keep_in(kept);
  const FitOptions others = fit_options(
      Settings::from_text("", "test",
                          {"kernels=4", "iterations=15", "bits=float", "filtering=numbers",
                           "smooth_weight=0", "mip_weight=0", "sweeps=1"}));
  fit(*btf, others, progress);
  CHECK(progress.reported().at("pieces_kept") == 6);
  // What is kept is used: the fit of other kernels under the name of the top tells.
  std::filesystem::remove_all(kept);
  fitted(btf, {"kernels=4", "iterations=1"}, kept);
  const std::string key = read_text(kept / "checkpoint.json");
  fitted(btf, parameters, folder.path / "other");
  std::filesystem::copy_file(kept / "level_1.f64", folder.path / "other" / "level_1.f64",
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::remove(folder.path / "other" / "level_0.f64");
  const bool differs = model_of(*fitted(btf, parameters, folder.path / "other")).values != whole;
  CHECK(differs);
}
