// What the visibility table calls certain, held against rays; and that tracing with it is tracing
// without.
#include "acquisition/visibility_table.h"

#include <cmath>
#include <set>

#include "acquisition/view_tracer.h"
#include "btf/hemisphere_sampling.h"
#include "btf/random.h"
#include "tests/acquisition/known_structures.h"

using namespace weft;

namespace {

struct Tally {
  int asked = 0;
  int certain = 0;
  int visible = 0;  // of the certain ones
  int wrong = 0;
};

// Random points of the facets below `facets_end`, each asked for one random light that faces it.
Tally hold_against_rays(const TraceableStructure& structure, const LightSet& lights,
                        std::size_t facets_end, int points, int most_rays = 4) {
  const VisibilityTable table(structure.facets, FacetCells(structure.facets), lights,
                              structure.scene, most_rays);
  Tally tally;
  for (int i = 0; i < points; ++i) {
    const auto u = [&](int dimension) { return unit_float(hash_coordinates(i, dimension, 5)); };
    const auto f = static_cast<std::uint32_t>(u(0) * static_cast<float>(facets_end));
    const auto l = static_cast<std::size_t>(u(1) * static_cast<float>(lights.size()));
    const float root = std::sqrt(u(2));
    const float a = root * (1 - u(3));
    const float b = root * u(3);
    const Facet& facet = structure.facets[f];
    if (!((lights[l] ^ facet.normal) > 0)) continue;
    ++tally.asked;
    const VisibilityTable::Answer answer = table.at(f, a, b)[l / lanes];
    if ((answer.known >> (l % lanes) & 1) == 0) continue;
    ++tally.certain;
    const bool visible = (answer.visible >> (l % lanes) & 1) != 0;
    tally.visible += visible ? 1 : 0;
    const Vec3 origin = ray_origin(facet.point(a, b), facet.normal);
    tally.wrong += structure.scene.intersect(origin, lights[l]).hit() == visible ? 1 : 0;
  }
  return tally;
}

/// @param views  of the dataset: the more, the more rays make its table.
ViewTracer tracer_of(const Mesostructure& structure, const TraceSettings& settings, bool table,
                     int views = 100'000) {
  TraceSettings s = settings;
  s.views = table ? views : 1;
  ViewTracer tracer(structure, named_directions("fibonacci:36"), s);
  REQUIRE((tracer.visibility().rays() > 0) == table);
  return tracer;
}

}  // namespace

TEST_CASE("of what the visibility table is certain of, fewer than 1 in 10,000 is wrong") {
  const TraceableStructure checker(test::checker(64));
  const LightSet lights(named_directions("ubo81"));
  const Tally tally = hold_against_rays(checker, lights, checker.facets.size(), 400'000);
  INFO(tally.asked << " asked, " << tally.certain << " certain, " << tally.visible << " visible, "
                   << tally.wrong << " wrong");
  CHECK(tally.asked > 250'000);
  CHECK(tally.certain > 0.9 * tally.asked);
  CHECK(tally.visible < 0.99 * tally.certain);
  CHECK(tally.wrong < 1e-4 * tally.certain);
}

TEST_CASE("a large facet is cut into cells, each with answers of its own place") {
  const TraceableStructure rings(test::rings(128, 16));
  const LightSet lights(named_directions("ubo81"));
  const Tally tally = hold_against_rays(rings, lights, 2, 300'000);  // the plane's two facets
  INFO(tally.asked << " asked, " << tally.certain << " certain, " << tally.visible << " visible, "
                   << tally.wrong << " wrong");
  CHECK(tally.certain > 0.6 * tally.asked);
  CHECK(tally.visible > 0.3 * tally.certain);
  CHECK(tally.visible < 0.9 * tally.certain);
  CHECK(tally.wrong < 2e-4 * tally.certain);
}

TEST_CASE("cells where shadows end are cut finer, where that pays") {
  const LightSet lights(named_directions("fibonacci:24"));
  const auto uncertain = [](const Tally& t) {
    return 1 - static_cast<double>(t.certain) / static_cast<double>(t.asked);
  };
  const auto check = [&](const TraceableStructure& structure) {
    const Tally coarse = hold_against_rays(structure, lights, structure.facets.size(), 100'000,
                                           VisibilityTable::rays_to_refine - 1);
    const Tally fine = hold_against_rays(structure, lights, structure.facets.size(), 100'000,
                                         VisibilityTable::rays_to_refine);
    INFO(fine.asked << " asked, " << uncertain(coarse) << " uncertain, " << uncertain(fine)
                    << " when cut, " << fine.wrong << " wrong");
    CHECK(uncertain(coarse) > 0.02);
    CHECK(uncertain(fine) < 0.4 * uncertain(coarse));
    CHECK(fine.wrong < 1e-4 * fine.certain);
  };
  check(TraceableStructure(test::checker(48)));
  check(TraceableStructure(test::rings(128, 16)));
}

TEST_CASE("of what is certain all around one in 32 is asked again, and stands for 32") {
  const TraceableStructure flat(test::flat(Rgb(1)));
  const LightSet lights(named_directions("ubo81"));
  const std::vector<Cell> cells = FacetCells(flat.facets).all();
  PlaceNumbers numbers;
  CellCorners corners = cell_corners(flat.facets, cells, 1, numbers);
  std::vector<std::uint16_t> wanted;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t g = 0; g < lights.groups(); ++g) wanted.push_back(lights.used_lanes(g));
  }
  VisibilityInquiry inquiry(flat.facets, lights, flat.scene, cells, std::move(corners), wanted);
  std::vector<VisibilityAnswer> answers(wanted.size());
  const auto pairs = static_cast<double>(cells.size() * lights.size());
  CHECK(static_cast<double>(inquiry.ask(0, answers).rays) == pairs);
  inquiry.agree(answers);
  double rays = 0;
  double certain = 0;
  constexpr int rounds =
      64;  // with 18,432 cells 1,152 packets, each asked twice: 3 % standard error
  for (int round = 1; round <= rounds; ++round) {
    const VisibilityInquiry::Round asked = inquiry.ask(round, answers);
    rays += static_cast<double>(asked.rays) / rounds;
    certain += static_cast<double>(asked.certain) / rounds;
    CHECK(asked.contradicted == 0);
  }
  CHECK(rays == Approx(pairs / 32).epsilon(0.12));
  CHECK(certain == Approx(pairs).epsilon(0.12));
}

TEST_CASE("what is certain all around is hardly asked again") {
  const TraceableStructure checker(test::checker(64));
  const LightSet lights(named_directions("ubo81"));
  const FacetCells cells(checker.facets);
  const int rounds = VisibilityTable::rays_to_refine - 1;
  const VisibilityTable table(checker.facets, cells, lights, checker.scene, rounds);
  const auto one_round = static_cast<double>(cells.count() * lights.size());
  INFO(static_cast<double>(table.rays()) / one_round << " rays a cell and light");
  CHECK(static_cast<double>(table.rays()) > 0.5 * one_round);
  CHECK(static_cast<double>(table.rays()) < 1.7 * one_round);
}

TEST_CASE("every cell of a facet is reached, and its rim too") {
  const std::vector<Facet> facets = facets_of(test::flat(Rgb(1)).mesh);
  const LightSet lights({{0, 0, 1}});
  const FacetCells cells(facets);
  const VisibilityTable table(facets, cells, lights, PeriodicScene(test::flat(Rgb(1)).mesh), 1);
  std::set<const VisibilityTable::Answer*> reached;
  for (std::uint32_t f = 0; f < 2; ++f) {
    for (int i = 0; i < 400'000; ++i) {
      const float root = std::sqrt(unit_float(hash_coordinates(i, 0)));
      const float share = unit_float(hash_coordinates(i, 1));
      reached.insert(table.at(f, root * (1 - share), root * share));
    }
  }
  const std::size_t inside = reached.size();
  CHECK(inside == cells.count());
  CHECK_FALSE(reached.contains(table.unknown()));
  for (std::uint32_t f = 0; f < 2; ++f) {
    for (int i = 0; i <= 1000; ++i) {
      const float t = static_cast<float>(i) / 1000;
      for (const auto* answer : {table.at(f, t, 0), table.at(f, 0, t), table.at(f, t, 1 - t),
                                 table.at(f, 1 - t + 1e-6F, t)})
        reached.insert(answer);
    }
  }
  CHECK(reached.size() == inside);
}

TEST_CASE("lanes beyond the last light are known and not visible") {
  const TraceableStructure flat(test::flat(Rgb(1)));
  for (const std::size_t count : {1UL, 15UL, 16UL, 17UL, 81UL}) {
    const LightSet lights(named_directions("fibonacci:" + std::to_string(count)));
    const VisibilityTable table(flat.facets, FacetCells(flat.facets), lights, flat.scene, 2);
    const VisibilityTable ignorant(lights);
    for (std::size_t g = 0; g < lights.groups(); ++g) {
      const auto unused = static_cast<std::uint16_t>(~lights.used_lanes(g));
      INFO("group " << g << " of " << count << " lights");
      CHECK(table.at(1, 0.3F, 0.3F)[g].known == 0xFFFF);
      CHECK(table.at(1, 0.3F, 0.3F)[g].visible == lights.used_lanes(g));
      for (const VisibilityTable::Answer& answer :
           {table.unknown()[g], ignorant.unknown()[g], ignorant.at(1, 0.3F, 0.3F)[g]}) {
        CHECK(answer.known == unused);
        CHECK(answer.visible == 0);
      }
    }
  }
}

TEST_CASE("with the table, the same paths give the same values but for what is wrong") {
  const TraceSettings settings{.width = 24, .height = 24, .spp = 32, .max_bounces = 2, .seed = 1};
  const Direction view = from_spherical(0.8, 2.0);
  const TracedView with = tracer_of(test::checker(64), settings, true).trace(view, 3);
  const TracedView without = tracer_of(test::checker(64), settings, false).trace(view, 3);
  CHECK(with.statistics.visibility_queries == without.statistics.visibility_queries);
  CHECK(without.statistics.answers_checked == 0);
  CHECK(with.statistics.shadow_rays < 0.3 * static_cast<double>(without.statistics.shadow_rays));
  const double share = static_cast<double>(with.statistics.answers_checked) /
                       static_cast<double>(with.statistics.visibility_queries);
  CHECK(share > 0.8 / 256);
  CHECK(share < 1.08 / 256);  // about 3,000 are checked: four and a half standard errors
  int different = 0;
  for (std::size_t i = 0; i < with.values.size(); ++i)
    different += std::abs(with.values[i] - without.values[i]) > 1e-4F ? 1 : 0;
  INFO(different << " of " << with.values.size());
  CHECK(different < 1e-3 * static_cast<double>(with.values.size()));
}

TEST_CASE("tracing with the table agrees with tracing without, texel by texel and in every pair",
          "[heavy]") {
  // z is the difference over the joint standard error, each from 32 groups of 16 samples. Both
  // errors are conservative, so chance puts fewer than 1 in 5,000 beyond 4.
  const TraceSettings settings{
      .width = 15, .height = 15, .spp = 512, .max_bounces = 4, .texel_errors = true, .seed = 1};
  const ViewTracer with = tracer_of(test::checker(64), settings, true);
  const ViewTracer without = tracer_of(test::checker(64), settings, false);
  int compared = 0;
  int outside = 0;
  double squares = 0;
  for (std::uint64_t v = 0; v < 2; ++v) {
    const Direction view = from_spherical(0.3 + 0.9 * static_cast<double>(v), 2.0);
    const TracedView a = with.trace(view, v);
    const TracedView b = without.trace(view, 10 + v);
    for (std::size_t i = 0; i < a.values.size(); ++i) {
      const double variance = std::pow(a.texel_errors[i], 2) + std::pow(b.texel_errors[i], 2);
      if (variance == 0) {
        CHECK(a.values[i] == Approx(b.values[i]).margin(1e-7));
        continue;
      }
      const double z = (a.values[i] - b.values[i]) / std::sqrt(variance);
      ++compared;
      outside += std::abs(z) > 4 ? 1 : 0;
      squares += z * z;
    }
    const std::size_t texels = a.values.size() / 3 / with.lights().size();
    for (std::size_t l = 0; l < with.lights().size(); ++l) {
      double difference = 0;
      for (std::size_t i = 3 * l * texels; i < 3 * (l + 1) * texels; ++i)
        difference += static_cast<double>(a.values[i]) - b.values[i];
      difference /= 3.0 * static_cast<double>(texels);
      INFO("view " << v << ", light " << l);
      CHECK(std::abs(difference) < 4 * std::hypot(a.standard_errors[l], b.standard_errors[l]));
    }
  }
  INFO(outside << " of " << compared << " beyond 4, mean z^2 " << squares / compared);
  CHECK(outside < 2e-4 * compared);
  CHECK(squares / compared < 1.1);
}
