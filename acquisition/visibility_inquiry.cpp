#include "acquisition/visibility_inquiry.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <atomic>
#include <bit>

#include "btf/random.h"

namespace weft {

namespace {

// Of what is certain all around, one packet of cells in so many is asked again.
constexpr std::int64_t sparsely = 32;
constexpr std::uint64_t sparse_key = 0x53504152;  // for the random numbers that choose it

// From several threads at once; the order makes no difference.
void add(std::uint16_t& bits, std::uint16_t more) {
  std::atomic_ref<std::uint16_t> shared(bits);
  if ((more & ~shared.load(std::memory_order_relaxed)) != 0)
    shared.fetch_or(more, std::memory_order_relaxed);
}

VisibilityInquiry::Round operator+(const VisibilityInquiry::Round& a,
                                   const VisibilityInquiry::Round& b) {
  return {a.rays + b.rays, a.certain + b.certain, a.contradicted + b.contradicted};
}

}  // namespace

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
  const std::size_t packets = (cells_.size() + lanes - 1) / lanes;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, packets), Round{},
      [&](const tbb::blocked_range<std::size_t>& range, Round sum) {
        for (std::size_t p = range.begin(); p < range.end(); ++p)
          sum = sum + ask_packet(p * lanes, round, answers);
        return sum;
      },
      [](const Round& a, const Round& b) { return a + b; });
}

// Sixteen cells in a row. Doubt sits where shadows end, a few cells wide; elsewhere further rays
// would tell the same again.
VisibilityInquiry::Round VisibilityInquiry::ask_packet(
    std::size_t first, int round, const std::vector<VisibilityAnswer>& answers) {
  const std::size_t count = std::min<std::size_t>(lanes, cells_.size() - first);
  std::array<Vec3, lanes> origins{};
  Vec3Lanes normals{};
  for (std::size_t i = 0; i < count; ++i) {
    const Facet& facet = facets_[cells_[first + i].facet];
    const auto [u, v] = random_point(cells_[first + i], first + i, round);
    origins[i] = ray_origin(facet.point(u, v), facet.normal);
    normals.x[i] = facet.normal.x;
    normals.y[i] = facet.normal.y;
    normals.z[i] = facet.normal.z;
  }
  const bool chosen =
      hash_coordinates(sparse_key, first, round) % static_cast<std::uint64_t>(sparsely) == 0;
  const std::vector<std::uint16_t>& asked = chosen ? wanted_ : doubtful_;
  Round result;
  for (std::size_t g = 0; g < groups_; ++g) {
    unsigned any = 0;  // light that some cell asks for
    WordLanes asks{};  // of each cell
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = (first + i) * groups_ + g;
      asks[i] = asked[at] & ~(evidence_[at].seen & evidence_[at].hidden);
      any |= asks[i];
    }
    for (; any != 0; any &= any - 1) {
      const std::uint32_t bit = any & (~any + 1);
      const std::size_t l = g * lanes + static_cast<std::size_t>(std::countr_zero(bit));
      const std::uint16_t active =
          bits_of_lanes((dot(lights_[l], normals) > 0) & ((asks & bit) != 0));
      if (active == 0) continue;
      RayPacket packet{};
      for (std::size_t i = 0; i < lanes; ++i) packet.set(i, origins[i], lights_[l]);
      scene_.occluded(packet, active, Coherence::coherent);
      const std::uint16_t blocked = bits_of_lanes(packet.tfar < 0);
      for (std::size_t i = 0; i < count; ++i) {
        if ((active >> i & 1U) == 0) continue;
        const std::size_t at = (first + i) * groups_ + g;
        const bool visible = (blocked >> i & 1U) == 0;
        (visible ? evidence_[at].seen : evidence_[at].hidden) |= static_cast<std::uint16_t>(bit);
        ++result.rays;
        if ((answers[at].known & bit) == 0) continue;
        const std::int64_t stands_for = (doubtful_[at] & bit) != 0 ? 1 : sparsely;
        result.certain += stands_for;
        result.contradicted += visible == ((answers[at].visible & bit) != 0) ? 0 : stands_for;
      }
    }
  }
  return result;
}

void VisibilityInquiry::agree(std::vector<VisibilityAnswer>& answers) {
  std::vector<VisibilityEvidence> around = around_;
  around.resize(corners_.count * groups_);
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t c) {
    for (const std::uint32_t corner : corners_.of_cell[c]) {
      for (std::size_t g = 0; g < groups_; ++g) {
        const VisibilityEvidence& own = evidence_[c * groups_ + g];
        add(around[corner * groups_ + g].seen, own.seen);
        add(around[corner * groups_ + g].hidden, own.hidden);
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
