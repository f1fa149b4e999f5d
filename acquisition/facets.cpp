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

Vec3 shading_normal(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
                    const Vec3& facet_normal, bool behind, const Vec3& direction) {
  if (mesh.normals.empty()) return facet_normal;
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3 normal =
      (mesh.normals[a] * (1 - u - v) + mesh.normals[b] * u + mesh.normals[c] * v).normalized();
  const Vec3 turned = behind ? -normal : normal;
  return (turned ^ direction) < -1e-4F ? turned : facet_normal;
}

}  // namespace weft
