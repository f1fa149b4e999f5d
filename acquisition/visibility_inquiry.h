// Asks what cells see of each light, ray by ray, and says what is certain so far.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/cell_corners.h"
#include "acquisition/light_set.h"
#include "acquisition/periodic_scene.h"

namespace weft {

/// What is known of one place and sixteen lights, a bit each.
struct VisibilityAnswer {
  std::uint16_t known = 0;    ///< lights that nearly certainly are seen, or are not
  std::uint16_t visible = 0;  ///< of those, the seen ones
};

/// What points have seen, of one place and sixteen lights.
struct VisibilityEvidence {
  std::uint16_t seen = 0;    ///< lights that some point sees
  std::uint16_t hidden = 0;  ///< lights that some point does not see

  /// May be called from several threads at once; the order makes no difference.
  void add(const VisibilityEvidence& more);
};

class VisibilityInquiry {
 public:
  /// @param wanted  [cell][group]: the lights to ask for.
  /// @param around  [corner][group]: what cells that are not asked have seen; empty: nothing. The
  ///                facets, lights and scene outlive this.
  VisibilityInquiry(const std::vector<Facet>& facets, const LightSet& lights,
                    const PeriodicScene& scene, std::vector<Cell> cells, CellCorners corners,
                    std::vector<std::uint16_t> wanted, std::vector<VisibilityEvidence> around = {});

  struct Round {
    std::int64_t rays = 0;
    std::int64_t certain = 0;       ///< answers that were certain before, estimated from the rays
    std::int64_t contradicted = 0;  ///< of those, the same
  };

  /// One ray from each cell to each wanted light in front of it, but where points of the cell
  /// disagree already. What `agree` found to be certain all around is asked of one cell in 32
  /// only (sixteen in a row), which then stands for 32. `answers` ([cell][group]) are those so far.
  Round ask(int round, const std::vector<VisibilityAnswer>& answers);

  /// Writes the answers to the wanted lights: certain is what all points of a cell and of the cells
  /// that touch it agree on.
  void agree(std::vector<VisibilityAnswer>& answers);

  const std::vector<Cell>& cells() const { return cells_; }
  const CellCorners& corners() const { return corners_; }
  /// [cell][group]
  const std::vector<VisibilityEvidence>& evidence() const { return evidence_; }

 private:
  // Of a batch of cells from `first` on.
  Round ask_batch(std::size_t first, int round, const std::vector<VisibilityAnswer>& answers);
  // Sixteen of them at most, whose numbers and ray origins are counted from `first`, and a light.
  Round ask_packet(std::size_t first, std::span<const std::uint16_t> cells, std::size_t light,
                   std::span<const Vec3> origins, const std::vector<VisibilityAnswer>& answers);

  const std::vector<Facet>& facets_;
  const LightSet& lights_;
  const PeriodicScene& scene_;
  std::vector<Cell> cells_;
  CellCorners corners_;
  std::vector<std::uint16_t> wanted_;
  std::vector<std::uint16_t> doubtful_;  // [cell][group]: lights uncertain here or next to here
  std::vector<VisibilityEvidence> around_;
  std::size_t groups_;
  std::vector<VisibilityEvidence> evidence_;
};

}  // namespace weft
