#include "tracer/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <utility>

#include "btf/error.h"

namespace weft {

namespace {

// Embree picks its kernels by the CPU it meets. A build for lesser CPUs (WEFT_ARCH=x86-64-v3) holds
// it to theirs, so that its hits are the same everywhere.
#if defined(__AVX2__) && !defined(__AVX512F__)
constexpr const char* device_settings = "isa=avx2";
#else
constexpr const char* device_settings = nullptr;
#endif

// Embree gives the pieces of a stream by pointer.
RTCRayNp rays_of(RayStream& s) {
  return {.org_x = s.ox.data(),
          .org_y = s.oy.data(),
          .org_z = s.oz.data(),
          .tnear = s.tnear.data(),
          .dir_x = s.dx.data(),
          .dir_y = s.dy.data(),
          .dir_z = s.dz.data(),
          .time = s.time.data(),
          .tfar = s.tfar.data(),
          .mask = s.mask.data(),
          .id = s.id.data(),
          .flags = s.flags.data()};
}

RTCIntersectContext context_for(Coherence coherence) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == Coherence::coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                   : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

void check_finite(const TriangleMesh& mesh, std::size_t index) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw bad_input(fmt::format("mesh {}", index), fmt::format("position {} is not finite", i));
    }
  }
}

void check_finite(const CurveSet& curves, std::size_t index) {
  for (std::size_t i = 0; i < curves.controls.size(); ++i) {
    const auto& [p, radius] = curves.controls[i];
    if (!std::isfinite(p.x + p.y + p.z) || !(radius >= 0) || !std::isfinite(radius)) {
      throw bad_input(fmt::format("curve set {}", index),
                      fmt::format("control {} is not finite, or its radius is negative", i));
    }
  }
}

}  // namespace

void RayStream::resize(std::size_t n) {
  for (std::vector<float>* floats :
       {&ox, &oy, &oz, &dx, &dy, &dz, &tnear, &tfar, &u, &v, &ngx, &ngy, &ngz, &time}) {
    floats->resize(n, 0.0F);
  }
  for (std::vector<std::uint32_t>* words : {&primitive, &mesh, &instance, &id, &flags}) {
    words->resize(n, 0);
  }
  mask.resize(n, 0xFFFFFFFF);
}

// Embree's objects are counted by Embree; this releases ours.
struct RayScene::Device {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  // Embree's own copies of the curves.
  struct Curves {
    const CurveSet::Control* controls;
    const std::uint32_t* segments;
  };
  std::vector<Curves> curves;

  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void add(const TriangleMesh& mesh) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                                RTC_FORMAT_FLOAT3, sizeof(Vec3),
                                                                mesh.positions.size()));
    auto* indices = static_cast<std::array<std::uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(std::array<std::uint32_t, 3>), mesh.triangles.size()));
    if (vertices == nullptr || indices == nullptr) {
      rtcReleaseGeometry(geometry);
      throw failed("Embree", "no memory for the mesh");
    }
    std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    attach(geometry);
  }

  void add(const CurveSet& set) {
    // As fast as Catmull-Rom curves and smoother; cones are twice as fast, but their joints show.
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
    static_assert(sizeof(CurveSet::Control) == 4 * sizeof(float));
    auto* controls = static_cast<CurveSet::Control*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                sizeof(CurveSet::Control), set.controls.size()));
    auto* segments = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                                sizeof(std::uint32_t), set.segments.size()));
    if (controls == nullptr || segments == nullptr) {
      rtcReleaseGeometry(geometry);
      throw failed("Embree", "no memory for the curves");
    }
    std::copy(set.controls.begin(), set.controls.end(), controls);
    std::copy(set.segments.begin(), set.segments.end(), segments);
    curves.push_back({controls, segments});
    attach(geometry);
  }

  void attach(RTCGeometry geometry) const {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
};

RayScene::RayScene(std::span<const TriangleMesh* const> meshes,
                   std::span<const CurveSet* const> curves)
    : device_(std::make_unique<Device>()) {
  device_->device = rtcNewDevice(device_settings);
  if (device_->device == nullptr) throw failed("Embree", "no device could be made");
  device_->scene = rtcNewScene(device_->device);
  // Watertight at edges: a closed surface lets no ray through.
  rtcSetSceneFlags(device_->scene, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    check_finite(*meshes[i], i);
    device_->add(*meshes[i]);
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    check_finite(*curves[i], i);
    device_->add(*curves[i]);
  }
  if (!curves.empty()) first_curves_ = static_cast<std::uint32_t>(meshes.size());
  rtcCommitScene(device_->scene);
  if (rtcGetDeviceError(device_->device) != RTC_ERROR_NONE) {
    throw failed("Embree", "the acceleration structure could not be built",
                 "is there enough memory?");
  }
}

RayScene::RayScene(const TriangleMesh& mesh)
    : RayScene(std::span<const TriangleMesh* const>(std::array<const TriangleMesh*, 1>{&mesh})) {}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

float RayScene::around_curve(const RayHit& hit, const Vec3& normal) const {
  const Device::Curves& set = device_->curves[hit.mesh - first_curves_];
  return curve_angle(set.controls + set.segments[hit.primitive], hit.u, normal);
}

template <typename Rays>
void RayScene::name_curve_hits(Rays& rays, std::size_t count) const {
  for (std::size_t i = 0; i < count; ++i) {
    if (rays.mesh[i] == RayHit::none || rays.mesh[i] < first_curves_) continue;
    rays.v[i] = around_curve({0, rays.u[i], 0, rays.mesh[i], rays.primitive[i]},
                             {rays.ngx[i], rays.ngy[i], rays.ngz[i]});
  }
}

RayHit RayScene::intersect(const Vec3& origin, const Vec3& direction, float near, float far) const {
  RTCIntersectContext context = context_for(Coherence::incoherent);
  RTCRayHit query{};
  query.ray = {.org_x = origin.x,
               .org_y = origin.y,
               .org_z = origin.z,
               .tnear = near,
               .dir_x = direction.x,
               .dir_y = direction.y,
               .dir_z = direction.z,
               .time = 0,
               .tfar = far,
               .mask = 0xFFFFFFFF,
               .id = 0,
               .flags = 0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(device_->scene, &context, &query);
  RayHit hit{query.ray.tfar, query.hit.u, query.hit.v, query.hit.geomID, query.hit.primID};
  if (hit.hit() && hit.mesh >= first_curves_)
    hit.v = around_curve(hit, {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z});
  return hit;
}

bool RayScene::occluded(const Vec3& origin, const Vec3& direction, float near, float far) const {
  RTCIntersectContext context = context_for(Coherence::incoherent);
  RTCRay ray{.org_x = origin.x,
             .org_y = origin.y,
             .org_z = origin.z,
             .tnear = near,
             .dir_x = direction.x,
             .dir_y = direction.y,
             .dir_z = direction.z,
             .time = 0,
             .tfar = far,
             .mask = 0xFFFFFFFF,
             .id = 0,
             .flags = 0};
  rtcOccluded1(device_->scene, &context, &ray);
  return ray.tfar < 0;
}

void RayScene::intersect(RayStream& rays, std::size_t count, Coherence coherence) const {
  RTCIntersectContext context = context_for(coherence);
  std::fill_n(rays.mesh.begin(), count, RTC_INVALID_GEOMETRY_ID);
  RTCRayHitNp query{.ray = rays_of(rays),
                    .hit = {.Ng_x = rays.ngx.data(),
                            .Ng_y = rays.ngy.data(),
                            .Ng_z = rays.ngz.data(),
                            .u = rays.u.data(),
                            .v = rays.v.data(),
                            .primID = rays.primitive.data(),
                            .geomID = rays.mesh.data(),
                            .instID = {rays.instance.data()}}};
  rtcIntersectNp(device_->scene, &context, &query, static_cast<unsigned>(count));
  if (first_curves_ != RayHit::none) name_curve_hits(rays, count);
}

void RayScene::occluded(RayStream& rays, std::size_t count, Coherence coherence) const {
  RTCIntersectContext context = context_for(coherence);
  RTCRayNp query = rays_of(rays);
  rtcOccludedNp(device_->scene, &context, &query, static_cast<unsigned>(count));
}

static_assert(sizeof(RayPacket) == sizeof(RTCRay16) && sizeof(HitPacket) == sizeof(RTCRayHit16));

namespace {

void prepare(RayPacket& packet) {
  packet.tnear = FloatLanes{};
  packet.time = FloatLanes{};
  packet.mask = ~WordLanes{};
  packet.id = WordLanes{};
  packet.flags = WordLanes{};
}

}  // namespace

void RayScene::intersect(HitPacket& packet, std::uint16_t active, Coherence coherence) const {
  RTCIntersectContext context = context_for(coherence);
  prepare(packet.ray);
  packet.mesh = ~WordLanes{};      // RTC_INVALID_GEOMETRY_ID
  packet.instance = ~WordLanes{};  // the same
  const IntLanes valid = lanes_of_bits(active);
  rtcIntersect16(reinterpret_cast<const int*>(&valid), device_->scene, &context,
                 reinterpret_cast<RTCRayHit16*>(&packet));
  if (first_curves_ != RayHit::none) name_curve_hits(packet, lanes);
}

void RayScene::occluded(RayPacket& packet, std::uint16_t active, Coherence coherence) const {
  RTCIntersectContext context = context_for(coherence);
  prepare(packet);
  const IntLanes valid = lanes_of_bits(active);
  rtcOccluded16(reinterpret_cast<const int*>(&valid), device_->scene, &context,
                reinterpret_cast<RTCRay16*>(&packet));
}

}  // namespace weft
