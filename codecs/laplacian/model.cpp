#include "codecs/laplacian/model.h"

#include <algorithm>

namespace weft::laplacian {

namespace {

// Calls use(first value in the map, first value in the array) for every quad.
template <typename Use>
void each_eigen_quad(const Model& model, const Use& use) {
  const std::size_t p = model.head.lights.size();
  const std::size_t rows = model.levels() * model.head.views.size();
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t light = 0; light < p; ++light) {
      for (std::size_t quad = 0; quad < model.quads(); ++quad) {
        use(4 * (row * model.quads() * p + quad * p + light),
            (row * p + light) * model.slots() + 4 * quad);
      }
    }
  }
}

template <typename Use>
void each_weight_quad(const Model& model, const Use& use) {
  const auto map_width = static_cast<std::size_t>(model.weight_map_size().x);
  for (int level = 0; level < model.levels(); ++level) {
    const auto width = static_cast<std::size_t>(model.pyramid.width_of(level));
    const std::size_t first_row = model.first_weight_row(level);
    for (std::size_t quad = 0; quad < model.quads(); ++quad) {
      const Texel block = model.weight_block(level, quad);
      for (std::size_t texel = 0; texel < model.pyramid.texels(level); ++texel) {
        use(4 * ((block.y + texel / width) * map_width + block.x + texel % width),
            (first_row + texel) * model.slots() + 4 * quad);
      }
    }
  }
}

}  // namespace

std::size_t Model::first_weight_row(int level) const {
  std::size_t rows = 0;
  for (int k = 0; k < level; ++k) rows += pyramid.texels(k);
  return rows;
}

Texel Model::eigen_map_size() const {
  return {static_cast<int>(quads() * head.lights.size()),
          static_cast<int>(levels() * head.views.size())};
}

Texel Model::weight_map_size() const {
  if (quads() == 3) return {2 * pyramid.width, 2 * pyramid.height};
  return {static_cast<int>(quads()) * pyramid.width,
          pyramid.height + (pyramid.top > 0 ? pyramid.height_of(1) : 0)};
}

Texel Model::weight_block(int level, std::size_t quad) const {
  const int q = static_cast<int>(quad);
  const int w = pyramid.width_of(level);
  Texel origin{0, 0};
  if (quads() == 3) {
    for (int k = 0; k < level; ++k)
      origin = {origin.x + pyramid.width_of(k), origin.y + pyramid.height_of(k)};
    return {origin.x + q % 2 * w, origin.y + q / 2 * pyramid.height_of(level)};
  }
  if (level > 0) origin.y = pyramid.height;
  for (int k = 1; k < level; ++k) origin.x += static_cast<int>(quads()) * pyramid.width_of(k);
  return {origin.x + q * w, origin.y};
}

std::size_t Model::bytes() const {
  std::size_t texels = 0;
  for (const Texel& size : {eigen_map_size(), weight_map_size()})
    texels += static_cast<std::size_t>(size.x) * size.y;
  return 4 * texels * bytes_a_value(storage);
}

std::vector<float> Model::eigen_map() const {
  std::vector<float> map(eigen.size());
  each_eigen_quad(*this, [&](std::size_t in_map, std::size_t in_array) {
    std::copy_n(&eigen[in_array], 4, &map[in_map]);
  });
  return map;
}

std::vector<float> Model::weight_map() const {
  const Texel size = weight_map_size();
  std::vector<float> map(4 * static_cast<std::size_t>(size.x) * size.y);
  each_weight_quad(*this, [&](std::size_t in_map, std::size_t in_array) {
    std::copy_n(&weights[in_array], 4, &map[in_map]);
  });
  return map;
}

void Model::set_maps(const std::vector<float>& eigen_map, const std::vector<float>& weight_map) {
  eigen.resize(levels() * head.pairs() * slots());
  weights.resize(first_weight_row(levels()) * slots());
  each_eigen_quad(*this, [&](std::size_t in_map, std::size_t in_array) {
    std::copy_n(&eigen_map[in_map], 4, &eigen[in_array]);
  });
  each_weight_quad(*this, [&](std::size_t in_map, std::size_t in_array) {
    std::copy_n(&weight_map[in_map], 4, &weights[in_array]);
  });
}

}  // namespace weft::laplacian
