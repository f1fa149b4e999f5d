#include "acquisition/visibility_inquiry.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <atomic>
#include <bit>
#include <span>

#include "btf/random.h"

namespace weft {

namespace {

// Of what is certain all around, sixteen cells in a row of so many times sixteen are asked again.
constexpr std::int64_t sparsely = 32;
// Cells that share packets of rays.
constexpr std::size_t batch = 256;
constexpr std::uint64_t sparse_key = 0x53504152;  // for the random numbers that choose it

// From several threads at once; the order makes no difference.
void add(std::uint16_t& bits, std::uint16_t more) {
  std::atomic_ref<std::uint16_t> shared(bits);
  if ((more & ~shared.load(std::memory_order_relaxed)) != 0)
    shared.fetch_or(more, std::memory_order_relaxed);
}

// A batch of cells and sixteen lights: which cells ask for each light.
class Requests {
 public:
  void clear() { counts_ = {}; }
  void add(std::size_t cell, unsigned lights) {
    for (; lights != 0; lights &= lights - 1) {
      const auto light = static_cast<std::size_t>(std::countr_zero(lights));
      cells_[light][counts_[light]++] = static_cast<std::uint16_t>(cell);
    }
  }
  /// Cells, counted from the batch's first.
  std::span<const std::uint16_t> of(std::size_t light) const {
    return {cells_[light].data(), counts_[light]};
  }

 private:
  std::array<std::array<std::uint16_t, batch>, lanes> cells_;
  std::array<std::uint32_t, lanes> counts_{};
};

VisibilityInquiry::Round operator+(const VisibilityInquiry::Round& a,
                                   const VisibilityInquiry::Round& b) {
  return {a.rays + b.rays, a.certain + b.certain, a.contradicted + b.contradicted};
}

}  // namespace

void VisibilityEvidence::add(const VisibilityEvidence& more) {
  weft::add(seen, more.seen);
  weft::add(hidden, more.hidden);
}

VisibilityInquiry::VisibilityInquiry(const std::vector<Facet>& facets, const LightSet& lights,
                                     const PeriodicScene& scene, std::vector<Cell> cells,
                                     CellCorners corners, std::vector<std::uint16_t> wanted,
                                     std::vector<VisibilityEvidence> around)
    : facets_(facets),
      lights_(lights),
      scene_(scene),
      cells_(std::move(cells)),
      corners_(std::move(corners)),
      wanted_(std::move(wanted)),
      doubtful_(wanted_),
      around_(std::move(around)),
      groups_(lights.groups()),
      evidence_(cells_.size() * groups_) {}

VisibilityInquiry::Round VisibilityInquiry::ask(int round,
                                                const std::vector<VisibilityAnswer>& answers) {
  const std::size_t batches = (cells_.size() + batch - 1) / batch;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, batches), Round{},
      [&](const tbb::blocked_range<std::size_t>& range, Round sum) {
        for (std::size_t b = range.begin(); b < range.end(); ++b)
          sum = sum + ask_batch(b * batch, round, answers);
        return sum;
      },
      [](const Round& a, const Round& b) { return a + b; });
}

// Doubt sits where shadows end, a few cells wide; elsewhere further rays would tell the same again.
// So few cells in a row ask for one light, and packets are filled from the whole batch.
VisibilityInquiry::Round VisibilityInquiry::ask_batch(
    std::size_t first, int round, const std::vector<VisibilityAnswer>& answers) {
  const std::size_t count = std::min(batch, cells_.size() - first);
  std::array<Vec3, batch> origins;
  std::array<bool, batch> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    const Facet& facet = facets_[cells_[first + i].facet];
    const auto [u, v] = random_point(cells_[first + i], first + i, round);
    origins[i] = ray_origin(facet.point(u, v), facet.normal);
    chosen[i] = hash_coordinates(sparse_key, (first + i) / lanes * lanes, round) %
                    static_cast<std::uint64_t>(sparsely) ==
                0;
  }
  Requests requests;
  Round result;
  for (std::size_t g = 0; g < groups_; ++g) {
    requests.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = (first + i) * groups_ + g;
      const unsigned asked = (chosen[i] ? wanted_ : doubtful_)[at] &
                             ~(unsigned{evidence_[at].seen} & evidence_[at].hidden);
      if (asked == 0) continue;
      const Vec3& normal = facets_[cells_[first + i].facet].normal;
      requests.add(i, asked & bits_of_lanes(dot(normal, lights_.group(g)) > 0));
    }
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::span<const std::uint16_t> cells = requests.of(i);
      for (std::size_t k = 0; k < cells.size(); k += lanes) {
        const std::span<const std::uint16_t> some =
            cells.subspan(k, std::min<std::size_t>(lanes, cells.size() - k));
        result = result + ask_packet(first, some, g * lanes + i, origins, answers);
      }
    }
  }
  return result;
}

VisibilityInquiry::Round VisibilityInquiry::ask_packet(
    std::size_t first, std::span<const std::uint16_t> cells, std::size_t light,
    std::span<const Vec3> origins, const std::vector<VisibilityAnswer>& answers) {
  RayPacket packet{};
  for (std::size_t i = 0; i < cells.size(); ++i) packet.set(i, origins[cells[i]], lights_[light]);
  const auto active = static_cast<std::uint16_t>((1U << cells.size()) - 1U);
  scene_.occluded(packet, active, Coherence::coherent);
  const std::uint16_t blocked = bits_of_lanes(packet.tfar < 0);
  const auto bit = static_cast<std::uint16_t>(1U << light % lanes);
  Round result;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t at = (first + cells[i]) * groups_ + light / lanes;
    const bool visible = (blocked >> i & 1U) == 0;
    (visible ? evidence_[at].seen : evidence_[at].hidden) |= bit;
    ++result.rays;
    if ((answers[at].known & bit) == 0) continue;
    const std::int64_t stands_for = (doubtful_[at] & bit) != 0 ? 1 : sparsely;
    result.certain += stands_for;
    result.contradicted += visible == ((answers[at].visible & bit) != 0) ? 0 : stands_for;
  }
  return result;
}

void VisibilityInquiry::agree(std::vector<VisibilityAnswer>& answers) {
  std::vector<VisibilityEvidence> around = around_;
  around.resize(corners_.count * groups_);
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t c) {
    for (const std::uint32_t corner : corners_.of_cell[c]) {
      for (std::size_t g = 0; g < groups_; ++g) {
        around[corner * groups_ + g].add(evidence_[c * groups_ + g]);
      }
    }
  });
  std::vector<std::uint16_t> doubts(around.size());  // [corner][group]
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t c) {
    for (std::size_t g = 0; g < groups_; ++g) {
      VisibilityEvidence near;
      for (const std::uint32_t corner : corners_.of_cell[c]) {
        near.seen |= around[corner * groups_ + g].seen;
        near.hidden |= around[corner * groups_ + g].hidden;
      }
      const std::size_t at = c * groups_ + g;
      const unsigned visible = wanted_[at] & evidence_[at].seen & ~near.hidden;
      const unsigned blocked = wanted_[at] & evidence_[at].hidden & ~near.seen;
      const unsigned others = ~unsigned{wanted_[at]};
      answers[at] = {static_cast<std::uint16_t>((answers[at].known & others) | visible | blocked),
                     static_cast<std::uint16_t>((answers[at].visible & others) | visible)};
      const auto doubt = static_cast<std::uint16_t>(wanted_[at] & ~answers[at].known);
      for (const std::uint32_t corner : corners_.of_cell[c])
        add(doubts[corner * groups_ + g], doubt);
    }
  });
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t c) {
    for (std::size_t g = 0; g < groups_; ++g) {
      unsigned near = 0;
      for (const std::uint32_t corner : corners_.of_cell[c]) near |= doubts[corner * groups_ + g];
      doubtful_[c * groups_ + g] = static_cast<std::uint16_t>(wanted_[c * groups_ + g] & near);
    }
  });
}

}  // namespace weft
