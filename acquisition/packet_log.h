// The packets of rays that an estimator asks for, so that what Embree alone needs for them can be
// measured.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/ray_scene.h"

namespace weft {

struct PacketLog {
  template <typename Packet>
  struct Entry {
    Packet packet;
    std::uint16_t active;  ///< rays, a bit each
  };

  std::vector<Entry<HitPacket>> primary;
  std::vector<Entry<HitPacket>> bounce;
  std::vector<Entry<RayPacket>>
      first_shadows;  ///< from where the eye's rays hit, towards one light
  std::vector<Entry<RayPacket>> later_shadows;

  void add(const HitPacket& packet, std::uint16_t active, Coherence coherence) {
    (coherence == Coherence::coherent ? primary : bounce).push_back({packet, active});
  }
  void add(const RayPacket& packet, std::uint16_t active, Coherence coherence) {
    (coherence == Coherence::coherent ? first_shadows : later_shadows).push_back({packet, active});
  }
};

}  // namespace weft
