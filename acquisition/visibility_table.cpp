#include "acquisition/visibility_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "acquisition/open_trial.h"

namespace weft {

namespace {

// Rays are enough once fewer than this share of all queries would contradict what was certain.
constexpr double rare = 2e-6;
// Of answers; asking takes three times as much.
constexpr std::size_t most_refined_bytes = 128'000'000;
constexpr std::size_t trial_rays = 1 << 16;
// Of the trial's; where none of so many meets anything, fewer than one in 3,500 does (99 %).
constexpr std::int64_t least_open = 1 << 14;
constexpr std::uint32_t check_every_certain = 16;
constexpr std::uint32_t check_every_other = 4;

// Lights that face the cell, and of which it is not certain.
std::uint16_t uncertain_lights(const VisibilityEvidence& evidence, const VisibilityAnswer& answer) {
  return static_cast<std::uint16_t>((evidence.seen | evidence.hidden) & ~answer.known);
}

// What is uncertain once all cells have been asked.
struct Uncertain {
  std::vector<std::uint16_t> lights;  // [cell][group]
  std::vector<std::uint32_t> cells;   // with any of them, in order
  double share = 0;                   // of what these cells are uncertain of, of all queries
};

// Where there are more than `most` such cells, those with most of them.
Uncertain uncertain_cells(const VisibilityInquiry& inquiry,
                          const std::vector<VisibilityAnswer>& answers, std::size_t groups,
                          std::size_t most) {
  const std::vector<VisibilityEvidence>& evidence = inquiry.evidence();
  Uncertain result;
  result.lights.resize(evidence.size());
  std::vector<int> lights(inquiry.cells().size());
  double faced = 0;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    result.lights[i] = uncertain_lights(evidence[i], answers[i]);
    lights[i / groups] += std::popcount(result.lights[i]);
    faced += std::popcount(unsigned{evidence[i].seen} | evidence[i].hidden);
  }
  for (std::uint32_t c = 0; c < lights.size(); ++c) {
    if (lights[c] > 0) result.cells.push_back(c);
  }
  if (result.cells.size() > most) {
    std::ranges::stable_sort(result.cells, [&](auto a, auto b) { return lights[a] > lights[b]; });
    result.cells.resize(most);
    std::ranges::sort(result.cells);
  }
  for (const std::uint32_t c : result.cells) result.share += lights[c] / faced;
  return result;
}

// What the cells around those that are cut have seen, and what the cut ones are certain of, where
// they touch the parts: [corner][group].
std::vector<VisibilityEvidence> evidence_around(const std::vector<Facet>& facets,
                                                const VisibilityInquiry& inquiry,
                                                const Uncertain& uncertain, int side,
                                                const PlaceNumbers& numbers, std::size_t groups) {
  const CellCorners& corners = inquiry.corners();
  std::vector<bool> is_cut(inquiry.cells().size());
  std::vector<bool> touched(corners.count);
  for (const std::uint32_t c : uncertain.cells) {
    is_cut[c] = true;
    for (const std::uint32_t corner : corners.of_cell[c]) touched[corner] = true;
  }
  std::vector<VisibilityEvidence> around(numbers.count() * groups);
  tbb::parallel_for(std::size_t{0}, is_cut.size(), [&](std::size_t c) {
    if (std::ranges::none_of(corners.of_cell[c], [&](auto corner) { return touched[corner]; }))
      return;
    const Cell& cell = inquiry.cells()[c];
    for (const Vec3& point : rim_of(facets[cell.facet], cell, side)) {
      const std::optional<std::uint32_t> corner = numbers.find(point);
      if (!corner) continue;
      for (std::size_t g = 0; g < groups; ++g) {
        const VisibilityEvidence& own = inquiry.evidence()[c * groups + g];
        const unsigned kept = is_cut[c] ? ~unsigned{uncertain.lights[c * groups + g]} : ~0U;
        around[*corner * groups + g].add({.seen = static_cast<std::uint16_t>(own.seen & kept),
                                          .hidden = static_cast<std::uint16_t>(own.hidden & kept)});
      }
    }
  });
  return around;
}

}  // namespace

VisibilityTable::VisibilityTable(const LightSet& lights)
    : groups_(lights.groups()), answers_(groups_) {
  for (std::size_t g = 0; g < groups_; ++g)
    answers_[g].known = static_cast<std::uint16_t>(~lights.used_lanes(g));
}

VisibilityTable::VisibilityTable(const std::vector<Facet>& facets, FacetCells facet_cells,
                                 const LightSet& lights, const PeriodicScene& scene, int most_rays)
    : VisibilityTable(lights) {
  cells_ = std::move(facet_cells);
  surrounding_ = SurroundingLights(lights);
  const std::vector<Answer> nothing = std::exchange(answers_, {});
  std::vector<Answer> answers;
  std::vector<std::uint16_t> wanted;
  for (std::size_t c = 0; c < cells_.count(); ++c) {
    answers.insert(answers.end(), nothing.begin(), nothing.end());
    for (std::size_t g = 0; g < groups_; ++g) wanted.push_back(lights.used_lanes(g));
  }
  std::vector<Cell> cells = cells_.all();
  PlaceNumbers corner_numbers(cells.size() / 2);  // on a surface of triangles
  CellCorners corners = cell_corners(facets, cells, 1, corner_numbers);
  VisibilityInquiry inquiry(facets, lights, scene, std::move(cells), std::move(corners),
                            std::move(wanted));
  ask(inquiry, most_rays, 1, answers);

  Uncertain uncertain;
  std::vector<Answer> fine_answers;
  if (most_rays >= rays_to_refine) {
    uncertain = uncertain_cells(inquiry, answers, groups_,
                                most_refined_bytes / (parts * groups_ * sizeof(Answer)));
  }
  if (!uncertain.cells.empty()) {
    std::vector<Cell> cut_cells;
    std::vector<Cell> fine;
    std::vector<std::uint16_t> asked;
    for (const std::uint32_t c : uncertain.cells) {
      cut_cells.push_back(inquiry.cells()[c]);
      cut(cut_cells.back(), refinement, fine);
      const std::size_t at = c * groups_;
      for (std::size_t part = 0; part < parts; ++part) {
        asked.insert(asked.end(), &uncertain.lights[at], &uncertain.lights[at] + groups_);
        fine_answers.insert(fine_answers.end(), &answers[at], &answers[at] + groups_);
      }
    }
    // Twelve on each rim, most of them shared.
    PlaceNumbers numbers(6 * uncertain.cells.size());
    CellCorners fine_corners = cell_corners(facets, cut_cells, refinement, numbers);
    VisibilityInquiry fine_inquiry(
        facets, lights, scene, std::move(fine), std::move(fine_corners), std::move(asked),
        evidence_around(facets, inquiry, uncertain, refinement, numbers, groups_));
    ask(fine_inquiry, most_rays, uncertain.share, fine_answers);
  }
  lay(answers, uncertain.cells, fine_answers);
  answers_.insert(answers_.end(), nothing.begin(), nothing.end());
  try_open(facets, scene);
}

void VisibilityTable::ask(VisibilityInquiry& inquiry, int most_rays, double share,
                          std::vector<Answer>& answers) {
  for (int round = 0; round < most_rays; ++round) {
    const VisibilityInquiry::Round asked = inquiry.ask(round, answers);
    rays_ += asked.rays;
    inquiry.agree(answers);
    const double contradicted = asked.certain > 0 ? static_cast<double>(asked.contradicted) /
                                                        static_cast<double>(asked.certain)
                                                  : 0;
    if (round + 1 > least_rays && share * contradicted < rare) break;
  }
}

void VisibilityTable::try_open(const std::vector<Facet>& facets, const PeriodicScene& scene) {
  const OpenTrial trial = try_open_rays(facets, *this, scene, trial_rays);
  rays_ += trial.open;
  const bool certain = trial.met == 0 && trial.open >= least_open;
  open_check_every_ = certain ? check_every_certain : check_every_other;
}

void VisibilityTable::lay(const std::vector<Answer>& answers,
                          std::span<const std::uint32_t> cut_cells,
                          const std::vector<Answer>& fine_answers) {
  rows_.resize(cells_.count());
  for (const std::uint32_t c : cut_cells) rows_[c].refined = 1;
  const Answer* coarse = answers.data();
  const Answer* fine = fine_answers.data();
  for (Rows& rows : rows_) {
    rows.first = static_cast<std::uint32_t>(answers_.size() / groups_);
    const Answer*& from = rows.refined ? fine : coarse;
    const std::size_t count = (rows.refined ? parts : 1) * groups_;
    answers_.insert(answers_.end(), from, from + count);
    from += count;
    if (rows.refined) coarse += groups_;
  }
}

}  // namespace weft
