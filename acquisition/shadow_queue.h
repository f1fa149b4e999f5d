// Connections of paths to lights that still have to be traced, light by light.
//
// Rays towards one light are parallel, so sixteen of them from places near each other travel as one
// packet.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/packet_log.h"
#include "acquisition/periodic_scene.h"
#include "acquisition/texel_sums.h"
#include "btf/direction.h"

namespace weft {

class ShadowQueue {
 public:
  /// What the visibility table says of it.
  enum class Answer : std::uint32_t { unknown, visible, hidden };

  struct Connection {
    Vec3 origin;
    std::uint32_t slot;  ///< of the wave's sums that it adds to
    Answer answer;
    float r, g, b;
  };

  explicit ShadowQueue(std::size_t lights) : connections_(lights) {}

  void add(std::size_t light, const Connection& connection) {
    connections_[light].push_back(connection);
    ++size_;
  }
  /// Of all lights.
  std::size_t size() const { return size_; }

  /// Traces all, then forgets them. Connections come texel by texel where rays are to be
  /// coherent. Sixteen that are not all of one texel go as
  /// incoherent ones, whatever is asked for: Embree's coherent packets pay within a texel, and cost
  /// half as much again beyond.
  /// @param log     gets a copy of every packet before it is traced; none where null.
  /// @param arrive  called with (light, connection, visible) for each, in order of lights, then of
  /// `add`.
  /// @returns how many rays were traced on beyond the copies.
  template <typename Arrive>
  std::int64_t trace(const PeriodicScene& scene, std::span<const Direction> lights,
                     Coherence coherence, PacketLog* log, const Arrive& arrive) {
    std::int64_t traced_on = 0;
    for (std::size_t l = 0; l < lights.size(); ++l) {
      std::vector<Connection>& queue = connections_[l];
      for (std::size_t first = 0; first < queue.size(); first += lanes) {
        const std::size_t count = std::min<std::size_t>(lanes, queue.size() - first);
        RayPacket packet{};
        for (std::size_t i = 0; i < count; ++i) packet.set(i, queue[first + i].origin, lights[l]);
        const auto active = static_cast<std::uint16_t>((1U << count) - 1U);
        if (log != nullptr) log->add(packet, active, coherence);
        const bool near = TexelSums::texel_of(queue[first].slot) ==
                          TexelSums::texel_of(queue[first + count - 1].slot);
        traced_on += scene.occluded(packet, active, near ? coherence : Coherence::incoherent);
        for (std::size_t i = 0; i < count; ++i) arrive(l, queue[first + i], !(packet.tfar[i] < 0));
      }
      queue.clear();
    }
    size_ = 0;
    return traced_on;
  }

 private:
  std::vector<std::vector<Connection>> connections_;
  std::size_t size_ = 0;
};

}  // namespace weft
