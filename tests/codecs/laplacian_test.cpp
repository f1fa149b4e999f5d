// What is special about the Laplacian codec: the paper's sizes, its pyramid, equation 7, its mean.

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "codecs/laplacian/model.h"
#include "codecs/laplacian/phong.h"
#include "codecs/laplacian/pyramid.h"
#include "codecs/nearest_table.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

using laplacian::Filters;
using laplacian::Pyramid;

std::unique_ptr<Representation> fit(const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters) {
  Progress progress;
  return codec_named("laplacian").fit(btf, Settings::from_text("", "test", parameters), progress);
}

// Nothing is left out of 16 texels or fewer.
std::vector<std::string> lossless(const std::string& filters, const std::string& prediction) {
  return {"components_y=16",    "components_cb=16",         "components_cr=16",
          "filters=" + filters, "prediction=" + prediction, "levels=3"};
}

Texcoord centre(int x, int y, int size) {
  return {(static_cast<float>(x) + 0.5F) / static_cast<float>(size),
          1 - (static_cast<float>(y) + 0.5F) / static_cast<float>(size)};
}

double weight_sum(const std::vector<laplacian::Tap>& taps) {
  return std::accumulate(taps.begin(), taps.end(), 0.0,
                         [](double sum, const auto& tap) { return sum + tap.weight; });
}

}  // namespace

TEST_CASE("Laplacian: at 81 x 81 directions and 64 x 64 texels the size is the paper's") {
  const HemisphereSampling ubo81(named_directions("ubo81"));
  laplacian::Model model{.head = {.width = 64, .height = 64, .views = ubo81, .lights = ubo81}};
  model.pyramid = {64, 64, laplacian::usual_top(64, 64, 8)};
  CHECK(model.pyramid.top == 4);
  CHECK(16 * model.eigen_map_size().x * model.eigen_map_size().y == 1'574'640);
  CHECK(16 * model.weight_map_size().x * model.weight_map_size().y == 262'144);
  CHECK(model.bytes() == 1'836'784);
  CHECK(compression_ratio({64, 64}, 6561, model.bytes()) == Approx(43.9).margin(0.05));
}

TEST_CASE("Laplacian: blocks of the weight map do not overlap and keep within it") {
  for (const auto& [width, height, top] :
       {std::tuple(64, 64, 4), std::tuple(13, 7, 2), std::tuple(3, 9, 1), std::tuple(5, 1, 0)}) {
    for (const std::size_t components : {2, 8, 12}) {
      const HemisphereSampling one(named_directions("fibonacci:1"));
      laplacian::Model model{
          .head = {.width = width, .height = height, .views = one, .lights = one}};
      model.pyramid = {width, height, top};
      model.components[0] = components;
      const auto size = model.weight_map_size();
      std::vector<int> used(static_cast<std::size_t>(size.x) * size.y);
      for (int level = 0; level <= top; ++level) {
        for (std::size_t quad = 0; quad < model.quads(); ++quad) {
          const auto block = model.weight_block(level, quad);
          for (int y = 0; y < model.pyramid.height_of(level); ++y) {
            for (int x = 0; x < model.pyramid.width_of(level); ++x) {
              REQUIRE(block.x + x < size.x);
              REQUIRE(block.y + y < size.y);
              REQUIRE(++used[static_cast<std::size_t>(block.y + y) * size.x + block.x + x] == 1);
            }
          }
        }
      }
    }
  }
}

TEST_CASE("Laplacian: filters keep a mean, and box2's coefficients sum to zero under each parent") {
  for (const Filters filters : {Filters::box3, Filters::box2, Filters::linear}) {
    const Pyramid pyramid{13, 8, 3, filters};
    for (int level = 1; level <= 3; ++level) {
      for (std::size_t texel = 0; texel < pyramid.texels(level); ++texel) {
        const auto down = pyramid.down(level, texel);
        CHECK(weight_sum(down) == Approx(1));
        if (filters == Filters::box3) CHECK(down.size() == 9);
        if (filters != Filters::box2) continue;
        // Its mean is of those texels, each alike, that ask it in return.
        std::size_t children = 0;
        for (std::size_t fine = 0; fine < pyramid.texels(level - 1); ++fine)
          children += pyramid.up(level - 1, fine, level)[0].texel == texel ? 1 : 0;
        CHECK(children == down.size());
        for (const auto& tap : down)
          CHECK(pyramid.up(level - 1, tap.texel, level)[0].texel == texel);
      }
    }
    for (int coarse = 1; coarse <= 3; ++coarse) {
      for (std::size_t texel = 0; texel < pyramid.texels(0); ++texel)
        CHECK(weight_sum(pyramid.up(0, texel, coarse)) == Approx(1));
    }
  }
}

TEST_CASE("Laplacian: without anything left out, texels come back at level 0, boxes at level 1") {
  const auto btf = realistic_btf(4, "regular:3x6");
  for (const std::string filters : {"box3", "box2", "linear"}) {
    for (const std::string prediction : {"open", "closed"}) {
      INFO(filters << ' ' << prediction);
      const auto fitted = fit(btf, lossless(filters, prediction));
      CHECK(sample_error(*btf, *fitted).relative_rmse < 1e-5);
      if (filters != "box3") continue;
      // Equation 2 by hand, at texel (1, 0) of level 1: columns 1 to 3, rows 3, 0 and 1.
      const std::size_t light = 7, view = 5;
      Rgb mean(0, 0, 0);
      for (const int x : {1, 2, 3}) {
        for (const int y : {3, 0, 1}) mean += btf->at(light, view, x, y) / 9;
      }
      const Direction& l = btf->lights()[light];
      const Direction& v = btf->views()[view];
      const Rgb at_one = fitted->evaluate(centre(1, 0, 2), l, v, 1);
      CHECK((at_one - mean).length() < 1e-5F);
      // Equation 7 is linear between the levels.
      const Rgb at_zero = fitted->evaluate(centre(1, 0, 2), l, v, 0);
      const Rgb between = fitted->evaluate(centre(1, 0, 2), l, v, 0.25F);
      CHECK((between - (at_zero * 0.75F + at_one * 0.25F)).length() < 1e-5F);
    }
  }
}

TEST_CASE("Laplacian: nothing jumps where the level of detail passes a whole number") {
  const auto btf = realistic_btf(16, "regular:3x6");
  for (const std::string filters : {"box3", "linear"}) {
    const auto fitted = fit(btf, {"filters=" + filters, "levels=4"});
    for (int i = 0; i < 100; ++i) {
      const Texcoord uv(std::fmod(0.618F * static_cast<float>(i), 1.0F),
                        std::fmod(0.755F * static_cast<float>(i), 1.0F));
      for (const float level : {1.0F, 2.0F, 3.0F}) {
        const auto at = [&](float lod) {
          return fitted->evaluate(uv, btf->lights()[3], btf->views()[4], lod);
        };
        CHECK((at(level - 1e-5F) - at(level + 1e-5F)).length() < 1e-4F);
      }
      const Direction up(0, 0, 1);
      CHECK(fitted->evaluate(uv, up, up, 3) == fitted->evaluate(uv, up, up, 20));
      CHECK(fitted->evaluate(uv, up, up, -1) == fitted->evaluate(uv, up, up, 0));
    }
  }
}

TEST_CASE("Phong's parameters come back, none below zero") {
  const HemisphereSampling ubo81(named_directions("ubo81"));
  const auto values_of = [&](const laplacian::Phong& phong) {
    std::vector<double> values;
    for (const Direction& view : ubo81.directions()) {
      for (const Direction& light : ubo81.directions()) values.push_back(phong(light, view));
    }
    return values;
  };
  for (const laplacian::Phong& truth :
       {laplacian::Phong{0.1F, 0.5F, 0.3F, 20}, laplacian::Phong{0.02F, 0.1F, 4, 90},
        laplacian::Phong{0, 1e-5F, 3e-6F, 5}}) {
    const laplacian::Phong found = laplacian::fit_phong(ubo81, ubo81, values_of(truth));
    CHECK(found.ka == Approx(truth.ka).epsilon(1e-3).margin(1e-3 * truth.kd));
    CHECK(found.kd == Approx(truth.kd).epsilon(1e-3));
    CHECK(found.ks == Approx(truth.ks).epsilon(1e-3));
    CHECK(found.alpha == Approx(truth.alpha).epsilon(1e-3));
  }
  const laplacian::Phong negative =
      laplacian::fit_phong(ubo81, ubo81, values_of({-0.2F, 0.5F, 0.1F, 3}));
  for (const float parameter : {negative.ka, negative.kd, negative.ks, negative.alpha})
    CHECK(parameter >= 0);
  CHECK(laplacian::fit_phong(ubo81, ubo81, values_of({0, 0, 0, 1})) == laplacian::Phong{});
}

TEST_CASE("Phong's lobe does not tower where the samples cannot tell its height") {
  // A view and lights that are never near each other's mirror direction: ks (N.H)^alpha with a huge
  // ks fits as well as a broad lobe.
  const HemisphereSampling view({from_spherical(radians(70.0), 0)});
  for (const double spread : {0.0, 0.4, 1.5}) {
    std::vector<Direction> lights;
    for (int i = -2; i <= 2; ++i) lights.push_back(from_spherical(radians(75.0), i * spread / 2));
    const HemisphereSampling light_sampling(spread > 0 ? lights : std::vector{lights[2]});
    for (const double sharp : {0.0, 50.0, 5000.0}) {
      std::vector<double> values;
      double largest = 0;
      for (const Direction& light : light_sampling.directions()) {
        const double half_z = (light + view.directions()[0]).normalized().z;
        values.push_back(0.1 + std::pow(half_z / 0.5, sharp) * 1e-3);
        largest = std::max(largest, values.back());
      }
      const laplacian::Phong phong = laplacian::fit_phong(view, light_sampling, values);
      INFO("spread " << spread << " sharp " << sharp);
      // ka, kd and ks each reach the largest sample at most, and kd is for a light 75 degrees low.
      CHECK(phong({0, 0, 1}, {0, 0, 1}) <= 2 * largest / std::cos(radians(75.0)));
      CHECK(phong.ks <= 2.1 * largest);
    }
  }
}

TEST_CASE("Laplacian: each option for a weak point lowers the error, at the same bytes") {
  const auto btf = realistic_btf(16, "regular:4x8");
  const auto error = [&](const std::vector<std::string>& parameters) {
    return sample_error(*btf, *fit(btf, parameters)).rmse;
  };
  const double paper = error({"top=mean", "prediction=open"});
  const double around_model = error({"top=model", "prediction=open"});
  const double closed = error({"top=model", "prediction=closed"});
  INFO("paper " << paper << ", around the model " << around_model << ", closed " << closed);
  CHECK(around_model < 0.95 * paper);
  CHECK(closed < around_model);
  CHECK(error({"components_y=12"}) < 0.9 * closed);
  CHECK(error({"top=mean", "prediction=open", "chroma_mean=cosine"}) < 0.995 * paper);
  CHECK(error({"top=mean", "prediction=open", "filters=box2"}) < 0.98 * paper);
  CHECK(fit(btf, {})->bytes() == fit(btf, {"top=mean", "prediction=open"})->bytes());
}

TEST_CASE("Laplacian: too many levels are refused") {
  try {
    fit(realistic_btf(4, "regular:3x6"), {"levels=4"});
    FAIL("accepted");
  } catch (const std::exception& error) {
    CHECK_THAT(error.what(), Catch::Contains("levels") && Catch::Contains("at most 3"));
  }
}

TEST_CASE("The table of nearest directions names the nearest, but for half a cell") {
  for (const std::string name : {"ubo81", "fibonacci:2000", "fibonacci:1"}) {
    const HemisphereSampling sampling(named_directions(name));
    const NearestTable table(sampling);
    for (std::size_t i = 0; i < sampling.size(); ++i) REQUIRE(table(sampling[i]) == i);
    for (int i = 0; i < 1000; ++i) {
      const double theta = std::fmod(0.618 * i, 1.0) * radians(90.0);
      const Direction d = from_spherical(theta, std::fmod(0.755 * i, 1.0) * radians(360.0));
      const float best = d ^ sampling[sampling.nearest(d)];
      CHECK(std::acos(std::min(1.0F, d ^ sampling[table(d)])) <
            std::acos(std::min(1.0F, best)) + 0.023F);
    }
  }
}
