#include "acquisition/facets.h"

namespace weft {

std::vector<Facet> facets_of(const TriangleMesh& mesh) {
  std::vector<Facet> facets(mesh.triangles.size());
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    Facet& facet = facets[i];
    facet.corner = mesh.positions[a];
    facet.edge_u = mesh.positions[b] - mesh.positions[a];
    facet.edge_v = mesh.positions[c] - mesh.positions[a];
    facet.normal = facet.edge_u % facet.edge_v;
    const float length = facet.normal.length();
    facet.normal = length > 0 ? facet.normal / length : Vec3(0, 0, 0);
    facet.material = mesh.materials[i];
  }
  return facets;
}

}  // namespace weft
