#include "acquisition/visibility_table.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <unordered_map>

namespace weft {

namespace {

// Rays are enough once fewer than this share of all queries would contradict what was certain.
constexpr double rare = 2e-6;
constexpr std::size_t most_refined_bytes = 128'000'000;  // of answers; asking takes twice as much

constexpr std::array<Barycentric, 3> whole_facet{Barycentric{0, 0}, Barycentric{1, 0},
                                                 Barycentric{0, 1}};

// Numbers for places that cells share, in the order in which they are first met.
class PlaceNumbers {
 public:
  std::uint32_t number(const Facet& facet, const Barycentric& at) {
    const std::uint64_t key = place_key(facet.point(at[0], at[1]));
    return numbers_.try_emplace(key, static_cast<std::uint32_t>(count_++)).first->second;
  }
  std::optional<std::uint32_t> find(const Facet& facet, const Barycentric& at) const {
    const auto found = numbers_.find(place_key(facet.point(at[0], at[1])));
    if (found == numbers_.end()) return std::nullopt;
    return found->second;
  }
  // A place that belongs to one cell alone.
  std::uint32_t unshared() { return static_cast<std::uint32_t>(count_++); }
  std::size_t count() const { return count_; }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::size_t count_ = 0;
};

CellCorners corners_of(const std::vector<Facet>& facets, const std::vector<Cell>& cells) {
  PlaceNumbers numbers;
  CellCorners corners;
  corners.of_cell.reserve(cells.size());
  for (const Cell& cell : cells) {
    std::array<std::uint32_t, 3>& of_cell = corners.of_cell.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      of_cell[k] = numbers.number(facets[cell.facet], cell.corners[k]);
  }
  corners.count = numbers.count();
  return corners;
}

// Lights that face the cell, and of which it is not certain.
std::uint16_t open_lights(const VisibilityEvidence& evidence, const VisibilityAnswer& answer) {
  return static_cast<std::uint16_t>((evidence.seen | evidence.hidden) & ~answer.known);
}

// The points at which cells cut into side * side touch the rim of the whole.
std::vector<Barycentric> rim_of(const Cell& cell, int side) {
  std::vector<Barycentric> rim;
  for (int i = 0; i < side; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(side);
    rim.push_back(point_of(cell, t, 0));
    rim.push_back(point_of(cell, 1 - t, t));
    rim.push_back(point_of(cell, 0, 1 - t));
  }
  return rim;
}

// The corners of the cells that `whole` is cut into, in the order of `enter`.
void add_corners(const Facet& facet, const Cell& whole, int side, PlaceNumbers& numbers,
                 CellCorners& corners) {
  std::vector<std::uint32_t> lattice(static_cast<std::size_t>(side + 1) * (side + 1));
  const auto at = [&](int i, int j) -> std::uint32_t& { return lattice[i * (side + 1) + j]; };
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; i + j <= side; ++j) {
      const bool on_rim = i == 0 || j == 0 || i + j == side;
      at(i, j) =
          on_rim ? numbers.number(facet, point_of(whole, static_cast<float>(i) / side,
                                                  static_cast<float>(j) / static_cast<float>(side)))
                 : numbers.unshared();
    }
  }
  for (int i = 0; i < side; ++i) {
    for (int position = 0; position < 2 * (side - i) - 1; ++position) {
      const int j = position / 2;
      if (position % 2 == 0) {
        corners.of_cell.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      } else {
        corners.of_cell.push_back({at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)});
      }
    }
  }
}

}  // namespace

std::size_t VisibilityTable::cells_of(const std::vector<Facet>& facets) {
  std::size_t cells = 0;
  for (const Facet& facet : facets) {
    const int side = cells_a_side(facet);
    cells += static_cast<std::size_t>(side) * side;
  }
  return cells;
}

VisibilityTable::VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights)
    : groups_(lights.groups()), cells_(facets.size()), rows_(1), answers_(groups_) {
  for (std::size_t g = 0; g < groups_; ++g)
    answers_[g].known = static_cast<std::uint16_t>(~lights.used_lanes(g));
}

VisibilityTable::VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights,
                                 const PeriodicScene& scene, int most_rays)
    : VisibilityTable(facets, lights) {
  const std::vector<Answer> nothing = std::move(answers_);
  std::vector<Cell> cells;
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    const int side = cells_a_side(facets[f]);
    cells_[f] = {static_cast<std::uint32_t>(cells.size()), static_cast<std::uint32_t>(side)};
    cut({f, whole_facet}, side, cells);
  }
  std::vector<Answer> answers;
  std::vector<std::uint16_t> wanted;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    answers.insert(answers.end(), nothing.begin(), nothing.end());
    for (std::size_t g = 0; g < groups_; ++g) wanted.push_back(lights.used_lanes(g));
  }
  CellCorners corners = corners_of(facets, cells);
  VisibilityInquiry inquiry(facets, lights, scene, std::move(cells), std::move(corners),
                            std::move(wanted));
  ask(inquiry, most_rays, 1, answers);
  if (most_rays >= rays_to_refine) {
    refine(facets, lights, scene, inquiry, answers, most_rays);
  } else {
    rows_.resize(inquiry.cells().size());
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].first = static_cast<std::uint32_t>(c);
    answers_ = std::move(answers);
  }
  answers_.insert(answers_.end(), nothing.begin(), nothing.end());
}

void VisibilityTable::ask(VisibilityInquiry& inquiry, int most_rays, double share,
                          std::vector<Answer>& answers) {
  for (int round = 0; round < most_rays; ++round) {
    const VisibilityInquiry::Round asked = inquiry.ask(round, answers);
    rays_ += asked.rays;
    if (round + 1 < least_rays) continue;
    contradicted_ = asked.certain > 0 ? share * static_cast<double>(asked.contradicted) /
                                            static_cast<double>(asked.certain)
                                      : 0;
    inquiry.agree(answers);
    if (round + 1 > least_rays && contradicted_ < rare) break;
  }
}

void VisibilityTable::refine(const std::vector<Facet>& facets, const LightSet& lights,
                             const PeriodicScene& scene, const VisibilityInquiry& coarse,
                             const std::vector<Answer>& answers, int most_rays) {
  const std::vector<Cell>& cells = coarse.cells();
  const std::vector<VisibilityEvidence>& evidence = coarse.evidence();
  std::vector<int> open(cells.size());  // lights
  double faced = 0;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    open[i / groups_] += std::popcount(open_lights(evidence[i], answers[i]));
    faced += std::popcount(unsigned{evidence[i].seen} | evidence[i].hidden);
  }
  // Where not all can be cut, those that are uncertain of most lights are.
  std::vector<std::uint32_t> cut_cells;
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    if (open[c] > 0) cut_cells.push_back(c);
  }
  const std::size_t most = most_refined_bytes / (parts * groups_ * sizeof(Answer));
  if (cut_cells.size() > most) {
    std::ranges::stable_sort(cut_cells, [&](auto a, auto b) { return open[a] > open[b]; });
    cut_cells.resize(most);
    std::ranges::sort(cut_cells);
  }

  rows_.resize(cells.size());
  std::uint32_t row = 0;
  PlaceNumbers numbers;
  CellCorners corners;
  std::vector<Cell> fine;
  std::vector<Answer> fine_answers;
  std::vector<std::uint16_t> wanted;
  std::vector<bool> touched(coarse.corners().count);
  double asked = 0;
  for (const std::uint32_t c : cut_cells) {
    rows_[c].refined = 1;
    cut(cells[c], refinement, fine);
    add_corners(facets[cells[c].facet], cells[c], refinement, numbers, corners);
    for (std::size_t part = 0; part < parts; ++part) {
      for (std::size_t g = 0; g < groups_; ++g) {
        const std::size_t at = c * groups_ + g;
        wanted.push_back(open_lights(evidence[at], answers[at]));
        fine_answers.push_back(answers[at]);
      }
    }
    asked += open[c];
    for (const std::uint32_t corner : coarse.corners().of_cell[c]) touched[corner] = true;
  }
  corners.count = numbers.count();
  // What the cells around have seen, and what the cut ones are certain of, counts where they touch.
  corners.evidence.resize(corners.count * groups_);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (std::ranges::none_of(coarse.corners().of_cell[c], [&](auto k) { return touched[k]; }))
      continue;
    for (const Barycentric& at : rim_of(cells[c], refinement)) {
      const std::optional<std::uint32_t> corner = numbers.find(facets[cells[c].facet], at);
      if (!corner) continue;
      for (std::size_t g = 0; g < groups_; ++g) {
        const VisibilityEvidence& own = evidence[c * groups_ + g];
        const unsigned anew = rows_[c].refined ? open_lights(own, answers[c * groups_ + g]) : 0U;
        corners.evidence[*corner * groups_ + g].seen |=
            static_cast<std::uint16_t>(own.seen & ~anew);
        corners.evidence[*corner * groups_ + g].hidden |=
            static_cast<std::uint16_t>(own.hidden & ~anew);
      }
    }
  }
  if (!fine.empty()) {
    VisibilityInquiry inquiry(facets, lights, scene, std::move(fine), std::move(corners),
                              std::move(wanted));
    ask(inquiry, most_rays, asked / faced, fine_answers);
  }
  std::size_t next_fine = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    rows_[c].first = row;
    const bool refined = rows_[c].refined != 0;
    const std::vector<Answer>& from = refined ? fine_answers : answers;
    const std::size_t count = (refined ? parts : 1) * groups_;
    const auto first =
        from.begin() + static_cast<std::ptrdiff_t>(refined ? next_fine : c * groups_);
    answers_.insert(answers_.end(), first, first + static_cast<std::ptrdiff_t>(count));
    row += refined ? parts : 1;
    if (refined) next_fine += count;
  }
}

std::size_t VisibilityTable::bytes() const {
  return cells_.size() * sizeof(Cells) + rows_.size() * sizeof(Rows) +
         answers_.size() * sizeof(Answer);
}

}  // namespace weft
