#include "perch/verify/ray_mesh.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace perch {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

void put(RTCRay& ray, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min) {
  const Eigen::Vector3f from = origin.cast<float>(), along = direction.cast<float>();
  ray = RTCRay{};
  ray.org_x = from.x();
  ray.org_y = from.y();
  ray.org_z = from.z();
  ray.dir_x = along.x();
  ray.dir_y = along.y();
  ray.dir_z = along.z();
  ray.tnear = static_cast<float>(t_min);
  ray.tfar = infinity;
  ray.mask = ~0U;
}

/// Distance from p to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double triangle_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, normal = ab.cross(ac);
  const auto to_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d edge = to - from;
    const double length = edge.squaredNorm();
    const double t = length > 0.0 ? std::clamp(edge.dot(p - from) / length, 0.0, 1.0) : 0.0;
    return (from + t * edge - p).norm();
  };
  const double area = normal.squaredNorm();
  const bool above = area > 0.0 && (b - a).cross(p - a).dot(normal) >= 0.0 &&
                     (c - b).cross(p - b).dot(normal) >= 0.0 && (a - c).cross(p - c).dot(normal) >= 0.0;
  if (above) return std::abs(normal.dot(p - a)) / std::sqrt(area);
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

/// A context that takes down every triangle met and lets the ray go on.
struct Collection {
  RTCIntersectContext context;  // first, so that Embree's pointer to it is one to this
  std::vector<std::uint32_t> triangles;

  static void collect(const RTCFilterFunctionNArguments* arguments) {
    auto* self = reinterpret_cast<Collection*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
      if (arguments->valid[i] == 0) continue;
      self->triangles.push_back(RTCHitN_primID(arguments->hit, arguments->N, i));
      arguments->valid[i] = 0;
    }
  }
};

}  // namespace

struct RayMesh::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Embree(std::span<const Eigen::Vector3d> points, Triangles faces)
      : vertices(points.begin(), points.end()), triangles(faces.begin(), faces.end()) {
    device = rtcNewDevice("threads=1");
    if (device == nullptr) throw std::runtime_error("Embree can't be started");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(
        scene, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
    auto* indices = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
    if ((corners == nullptr && !vertices.empty()) || (indices == nullptr && !triangles.empty())) {
      rtcReleaseGeometry(geometry);
      release();
      throw std::bad_alloc();
    }
    for (std::size_t i = 0; i < vertices.size(); ++i)
      Eigen::Map<Eigen::Vector3f>(corners + 3 * i) = vertices[i].cast<float>();
    std::copy(triangles.begin(), triangles.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
      release();
      throw std::runtime_error("Embree can't take the mesh");
    }
  }
  ~Embree() { release(); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void release() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

RayMesh::RayMesh(std::span<const Eigen::Vector3d> vertices, Triangles triangles)
    : embree_(std::make_unique<Embree>(vertices, triangles)) {}
RayMesh::~RayMesh() = default;
RayMesh::RayMesh(RayMesh&&) noexcept = default;
RayMesh& RayMesh::operator=(RayMesh&&) noexcept = default;

std::optional<std::uint32_t> RayMesh::first_hit(const Eigen::Vector3d& origin,
                                                const Eigen::Vector3d& direction, double t_min) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray;
  put(ray.ray, origin, direction, t_min);
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return ray.hit.primID;
}

std::vector<std::uint32_t> RayMesh::all_hits(const Eigen::Vector3d& origin,
                                             const Eigen::Vector3d& direction) const {
  Collection collection;
  rtcInitIntersectContext(&collection.context);
  collection.context.filter = Collection::collect;
  RTCRayHit ray;
  put(ray.ray, origin, direction, 0.0);
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &collection.context, &ray);
  std::vector<std::uint32_t>& met = collection.triangles;
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  return std::move(met);
}

namespace {

/// Calls `visit(distance)` with the distances of p from triangles, at least all that are at most `radius`.
/// What it returns is the radius from then on.
template <typename Visit>
void query(RTCScene scene, const std::vector<Eigen::Vector3d>& vertices,
           const std::vector<std::array<std::uint32_t, 3>>& triangles, const Eigen::Vector3d& p,
           double radius, Visit visit) {
  // A hair more, since Embree culls in float.
  const auto widened = [](double r) { return static_cast<float>(r * (1.0 + 1e-5) + 1e-7); };
  auto call = [&](RTCPointQueryFunctionArguments* arguments) {
    const auto& [a, b, c] = triangles[arguments->primID];
    const float next = widened(visit(triangle_distance(p, vertices[a], vertices[b], vertices[c])));
    if (!(next < arguments->query->radius)) return false;
    arguments->query->radius = next;
    return true;
  };
  RTCPointQuery sphere;
  sphere.x = static_cast<float>(p.x());
  sphere.y = static_cast<float>(p.y());
  sphere.z = static_cast<float>(p.z());
  sphere.time = 0.0F;
  sphere.radius = widened(radius);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(
      scene, &sphere, &context,
      [](RTCPointQueryFunctionArguments* arguments) {
        return (*static_cast<decltype(call)*>(arguments->userPtr))(arguments);
      },
      &call);
}

}  // namespace

double RayMesh::distance(const Eigen::Vector3d& p) const {
  double nearest = std::numeric_limits<double>::infinity();
  query(embree_->scene, embree_->vertices, embree_->triangles, p, nearest, [&](double distance) {
    nearest = std::min(nearest, distance);
    return nearest;
  });
  return nearest;
}

bool RayMesh::is_within(const Eigen::Vector3d& p, double radius) const {
  bool within = false;
  query(embree_->scene, embree_->vertices, embree_->triangles, p, radius, [&](double distance) {
    within = within || distance <= radius;
    return within ? 0.0 : radius;
  });
  return within;
}

}  // namespace perch
