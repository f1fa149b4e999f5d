// What draws the SRBF fits of neighbouring texels and levels together: the order of their kernels,
// the mipmap constraint and the smoothness term, and what lets go of them at an edge.

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "btf/random.h"
#include "codecs/srbf/kernel_order.h"
#include "codecs/srbf/level_fit.h"
#include "codecs/srbf/srbf_representation.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;
using namespace weft::srbf;

namespace {

double random(std::uint64_t i, int what) {
  return 2.0 * unit_float(hash_coordinates(29, i, what)) - 1;
}

Kernels some_kernels(Shape shape, double widest, int seed) {
  Kernels kernels(shape);
  for (std::size_t i = 0; i < shape.centres(); ++i)
    kernels.values()[i] = widest * 0.57 * random(i, 2 * seed);
  const std::array<double, most_modes> angles = {0.8, 0.1, 1.4, -0.7};
  std::copy_n(angles.begin(), shape.modes, kernels.angles().begin());
  for (std::size_t i = 0; i < shape.colours(); ++i)
    kernels.colours()[i] = 1 + 0.5 * random(i, 2 * seed + 1);
  return kernels;
}

/// Kernel order[j] in the place of j.
Kernels permuted(const Kernels& kernels, const std::vector<std::size_t>& order) {
  Kernels result = kernels;
  for (std::size_t j = 0; j < order.size(); ++j) {
    std::copy_n(kernels.centre(order[j], 0), 3 * kernels.shape().modes, result.centre(j, 0));
    for (std::size_t c = 0; c < 3; ++c)
      result.colours()[3 * j + c] = kernels.colours()[3 * order[j] + c];
  }
  return result;
}

/// A shuffle in which no kernel stays where it is.
std::vector<std::size_t> turned(std::size_t n) {
  std::vector<std::size_t> order(n);
  for (std::size_t j = 0; j < n; ++j) order[j] = (7 * j + 3) % n;
  return order;
}

std::shared_ptr<const Btf> btf_of(const std::vector<Kernels>& texels, int width) {
  const int height = static_cast<int>(texels.size()) / width;
  return synthetic_btf(width, height, "regular:3x8", "regular:3x8",
                       [&](int x, int y, const Direction& light, const Direction& view) {
                         const auto b = evaluate(texels[y * width + x], light, view);
                         return Rgb(static_cast<float>(b[0]), static_cast<float>(b[1]),
                                    static_cast<float>(b[2])) /
                                light.z;
                       });
}

Model fitted(const std::shared_ptr<const Btf>& btf, const std::vector<std::string>& parameters) {
  Progress silent;
  const auto fit =
      codec_named("srbf").fit(btf, Settings::from_text("", "test", parameters), silent);
  return dynamic_cast<const SrbfRepresentation&>(*fit).model();
}

double error_of(const Model& model) {
  return nlohmann::json::parse(model.report)["levels"][0]["relative_rmse"];
}

Kernels kernels_of(const Model& model, int level, std::size_t texel) {
  const Layout layout = model.layout();
  Kernels kernels(model.shape);
  const auto number = [&](std::size_t place) {
    const std::size_t row = model.sizes().first_texel(level) + texel;
    return model.scale[place] * model.values[row * model.row() + place];
  };
  for (std::size_t j = 0; j < model.shape.kernels; ++j) {
    for (std::size_t s = 0; s < 3 * model.shape.modes; ++s)
      kernels.centre(j, 0)[s] = number(layout.place(j, s));
    for (std::size_t c = 0; c < 3; ++c)
      kernels.colours()[3 * j + c] = number(layout.place(j, 3 * model.shape.modes + c));
  }
  for (std::size_t k = 0; k < model.shape.modes; ++k)
    kernels.angles()[k] = number(layout.angle_place(k));
  return kernels;
}

/// Mean distance of the finest level's texels from their parents.
double from_parents(const Model& model) {
  const MipSizes sizes = model.sizes();
  double sum = 0;
  for (std::size_t t = 0; t < sizes.texels(0); ++t)
    sum += distance(kernels_of(model, 0, t), kernels_of(model, 1, sizes.parent(0, t)));
  return sum / static_cast<double>(sizes.texels(0));
}

/// Mean distance of the finest level's texels from those at their right, where `counts(x)`.
double from_neighbours(const Model& model, const std::function<bool(int x)>& counts) {
  const int width = model.sizes().width;
  double sum = 0;
  int count = 0;
  for (std::size_t t = 0; t < model.sizes().texels(0); ++t) {
    const int x = static_cast<int>(t) % width;
    if (x + 1 == width || !counts(x)) continue;
    sum += distance(kernels_of(model, 0, t), kernels_of(model, 0, t + 1));
    ++count;
  }
  return sum / count;
}

bool everywhere(int /*x*/) {
  return true;
}

/// Texels of two materials, four columns each, with small changes of colour.
std::shared_ptr<const Btf> two_materials() {
  std::vector<Kernels> texels;
  for (std::size_t t = 0; t < 64; ++t) {
    Kernels kernels = some_kernels({3, 3}, t % 8 < 4 ? 4 : 9, t % 8 < 4 ? 1 : 2);
    for (std::size_t i = 0; i < 9; ++i) kernels.colours()[i] += 0.1 * random(9 * t + i, 77);
    texels.push_back(kernels);
  }
  return btf_of(texels, 8);
}

}  // namespace

TEST_CASE("SRBF: permuted kernels are put back in order, and no order lies nearer") {
  const Kernels reference = some_kernels({20, 3}, 9, 1);
  Kernels kernels = reference;
  for (std::size_t i = 0; i < kernels.values().size(); ++i)
    kernels.values()[i] += 0.05 * random(i, 50);
  const Kernels back = in_order_of(reference, permuted(kernels, turned(20)));
  CHECK(std::ranges::equal(back.values(), kernels.values()));

  // Kernels that have nothing to do with one another, where a greedy choice goes wrong.
  for (int seed = 10; seed < 20; ++seed) {
    const Kernels a = some_kernels({5, 2}, 6, seed);
    const Kernels b = some_kernels({5, 2}, 6, seed + 100);
    std::vector<std::size_t> order(5);
    std::iota(order.begin(), order.end(), std::size_t{0});
    double least = std::numeric_limits<double>::infinity();
    do {
      least = std::min(least, distance(a, permuted(b, order)));
    } while (std::ranges::next_permutation(order).found);
    CHECK(distance(a, in_order_of(a, b)) == Approx(least));
    const Direction light = from_spherical(0.4, 1);
    const Direction view = from_spherical(0.9, 4);
    CHECK(evaluate(in_order_of(a, b), light, view)[1] == Approx(evaluate(b, light, view)[1]));
  }

  Kernels broken = kernels;
  broken.centre(3, 1)[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(in_order_of(reference, broken).centre(3, 0)[0] == broken.centre(3, 0)[0]);
}

TEST_CASE("SRBF: a fit from another start takes its parent's order") {
  const Kernels material = some_kernels({6, 3}, 6, 3);
  Kernels parent = material;  // near enough to tell its kernels apart, too far to be a good fit
  for (std::size_t i = 0; i < parent.shape().centres(); ++i)
    parent.values()[i] += 0.8 * random(i, 60);
  const auto btf = btf_of(std::vector<Kernels>(4, material), 2);
  const MipLevels data(*btf);
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  const std::vector<Kernels> hints(4, permuted(material, turned(6)));
  FitOptions options;
  options.kernels = 6;
  options.modes = modes_named("half-light-view", 3, true);
  options.iterations = 5;
  options.sweeps = 0;
  Progress silent;
  const LevelResult found = fit_level(data, samples, options, 0, {parent}, hints, 1, silent);
  CHECK(found.restarts == 4);
  for (const Kernels& kernels : found.kernels) {
    CHECK(std::ranges::equal(in_order_of(parent, kernels).values(), kernels.values()));
  }
}

TEST_CASE("SRBF: the mipmap constraint draws texels to their parents, the more the heavier") {
  const auto btf = realistic_btf(4, "regular:3x6");
  double first = 0;
  double before = std::numeric_limits<double>::infinity();
  double error = 0;
  for (const char* weight : {"0", "1e-4", "1e-2", "1"}) {
    const Model model = fitted(
        btf, {"kernels=6", "iterations=40", "bits=float", std::string("mip_weight=") + weight});
    INFO("mip_weight " << weight);
    CHECK(from_parents(model) < 0.7 * before);
    CHECK(error_of(model) > error);
    before = from_parents(model);
    error = error_of(model);
    if (first == 0) first = before;
  }
  CHECK(before < 0.1 * first);
}

TEST_CASE("SRBF: the smoothness term draws neighbours together, the more the heavier") {
  const auto btf = realistic_btf(4, "regular:3x6");
  double before = std::numeric_limits<double>::infinity();
  double error = 0;
  for (const char* weight : {"0", "1e-4", "1e-2", "1"}) {
    const Model model = fitted(btf, {"kernels=6", "iterations=40", "bits=float", "robust=false",
                                     std::string("smooth_weight=") + weight});
    INFO("smooth_weight " << weight);
    CHECK(from_neighbours(model, everywhere) < 0.8 * before);
    CHECK(error_of(model) > error);
    before = from_neighbours(model, everywhere);
    error = error_of(model);
  }
}

TEST_CASE("SRBF: a robust penalty smooths each material and leaves the edge between them") {
  const auto btf = two_materials();
  const auto fit_with = [&](const std::string& weight, const std::string& robust) {
    return fitted(btf, {"kernels=4", "iterations=30", "bits=float", "smooth_weight=" + weight,
                        "robust=" + robust});
  };
  const auto inside = [](int x) { return x != 3; };
  const auto across = [](int x) { return x == 3; };
  const Model none = fit_with("0", "true");
  const Model robust = fit_with("1e-2", "true");
  const Model square = fit_with("1e-2", "false");
  CHECK(from_neighbours(robust, inside) < 0.85 * from_neighbours(none, inside));
  CHECK(from_neighbours(robust, across) > 0.8 * from_neighbours(none, across));
  CHECK(from_neighbours(square, across) < 0.5 * from_neighbours(none, across));
  CHECK(error_of(robust) < 0.5 * error_of(square));
}

TEST_CASE("SRBF: numbers that the GPU filters err less with a smoothness term, their default") {
  const auto btf = realistic_btf(8, "regular:3x6");
  const auto error = [&](const std::vector<std::string>& pulls) {
    std::vector<std::string> parameters = {"kernels=6", "iterations=30", "robust=false",
                                           "bits=float"};
    parameters.insert(parameters.end(), pulls.begin(), pulls.end());
    Model of_values = fitted(btf, parameters);
    Model of_numbers = of_values;
    of_numbers.filtering = Filtering::numbers;
    const SrbfRepresentation values(std::move(of_values));
    const SrbfRepresentation numbers(std::move(of_numbers));
    double difference = 0;
    double square = 0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
      const Texcoord uv(unit_float(hash_coordinates(7, i, 0)),
                        unit_float(hash_coordinates(7, i, 1)));
      const Direction light = btf->lights()[hash_coordinates(8, i) % btf->lights().size()];
      const Direction view = btf->views()[hash_coordinates(9, i) % btf->views().size()];
      const Rgb wanted = values.evaluate(uv, light, view, 0);
      difference += std::pow((numbers.evaluate(uv, light, view, 0) - wanted).length(), 2);
      square += std::pow(wanted.length(), 2);
    }
    return std::sqrt(difference / square);
  };
  const double without = error({});
  const double smooth = error({"smooth_weight=1e-2", "mip_weight=1e-2"});
  CHECK(smooth < 0.2);
  CHECK(smooth < 0.25 * without);
  // Asked for alone, they bring it along.
  const double by_default = error({"filtering=numbers"});
  CHECK(by_default < 0.2);
  CHECK(by_default < 0.25 * without);
}
