#include "study/asymmetry.h"

#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "codecs/luminance.h"

namespace weft {

FieldEnergies field_energies(const Btf& btf, int x, int y) {
  const std::size_t views = btf.views().size();
  const std::size_t lights = btf.lights().size();
  std::vector<float> abrdf(3 * views * lights);
  btf.abrdf(x, y, abrdf);
  FieldEnergies energies{std::vector<double>(lights), std::vector<double>(views)};
  for (std::size_t view = 0; view < views; ++view) {
    for (std::size_t light = 0; light < lights; ++light) {
      const double cosine = btf.lights()[light].z;
      if (!(cosine > 0)) continue;
      double luminance = 0;
      for (std::size_t c = 0; c < 3; ++c)
        luminance += luminance_of_rgb[c] * abrdf[3 * (view * lights + light) + c];
      energies.light_fields[light] += luminance / cosine;
      energies.reflectance_fields[view] += luminance / cosine;
    }
  }
  return energies;
}

double roughness(const HemisphereSampling& sampling, std::span<const double> series) {
  std::set<std::pair<std::uint16_t, std::uint16_t>> edges;
  for (const auto& triangle : sampling.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      if (b < sampling.size()) edges.emplace(a, b);  // else the ring below the horizon
    }
  }
  const double sum = std::accumulate(series.begin(), series.end(), 0.0);
  if (edges.empty() || !(sum > 0)) return 0;
  double difference = 0;
  for (const auto& [a, b] : edges) difference += std::abs(series[a] - series[b]);
  return difference / static_cast<double>(edges.size()) * static_cast<double>(series.size()) / sum;
}

double asymmetry(const Btf& btf, const FieldEnergies& energies) {
  const auto& [light_fields, reflectance_fields] = energies;
  if (light_fields.size() != reflectance_fields.size()) return 0;
  double difference = 0;
  double sum = 0;
  for (std::size_t i = 0; i < light_fields.size(); ++i) {
    if ((btf.lights()[i] - btf.views()[i]).length() > 1e-4F) return 0;
    difference += std::abs(light_fields[i] - reflectance_fields[i]);
    sum += (light_fields[i] + reflectance_fields[i]) / 2;
  }
  return sum > 0 ? difference / sum : 0;
}

}  // namespace weft
