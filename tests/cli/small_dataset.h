// A small dataset whose every value is known, for tests of the program.
#pragma once

#include <filesystem>
#include <numbers>

#include "btf/btf.h"
#include "btf/btf_file.h"

/// Writes a Lambertian BTF of 4 x 2 texels, 7 views and 7 lights to `folder`. Its albedo is 0.1 for
/// the bottom left texel and rises by 0.1 a texel to the right, then upwards.
inline void write_small_dataset(const std::filesystem::path& folder) {
  std::vector<weft::Direction> directions = {{0, 0, 1}};
  for (int i = 0; i < 6; ++i) {
    directions.push_back(weft::from_spherical(weft::radians(50.0), weft::radians(60.0 * i)));
  }
  const weft::HemisphereSampling sampling(directions);
  weft::Btf btf(4, 2, sampling, sampling, weft::PixelType::float32);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      const double albedo = 0.1 * ((1 - y) * 4 + x + 1);
      for (std::size_t light = 0; light < sampling.size(); ++light) {
        const auto value = static_cast<float>(albedo / std::numbers::pi * sampling[light].z);
        for (std::size_t view = 0; view < sampling.size(); ++view) {
          btf.set(light, view, x, y, weft::Rgb(value, value, value));
        }
      }
    }
  }
  weft::write_btf(folder, btf);
}
