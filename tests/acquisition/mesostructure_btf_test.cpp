// BTFs of the project's own mesostructures: white furnace, shifted content, an image against a
// mesh.
//
// z-tests: two runs of 8 seeds each give means and standard errors at every texel. With 14 degrees
// of freedom |z| > 5 happens by chance in 0.02 % of texels; up to 0.1 % are let pass, and the mean
// of z^2, 1.17 by chance, may reach 1.4.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "acquisition/mesostructure.h"
#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "images/image_file.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;

namespace {

std::filesystem::path scene_file(const std::string& name) {
  return mesostructure_folder() / (name + ".toml");
}

Mesostructure painted_white(const std::string& name) {
  Mesostructure structure = read_mesostructure(scene_file(name), {"smooth=false"});
  for (Bsdf& material : structure.materials) material = Bsdf::lambert(Rgb(1));
  return structure;
}

struct Estimate {
  std::vector<double> mean;
  std::vector<double> variance;  // of the mean
};

Estimate estimate(const Mesostructure& structure, const std::vector<Direction>& lights,
                  const Direction& view, TraceSettings settings) {
  constexpr int runs = 8;
  const ViewTracer tracer(structure, lights, settings);
  Estimate e;
  for (int run = 0; run < runs; ++run) {
    const TracedView traced = tracer.trace(view, 100 + static_cast<std::uint64_t>(run));
    e.mean.resize(traced.values.size());
    e.variance.resize(traced.values.size());
    for (std::size_t i = 0; i < traced.values.size(); ++i) {
      e.mean[i] += traced.values[i];
      e.variance[i] += static_cast<double>(traced.values[i]) * traced.values[i];
    }
  }
  for (std::size_t i = 0; i < e.mean.size(); ++i) {
    e.mean[i] /= runs;
    e.variance[i] = std::max(0.0, e.variance[i] / runs - e.mean[i] * e.mean[i]) / (runs - 1);
  }
  return e;
}

// `shifted` gives the index in `b` of what stands at an index in `a`.
template <typename Shifted>
void check_equal(const Estimate& a, const Estimate& b, const Shifted& shifted) {
  double z2 = 0;
  double difference = 0;
  double variance = 0;
  std::size_t outside = 0;
  for (std::size_t i = 0; i < a.mean.size(); ++i) {
    const std::size_t j = shifted(i);
    const double z = (a.mean[i] - b.mean[j]) / std::sqrt(a.variance[i] + b.variance[j] + 1e-16);
    outside += std::abs(z) > 5 ? 1 : 0;
    z2 += std::min(z * z, 25.0) / static_cast<double>(a.mean.size());
    difference += a.mean[i] - b.mean[j];
    variance += a.variance[i] + b.variance[j];
  }
  CHECK(static_cast<double>(outside) <= 0.001 * static_cast<double>(a.mean.size()));
  CHECK(z2 < 1.4);
  // The whole picture: channels and the two lights share paths, so their errors may add up, six
  // alike.
  CHECK(std::abs(difference) < 4 * std::sqrt(6 * variance));
}

// The tile's mean integrated over fibonacci:1024 lights, at every view. The lights are dealt to 64
// tracers, every 64th to each, with paths of their own: 32,768 paths a view, a standard error of
// 0.2 % (on fibres 0.5 %), at a 64th of the rays.
std::vector<double> albedos(const std::shared_ptr<const TraceableStructure>& structure,
                            const std::vector<Direction>& views, std::uint64_t run) {
  constexpr std::size_t deals = 64;
  const HemisphereSampling lights(named_directions("fibonacci:1024"));
  const std::vector<double> solid_angles = lights.solid_angles();
  std::vector<double> albedo(views.size());
  for (std::size_t deal = 0; deal < deals; ++deal) {
    std::vector<Direction> dealt;
    for (std::size_t l = deal; l < lights.size(); l += deals) dealt.push_back(lights[l]);
    const ViewTracer tracer(structure, dealt,
                            {.width = 16,
                             .height = 16,
                             .spp = 2,
                             .max_bounces = TraceSettings::unlimited,
                             .views = views.size(),
                             .seed = deals * run + deal});
    for (std::size_t v = 0; v < views.size(); ++v) {
      const TracedView traced = tracer.trace(views[v], v);
      for (std::size_t i = 0; i < traced.values.size(); i += 3) {
        albedo[v] += traced.values[i] * solid_angles[deal + deals * (i / 3 / 256)] / 256;
      }
    }
  }
  return albedo;
}

// Views that are off by more than 0.7 % are traced four times more: on fibres 1 % is then over four
// standard errors, so that chance fails one of 81 views in fewer than 1 of 500 seeds.
void check_white(const std::string& name, const std::vector<Direction>& views) {
  const auto structure = std::make_shared<const TraceableStructure>(painted_white(name));
  std::vector<double> albedo = albedos(structure, views, 0);
  std::vector<std::size_t> doubtful;
  std::vector<Direction> again;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (std::abs(albedo[v] - 1) <= 0.007) continue;
    doubtful.push_back(v);
    again.push_back(views[v]);
  }
  constexpr std::uint64_t more = 4;
  for (std::uint64_t run = 1; !again.empty() && run <= more; ++run) {
    const std::vector<double> once_more = albedos(structure, again, run);
    for (std::size_t i = 0; i < again.size(); ++i) albedo[doubtful[i]] += once_more[i];
  }
  for (const std::size_t v : doubtful) albedo[v] /= 1 + more;
  for (std::size_t v = 0; v < views.size(); ++v) {
    INFO(name << ", view at theta " << degrees(theta_of(views[v])) << ", phi "
              << degrees(phi_of(views[v])));
    CHECK(albedo[v] == Approx(1).epsilon(0.01));
  }
}

}  // namespace

TEST_CASE("a mesostructure painted white sends back all light", "[heavy]") {
  for (const std::string& name : mesostructure_names()) {
    check_white(name, {Direction(0, 0, 1), from_spherical(radians(60.0), 0.3),
                       from_spherical(radians(75.0), 3.9)});
  }
}

// All structures, a quarter of them a test: each takes some minutes.
void check_white_at_every_view(std::size_t quarter) {
  const std::vector<std::string> names = mesostructure_names();
  for (std::size_t i = quarter; i < names.size(); i += 4)
    check_white(names[i], named_directions("ubo81"));
}

TEST_CASE("white structures send back all light at every view, first quarter", "[slow]") {
  check_white_at_every_view(0);
}

TEST_CASE("white structures send back all light at every view, second quarter", "[slow]") {
  check_white_at_every_view(1);
}

TEST_CASE("white structures send back all light at every view, third quarter", "[slow]") {
  check_white_at_every_view(2);
}

TEST_CASE("white structures send back all light at every view, last quarter", "[slow]") {
  check_white_at_every_view(3);
}

TEST_CASE("an offset shifts every image by whole texels and changes nothing else", "[heavy]") {
  const std::vector<Direction> lights = {from_spherical(0.5, 1.0),
                                         from_spherical(radians(85.0), 4.0)};
  const TraceSettings settings{.width = 100, .height = 100, .spp = 8, .max_bounces = 4, .seed = 2};
  const auto shifted = [](std::size_t i) {
    const std::size_t c = i % 3, x = i / 3 % 100, y = i / 300 % 100, l = i / 30000;
    return 3 * ((l * 100 + (y + 100 - 21) % 100) * 100 + (x + 37) % 100) + c;
  };
  for (const char* name : {"checker", "rings", "tissue"}) {
    for (const Direction& view : {Direction(0, 0, 1), from_spherical(radians(60.0), 2.0)}) {
      INFO(name << ", view at theta " << degrees(theta_of(view)));
      const Estimate plain = estimate(read_mesostructure(scene_file(name)), lights, view, settings);
      TraceSettings other = settings;
      other.seed = 3;
      const Estimate moved = estimate(read_mesostructure(scene_file(name), {"offset=[0.37, 0.21]"}),
                                      lights, view, other);
      check_equal(plain, moved, shifted);
    }
  }
}

TEST_CASE("a height field from an image and the same field as a mesh give the same BTF") {
  const TemporaryFolder folder;
  constexpr int n = 32;
  Image image(n, n, 1);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      image.values[y * n + x] = static_cast<float>(
          0.5 + 0.3 * std::sin(6.2831853 * (x + 0.5) / n) * std::cos(12.566371 * (y + 0.5) / n) +
          0.2 * std::cos(6.2831853 * (x + 2 * y) / n));
    }
  }
  write_image(folder.path / "height.exr", image, Encoding::linear);
  std::ofstream(folder.path / "image.toml")
      << "type = \"heightfield\"\nfile = \"height.exr\"\nheight = 0.2\n"
         "[materials.default]\ntype = \"lambert\"\nalbedo = 0.7\n";
  // Vertices at pixel centres, from the bottom row up, one row and column more to close the period.
  std::ofstream obj(folder.path / "mesh.obj");
  const auto at = [&](int column, int row) {
    return 0.2F * image.values[static_cast<std::size_t>((n - 1 - row % n) % n) * n + column % n];
  };
  for (int row = 0; row <= n; ++row) {
    for (int column = 0; column <= n; ++column) {
      obj << "v " << (column + 0.5) / n << " " << (row + 0.5) / n << " " << at(column, row) << "\n";
    }
  }
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const int a = row * (n + 1) + column + 1;
      obj << "f " << a << " " << a + 1 << " " << a + n + 2 << "\n";
      obj << "f " << a << " " << a + n + 2 << " " << a + n + 1 << "\n";
    }
  }
  obj.close();
  std::ofstream(folder.path / "mesh.toml")
      << "type = \"mesh\"\nfile = \"mesh.obj\"\n"
         "[materials.default]\ntype = \"lambert\"\nalbedo = 0.7\n";
  const std::vector<Direction> lights = {from_spherical(0.5, 1.0),
                                         from_spherical(radians(70.0), 4.0)};
  const TraceSettings settings{.width = 48, .height = 48, .spp = 16, .max_bounces = 4, .seed = 4};
  const Direction view = from_spherical(radians(50.0), 5.0);
  TraceSettings other = settings;
  other.seed = 5;
  check_equal(estimate(read_mesostructure(folder.path / "image.toml"), lights, view, settings),
              estimate(read_mesostructure(folder.path / "mesh.toml"), lights, view, other),
              [](std::size_t i) { return i; });
}
