// OpenSubdiv's uniform refinement and limit stencils; the only file that names OpenSubdiv.
#include "tracer/subdivision.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <memory>

#include "btf/error.h"

namespace weft {

namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

/// A point as OpenSubdiv's refiner wants it.
struct Point {
  Imath::V3d position{0, 0, 0};
  void Clear() { position = Imath::V3d(0); }
  void AddWithWeight(const Point& other, float weight) {
    position += other.position * static_cast<double>(weight);
  }
};

std::unique_ptr<Far::TopologyRefiner> refine(const PolygonMesh& cage, int levels) {
  const std::vector<int> sizes(cage.face_sizes.begin(), cage.face_sizes.end());
  const std::vector<int> corners(cage.corners.begin(), cage.corners.end());
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(cage.positions.size());
  descriptor.numFaces = static_cast<int>(sizes.size());
  descriptor.numVertsPerFace = sizes.data();
  descriptor.vertIndicesPerFace = corners.data();

  Sdc::Options scheme;
  scheme.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_CATMARK, scheme)));
  if (!refiner) throw bad_input("subdivide", "the mesh has no topology that can be subdivided");
  Far::TopologyRefiner::UniformOptions uniform(levels);
  uniform.fullTopologyInLastLevel = true;
  refiner->RefineUniform(uniform);
  return refiner;
}

struct Limit {
  std::vector<Point> position, tangent_u, tangent_v;
};

Limit limit_points(const Far::TopologyRefiner& refiner, const PolygonMesh& cage, int levels) {
  std::vector<Point> points(cage.positions.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].position = Imath::V3d(cage.positions[i]);
  const Far::PrimvarRefiner primvars(refiner);
  for (int level = 1; level <= levels; ++level) {
    std::vector<Point> finer(refiner.GetLevel(level).GetNumVertices());
    primvars.Interpolate(level, points, finer);
    points = std::move(finer);
  }
  Limit limit{std::vector<Point>(points.size()), std::vector<Point>(points.size()),
              std::vector<Point>(points.size())};
  primvars.Limit(points, limit.position, limit.tangent_u, limit.tangent_v);
  return limit;
}

/// The cage's face that a face of the last level came from.
std::size_t base_face(const Far::TopologyRefiner& refiner, int levels, int face) {
  for (int level = levels; level > 0; --level)
    face = refiner.GetLevel(level).GetFaceParentFace(face);
  return static_cast<std::size_t>(face);
}

}  // namespace

PolygonMesh limit_surface(const PolygonMesh& cage, int levels, std::size_t kept_faces) {
  const auto refiner = refine(cage, levels);
  const Limit limit = limit_points(*refiner, cage, levels);
  const Far::TopologyLevel& finest = refiner->GetLevel(levels);

  PolygonMesh surface;
  surface.material_names = cage.material_names;
  constexpr std::uint32_t unused = ~std::uint32_t{0};
  std::vector<std::uint32_t> vertex_of(limit.position.size(), unused);
  for (int face = 0; face < finest.GetNumFaces(); ++face) {
    const std::size_t base = base_face(*refiner, levels, face);
    if (base >= kept_faces) continue;
    const Far::ConstIndexArray corners = finest.GetFaceVertices(face);
    for (const int corner : corners) {
      if (vertex_of[corner] == unused) {
        vertex_of[corner] = static_cast<std::uint32_t>(surface.positions.size());
        surface.positions.emplace_back(limit.position[corner].position);
        const Imath::V3d normal =
            limit.tangent_u[corner].position.cross(limit.tangent_v[corner].position);
        // A cage that is folded onto itself has points without a normal; they have no area either.
        surface.normals.push_back(normal.length() > 0 ? Vec3(normal.normalized()) : Vec3(0, 0, 1));
      }
      surface.corners.push_back(vertex_of[corner]);
    }
    surface.face_sizes.push_back(static_cast<std::uint32_t>(corners.size()));
    surface.materials.push_back(cage.materials[base]);
  }
  return surface;
}

}  // namespace weft
