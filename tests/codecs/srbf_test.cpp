// What is special about the SRBF codec: its gradient, data of its own come back, its pyramid, what
// a level's fit makes of bad parents, sizes, and a fit that goes on where it stopped.

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "btf/atomic_file.h"
#include "btf/random.h"
#include "codecs/sample_error.h"
#include "codecs/srbf/fit.h"
#include "codecs/srbf/initial_guess.h"
#include "codecs/srbf/lanes.h"
#include "codecs/srbf/minimise.h"
#include "codecs/srbf/objective.h"
#include "codecs/srbf/srbf_representation.h"
#include "codecs/srbf/texel_fit.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/temporary_folder.h"

using namespace weft;
using namespace weft::srbf;

namespace {

double random(std::uint64_t i, int what) {
  return 2.0 * unit_float(hash_coordinates(91, i, what)) - 1;
}

/// Kernels as a fit might end with: lambda up to `widest`, positive colours.
Kernels some_kernels(Shape shape, double widest, std::uint64_t seed = 0) {
  Kernels kernels(shape);
  for (std::size_t i = 0; i < shape.centres(); ++i)
    kernels.values()[i] = widest * 0.57 * random(i, static_cast<int>(2 * seed));
  const std::vector<double> angles = {0.8, 0.1, 1.4, -0.7};
  std::copy_n(angles.begin(), shape.modes, kernels.angles().begin());
  for (std::size_t i = 0; i < shape.colours(); ++i)
    kernels.colours()[i] = 1 + 0.5 * random(i, static_cast<int>(2 * seed + 1));
  return kernels;
}

/// A BTF whose texels are such kernels' sums.
std::shared_ptr<const Btf> btf_of(const std::vector<Kernels>& texels, int width,
                                  const std::string& directions) {
  const int height = static_cast<int>(texels.size()) / width;
  return synthetic_btf(width, height, directions, directions,
                       [&](int x, int y, const Direction& light, const Direction& view) {
                         const auto b = evaluate(texels[y * width + x], light, view);
                         return Rgb(static_cast<float>(b[0]), static_cast<float>(b[1]),
                                    static_cast<float>(b[2])) /
                                light.z;
                       });
}

std::vector<float> texel_of(const Btf& btf, const Samples& samples, int x = 0, int y = 0) {
  std::vector<float> abrdf(3 * samples.pairs);
  btf.abrdf(x, y, abrdf);
  return channel_arrays(samples, abrdf, 1);
}

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

TEST_CASE("SRBF: exponentials side by side are the library's to 3e-7") {
  for (int i = 0; i < 4000; ++i) {
    const float x = -0.0217F * static_cast<float>(i);
    const Wide found = exp_below_zero(Wide{} + x);
    REQUIRE(found[i % wide_lanes] == Approx(std::exp(x)).epsilon(3e-7).margin(1e-37));
  }
  CHECK(exp_below_zero(Vec4{} - 1e30F)[0] < 1e-37F);
  CHECK(std::isnan(exp_below_zero(Vec4{} + std::numeric_limits<float>::quiet_NaN())[0]));
}

TEST_CASE("SRBF: the objective is what its definition says, and its colours are the best") {
  const auto btf = realistic_btf(2, "regular:3x6");
  const Samples samples(btf->views(), btf->lights(), Quantity::over_cosine);
  const std::vector<float> texel = texel_of(*btf, samples);
  const double ridge = 1e-3;
  Objective objective(samples, {5, 3}, Ridge{0, ridge, 0});
  objective.set_texel(texel);
  Kernels kernels = some_kernels({5, 3}, 6);
  const Objective::Value value = objective(kernels, {}, true);
  const auto defined = [&](const Kernels& tried) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.pairs; ++i) {
      const Direction& light = btf->lights()[i % btf->lights().size()];
      const auto f = evaluate(tried, light, btf->views()[i / btf->lights().size()]);
      for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(f[c] * light.z - texel[c * samples.count + i], 2);
    }
    sum /= 3.0 * static_cast<double>(samples.pairs);
    for (const double colour : tried.colours()) sum += ridge * colour * colour;
    return sum;
  };
  CHECK(value.total == Approx(defined(kernels)).epsilon(1e-5));
  for (std::size_t i = 0; i < kernels.colours().size(); ++i) {
    for (const double step : {-0.01, 0.01}) {
      Kernels other = kernels;
      other.colours()[i] += step;
      CHECK(defined(other) > defined(kernels));
    }
  }
}

TEST_CASE("SRBF: the gradient is what central differences say") {
  const auto btf = realistic_btf(2, "regular:3x6");
  for (const Quantity quantity : {Quantity::radiance, Quantity::over_cosine}) {
    const Samples samples(btf->views(), btf->lights(), quantity);
    const std::vector<float> texel = texel_of(*btf, samples, 1, 1);
    for (std::size_t modes = 1; modes <= most_modes; ++modes) {
      const Shape shape{7, modes};
      Objective objective(samples, shape, Ridge{1e-4, 1e-3, 1e-2});
      objective.set_texel(texel);
      const Kernels target = some_kernels(shape, 3, 1);
      objective.set_pull({{2e-5, 3e-4, 1e-4}, {target.values().begin(), target.values().end()}});
      Kernels kernels = some_kernels(shape, 6);
      std::vector<double> gradient(shape.unknowns());
      objective(kernels, gradient, true);
      // Angles move all centres at once: their derivatives are the larger ones. Sums are of floats:
      // where steps are shorter than these, rounding shows (4e-3: up to 2e-3 of the largest), where
      // they are longer, the fifth derivative.
      double of_centres = 0;
      double of_angles = 0;
      for (std::size_t i = 0; i < shape.unknowns(); ++i) {
        double& largest = i < shape.centres() ? of_centres : of_angles;
        largest = std::max(largest, std::abs(gradient[i]));
      }
      for (std::size_t i = 0; i < shape.unknowns(); ++i) {
        const double step = 2e-2;
        const auto at = [&](double offset) {
          Kernels moved = kernels;
          moved.values()[i] += offset;
          return objective(moved, {}, true).total;
        };
        const double difference =
            (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * step);
        INFO("modes " << modes << ", unknown " << i);
        const double largest = i < shape.centres() ? of_centres : of_angles;
        CHECK(std::abs(gradient[i] - difference) < 1.5e-3 * largest);
      }
    }
  }
}

TEST_CASE("SRBF: the gradient is what differences say at and beside centres of no length") {
  // |p| is rounded off within 1e-3 of 0, where steps must be so short that sums are in double here;
  // colours stay what they are, since they are the best.
  const auto btf = realistic_btf(2, "regular:3x6");
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  const std::vector<float> texel = texel_of(*btf, samples, 1, 1);
  Objective objective(samples, {4, 3}, Ridge{0, 1e-3, 0});
  objective.set_texel(texel);
  Kernels kernels = some_kernels({4, 3}, 3);
  for (int c = 0; c < 3; ++c) {
    kernels.centre(0, 1)[c] = 0;
    kernels.centre(2, 0)[c] = c == 1 ? 4e-4 : 0;
  }
  std::vector<double> gradient(kernels.shape().unknowns());
  objective(kernels, gradient, true);
  const auto error = [&](const Kernels& tried) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.pairs; ++i) {
      const auto b = evaluate(tried, btf->lights()[i % btf->lights().size()],
                              btf->views()[i / btf->lights().size()]);
      for (std::size_t c = 0; c < 3; ++c) sum += std::pow(b[c] - texel[c * samples.count + i], 2);
    }
    return sum / (3.0 * static_cast<double>(samples.pairs));
  };
  double largest = 0;
  for (const double g : gradient) largest = std::max(largest, std::abs(g));
  for (const double* centre : {kernels.centre(0, 1), kernels.centre(2, 0)}) {
    for (int c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(centre + c - kernels.values().data());
      const auto at = [&](double offset) {
        Kernels moved = kernels;
        moved.values()[i] += offset;
        return error(moved);
      };
      const double step = 2e-5;
      CHECK(std::abs(gradient[i] - (at(step) - at(-step)) / (2 * step)) < 2e-3 * largest);
    }
  }
}

TEST_CASE("SRBF: data made of its own kernels come back to 1e-3") {
  for (const std::size_t modes : {std::size_t{1}, std::size_t{3}}) {
    const auto btf = btf_of({some_kernels({3, modes}, 5)}, 1, "ubo81");
    const auto found = fitted(btf, {"kernels=6", "bits=float", "iterations=100",
                                    "modes_a_kernel=" + std::to_string(modes)});
    INFO("modes " << modes);
    CHECK(sample_error(*btf, *found).relative_rmse < 1e-3);
  }
}

TEST_CASE("SRBF: three half-way modes are one, the univariate form") {
  const Kernels three = [] {
    Kernels kernels = some_kernels({4, 3}, 3);
    std::ranges::fill(kernels.angles(), std::numbers::pi / 4);
    return kernels;
  }();
  Kernels one({4, 1});
  one.angles()[0] = std::numbers::pi / 4;
  for (std::size_t j = 0; j < 4; ++j) {
    double lengths = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double* p = three.centre(j, k);
      for (std::size_t c = 0; c < 3; ++c) one.centre(j, 0)[c] += p[c];
      lengths += smooth_length(p[0], p[1], p[2]);
    }
    const double* sum = one.centre(j, 0);
    for (std::size_t c = 0; c < 3; ++c) {
      one.colours()[3 * j + c] =
          three.colours()[3 * j + c] * std::exp(smooth_length(sum[0], sum[1], sum[2]) - lengths);
    }
  }
  for (const Direction& light : named_directions("fibonacci:20")) {
    for (const Direction& view : named_directions("fibonacci:20"))
      CHECK(evaluate(one, light, view)[1] == Approx(evaluate(three, light, view)[1]).epsilon(1e-4));
  }
}

TEST_CASE("SRBF: Lanczos's weights sum to one, repeat, and keep what is constant") {
  for (const auto& [coarse, fine] :
       {std::pair(4, 8), std::pair(2, 5), std::pair(1, 1), std::pair(1, 3), std::pair(32, 64)}) {
    for (int i = 0; i < coarse; ++i) {
      double sum = 0;
      for (const AxisTap& tap : lanczos_taps(i, coarse, fine)) {
        CHECK(tap.texel >= 0);
        CHECK(tap.texel < fine);
        sum += tap.weight;
      }
      CHECK(sum == Approx(1));
    }
  }
  // Equation 3.12 at x = 1/4, 3/4, ... for halving, before it is normalised.
  const auto taps = lanczos_taps(8, 16, 32);
  REQUIRE(taps.size() == 12);
  CHECK(taps[6].texel == 17);
  CHECK(taps[7].weight / taps[6].weight == Approx(0.270190 / 0.890067).epsilon(1e-4));
  const auto btf =
      synthetic_btf(5, 3, "regular:2x4", "regular:2x4",
                    [](int, int, const Direction&, const Direction&) { return Rgb(1, 2, 3); });
  const MipLevels levels(*btf);
  CHECK(levels.sizes().levels() == 3);
  std::vector<float> coarsest(3 * 64);
  levels.abrdf(2, 0, coarsest);
  CHECK(coarsest[1] == Approx(2 * btf->lights()[0].z));
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

TEST_CASE("SRBF: between texels and levels lies the blend of what they are, or of their numbers") {
  const auto btf = realistic_btf(2, "regular:3x6");
  const auto found = fitted(btf, {"bits=float", "kernels=3", "iterations=20", "filtering=numbers"});
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

TEST_CASE("SRBF: what diverges leaves its start") {
  std::vector<double> x = {1, 2, 3};
  const auto not_finite = [](std::span<const double>, std::span<double> gradient) {
    std::ranges::fill(gradient, 1.0);
    return std::numeric_limits<double>::quiet_NaN();
  };
  CHECK(!minimise(x, not_finite, {}));
  CHECK(x == std::vector<double>{1, 2, 3});
  // A valley that ends at a wall of infinity: the best point so far comes back.
  const auto wall = [](std::span<const double> at, std::span<double> gradient) {
    for (std::size_t i = 0; i < 3; ++i) gradient[i] = -1;
    const double sum = at[0] + at[1] + at[2];
    return sum > 9 ? std::numeric_limits<double>::infinity() : -sum;
  };
  CHECK(minimise(x, wall, {}));
  CHECK(x[0] + x[1] + x[2] >= 6);
  CHECK(x[0] + x[1] + x[2] <= 9);

  const auto btf = realistic_btf(1, "regular:3x6");
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  std::vector<float> texel = texel_of(*btf, samples);
  const Modes modes = modes_named("optimal", 3, true);
  TexelFitter fitter(samples, modes, 4);
  fitter.set_texel(texel);
  const TexelFit good = fitter.as_it_is(some_kernels({4, 3}, 3));
  texel[5] = std::numeric_limits<float>::infinity();
  const TexelFit end = fitter.descend(good, {});
  CHECK(end.fell_back);
  CHECK(std::ranges::equal(end.kernels.values(), good.kernels.values()));
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
  const std::vector<std::string> parameters = {"kernels=4", "iterations=15"};
  const TemporaryFolder folder;
  const auto kept = folder.path / "kept";
  const std::vector<float> whole = model_of(*fitted(btf, parameters, kept)).values;
  CHECK(std::filesystem::exists(kept / "level_2.f64"));
  std::filesystem::remove(kept / "level_0.f64");
  const bool same = model_of(*fitted(btf, parameters, kept)).values == whole;
  CHECK(same);
  CHECK(std::filesystem::exists(kept / "level_0.f64"));
  // Rounding and filtering come later: the pieces of 3 levels, fixed and free, serve others too.
  Progress progress;
  progress.keep_in(kept);
  const FitOptions others = fit_options(Settings::from_text(
      "", "test", {"kernels=4", "iterations=15", "bits=float", "filtering=numbers"}));
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
