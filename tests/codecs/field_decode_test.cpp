// Reflectance fields of lobes are decoded as equation 1 has them, whatever they are stored in.

#include <catch2/catch.hpp>
#include <cmath>

#include "btf/random.h"
#include "btf/raw_appearance.h"
#include "codecs/reflectance_fields/representation.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;
using namespace weft::reflectance_fields;

namespace {

// Lobes of any axis, some below the horizon, some black.
Model random_lobes(std::size_t lobes, Storage storage) {
  const auto btf = realistic_btf(3, "ubo81");
  Model model = empty_model(*btf, "lobes", Kind::lobes, lobes, storage, "{}");
  const std::size_t stride = model.floats_a_field();
  for (std::size_t i = 0; i < model.fields.size(); ++i) {
    const float u = unit_float(hash_coordinates(lobes, i));
    const std::size_t k = i % stride;
    const bool is_colour = k >= 4 * lobes;
    const bool is_exponent = !is_colour && k % 4 == 3;
    model.fields[i] = is_colour ? u : is_exponent ? 1 + 100 * u * u * u : 2 * u - 0.8F;
  }
  for (std::size_t i = 0; i < stride - 4; ++i)
    if (i % 4 != 3) model.fields[5 * stride + i] = 0;
  store_fields(model);
  return model;
}

// Equation 1 in doubles, of what is stored.
std::array<double, 3> field_value(const Model& model, std::size_t field, const Direction& light) {
  const float* numbers = &model.fields[field * model.floats_a_field()];
  double sum = 0;
  for (std::size_t k = 0; k < model.lobes; ++k, numbers += 4) {
    const double x = numbers[0];
    const double y = numbers[1];
    const double z = numbers[2];
    const double length = std::sqrt(x * x + y * y + z * z);
    const double product = x * light.x + y * light.y + z * light.z;
    if (product > 0) sum += length * std::pow(product / length, double{numbers[3]});
  }
  return {sum * numbers[0], sum * numbers[1], sum * numbers[2]};
}

std::array<double, 3> expected(const Model& model, const RingStencil& rings,
                               const AppearanceQuery& query) {
  const StencilLane views = rings.locate(model.head.views, query.view);
  const TexelStencil texels = bilinear_texels(query.uv, model.head.width, model.head.height);
  std::array<double, 3> value{};
  for (std::size_t v = 0; v < 4; ++v) {
    for (std::size_t t = 0; t < 4; ++t) {
      const std::array<double, 3> field = field_value(
          model, static_cast<std::size_t>(views.index[v]) * model.head.texels() + texels.index[t],
          query.light);
      for (std::size_t c = 0; c < 3; ++c)
        value[c] += double{views.weight[v]} * texels.weight[t] * field[c] * model.scale;
    }
  }
  return value;
}

}  // namespace

TEST_CASE("Lobes are decoded as equation 1 has them, one to four, in halfs and in floats") {
  for (const Storage storage : {Storage::half, Storage::float32}) {
    for (std::size_t lobes = 1; lobes <= 4; ++lobes) {
      const Model model = random_lobes(lobes, storage);
      const RingStencil rings(model.head.views);
      const FieldRepresentation representation(model);
      std::vector<AppearanceQuery> queries;
      for (int i = 0; i < 500; ++i) {
        const auto number = [&](int k) { return unit_float(hash_coordinates(i, k, 7)); };
        queries.push_back({Texcoord(number(0), number(1)),
                           from_spherical(radians(89 * number(2)), radians(360 * number(3))),
                           from_spherical(radians(89 * number(4)), radians(360 * number(5))), 0});
      }
      std::vector<Rgb> batch(queries.size());
      representation.evaluate(queries, batch);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const AppearanceQuery& q = queries[i];
        const std::array<double, 3> wanted = expected(model, rings, q);
        const Rgb alone = representation.evaluate(q.uv, q.light, q.view, 0);
        INFO(lobes << " lobes, " << name_of(storage) << ", query " << i);
        for (int c = 0; c < 3; ++c) {
          REQUIRE(alone[c] == Approx(wanted[c]).epsilon(2e-5).margin(1e-6));
          REQUIRE(batch[i][c] == Approx(wanted[c]).epsilon(2e-5).margin(1e-6));
        }
      }
    }
  }
}
