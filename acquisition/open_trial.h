// How often a ray that the visibility table takes to be open meets something after all.
#pragma once

#include <cstdint>
#include <vector>

#include "acquisition/visibility_table.h"

namespace weft {

struct OpenTrial {
  std::int64_t open = 0;  ///< rays that the table takes to be open
  std::int64_t met = 0;   ///< of these, those that meet something
};

/// Of `rays` rays as a white Lambert surface would send them on, even over the area of all facets,
/// traces those that the table takes to be open.
OpenTrial try_open_rays(const std::vector<Facet>& facets, const VisibilityTable& table,
                        const PeriodicScene& scene, std::size_t rays);

}  // namespace weft
