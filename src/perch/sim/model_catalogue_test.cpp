#include "perch/sim/model_catalogue.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "perch/core/error.hpp"
#include "perch/sim/catalogue_shapes.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/mesh_builder.hpp"
#include "perch/sim/parametric_models.hpp"

namespace perch {
namespace {

using std::numbers::pi;

std::vector<SceneModel> all_models() {
  std::vector<SceneModel> models;
  for (const std::string& name : catalogue_model_names()) models.push_back(catalogue_model(name));
  for (const std::string& name : chess_model_names()) models.push_back(chess_model(name));
  return models;
}

/// The parts of a mesh that share no vertex.
std::vector<Mesh> components(const Mesh& mesh) {
  std::vector<std::uint32_t> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    root[find(b)] = find(a);
    root[find(c)] = find(a);
  }
  std::map<std::uint32_t, Mesh> parts;
  std::vector<std::uint32_t> place(mesh.vertices.size());
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    Mesh& part = parts[find(v)];
    place[v] = static_cast<std::uint32_t>(part.vertices.size());
    part.vertices.push_back(mesh.vertices[v]);
  }
  for (const auto& [a, b, c] : mesh.triangles)
    parts[find(a)].triangles.push_back({place[a], place[b], place[c]});
  std::vector<Mesh> out;
  for (auto& [v, part] : parts) out.push_back(std::move(part));
  return out;
}

TEST(ModelCatalogue, HoldsTheHouseholdSetAndEnoughMore) {
  const auto& names = catalogue_model_names();
  EXPECT_GE(names.size(), 36U);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (const std::string& name : household_model_names()) {
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1);
    EXPECT_EQ(catalogue_model(name).mesh.vertices, household_model(name).mesh.vertices);
  }
  EXPECT_EQ(chess_model_names().size(), 6U);
  EXPECT_THROW(catalogue_model("pawn"), InputError);
  EXPECT_EQ(named_model("pawn").name, "pawn");
  EXPECT_THROW(named_model("anvil"), InputError);
}

TEST(ModelCatalogue, EveryPartIsAClosedSurfaceWithoutHolesThatFacesOutwards) {
  for (const SceneModel& model : all_models()) {
    SCOPED_TRACE(model.name);
    EXPECT_EQ(mesh_fault(model.mesh), "");
    EXPECT_GE(model.mesh.triangles.size(), 500U);
    EXPECT_LE(model.mesh.triangles.size(), 20000U);
    EXPECT_EQ(model.mesh.bounds().min().z(), 0.0F);
    EXPECT_GE(model.mesh.bounds().sizes().maxCoeff(), 0.03F);
    EXPECT_LE(model.mesh.bounds().sizes().maxCoeff(), 0.31F);
    for (const Mesh& part : components(model.mesh)) {
      // Every edge is run along once each way, and V - E + F = 2: a sphere, bent.
      std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
      for (const auto& t : part.triangles)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
      for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a}));
      EXPECT_EQ(part.vertices.size() + part.triangles.size(), edges.size() / 2 + 2);
      EXPECT_GT(signed_volume(part), 0.0);
      for (const auto& [a, b, c] : part.triangles) {
        const auto &p = part.vertices[a], &q = part.vertices[b], &r = part.vertices[c];
        EXPECT_GT((q - p).cross(r - p).norm(), 1e-9F) << "a triangle without area";
      }
    }
  }
}

/// True where each vertex, turned about z, falls on a vertex.
bool vertices_fall_on_vertices(const Mesh& mesh, double turn) {
  constexpr double cell = 1e-4, same = 3e-6;  // metres
  using Cell = std::tuple<long, long, long>;
  const auto cell_of = [&](const Eigen::Vector3d& p, int dx, int dy, int dz) {
    return Cell(std::lround(p.x() / cell) + dx, std::lround(p.y() / cell) + dy,
                std::lround(p.z() / cell) + dz);
  };
  std::map<Cell, std::vector<Eigen::Vector3d>> grid;
  for (const Eigen::Vector3f& v : mesh.vertices)
    grid[cell_of(v.cast<double>(), 0, 0, 0)].push_back(v.cast<double>());
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const Eigen::Vector3f& v) {
    const Eigen::Vector3d p = rotation * v.cast<double>();
    for (int i = 0; i < 27; ++i) {
      const auto found = grid.find(cell_of(p, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      if (found == grid.end()) continue;
      for (const Eigen::Vector3d& q : found->second)
        if ((p - q).norm() <= same) return true;
    }
    return false;
  });
}

/// How far cuts through a mesh at many heights reach in each direction: exact for the mesh, so that a turn
/// that changes it changes the shape.
class Reach {
 public:
  explicit Reach(const Mesh& mesh) {
    constexpr int cuts = 24;
    const double height = mesh.bounds().max().z();
    for (int i = 0; i < cuts; ++i) {
      const double z = height * (i + 0.5) / cuts;
      auto& cut = cuts_.emplace_back();
      for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          const Eigen::Vector3d p = mesh.vertices[t[k]].cast<double>(),
                                q = mesh.vertices[t[(k + 1) % 3]].cast<double>();
          if ((p.z() < z) != (q.z() < z))
            cut.push_back((p + (q - p) * ((z - p.z()) / (q.z() - p.z()))).head<2>());
        }
    }
  }

  /// The largest change of it by a turn, metres.
  double change(double turn) const {
    double most = 0.0;
    for (const auto& cut : cuts_)
      for (int i = 0; i < 36; ++i) {
        const double angle = 2 * pi * i / 36;
        most = std::max(most, std::abs(furthest(cut, angle) - furthest(cut, angle + turn)));
      }
    return most;
  }

 private:
  static double furthest(const std::vector<Eigen::Vector2d>& cut, double angle) {
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    double most = -1.0;
    for (const Eigen::Vector2d& p : cut) most = std::max(most, p.dot(direction));
    return most;
  }
  std::vector<std::vector<Eigen::Vector2d>> cuts_;
};

TEST(ModelCatalogue, SymmetryHoldsWhereItIsClaimedAndNowhereElse) {
  for (const SceneModel& model : all_models()) {
    SCOPED_TRACE(model.name);
    const Symmetry& symmetry = model.symmetry;
    if (symmetry.is_continuous()) {
      EXPECT_TRUE(vertices_fall_on_vertices(model.mesh, 2 * pi / turned_sides));
      const Reach reach(model.mesh);
      const double radius = 0.5 * model.mesh.bounds().sizes().maxCoeff();
      EXPECT_LE(reach.change(1.0), radius * (1 - std::cos(pi / turned_sides)) + 1e-6)
          << "more than a chord's error";
      continue;
    }
    EXPECT_TRUE(vertices_fall_on_vertices(model.mesh, symmetry.period()));
    const Reach reach(model.mesh);
    for (const int finer : {2, 3, 4, 5, 6})
      EXPECT_GT(reach.change(symmetry.period() / finer), 0.0015)
          << "as good as " << finer << " times the symmetry";
  }
}

/// The linear map from one mesh's vertices to the other's, which are the same ones in the same order.
Eigen::Matrix3d linear_map(const Mesh& from, const Mesh& to) {
  const auto centred = [](const Mesh& mesh) {
    Eigen::Matrix3Xd points(3, mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      points.col(static_cast<int>(i)) = mesh.vertices[i].cast<double>();
    return Eigen::Matrix3Xd(points.colwise() - points.rowwise().mean());
  };
  const Eigen::Matrix3Xd a = centred(from), b = centred(to);
  return b * a.transpose() * (a * a.transpose()).inverse();
}

TEST(ModelCatalogue, TurnedOnesAreTurnedAndNotMirrored) {
  for (const auto& [turned, upright] : {std::pair("bottle_lying", "bottle"),
                                        {"bowl_upside_down", "bowl"},
                                        {"glass_upside_down", "glass"},
                                        {"milk_carton_lying", "milk_carton"},
                                        {"mug_upside_down", "mug"}}) {
    SCOPED_TRACE(turned);
    const Mesh from = catalogue_model(upright).mesh, to = catalogue_model(turned).mesh;
    ASSERT_EQ(from.triangles, to.triangles);
    const Eigen::Matrix3d map = linear_map(from, to);
    EXPECT_TRUE((map.transpose() * map).isApprox(Eigen::Matrix3d::Identity(), 1e-4));
    EXPECT_NEAR(map.determinant(), 1.0, 1e-4);
    EXPECT_LE(map(2, 2), 1e-4) << "up is down or sideways";
    EXPECT_NEAR(signed_volume(to) / signed_volume(from), 1.0, 1e-4);
  }
}

TEST(ModelCatalogue, VolumesAreThoseOfTheirShapes) {
  // A box under a gable: two prisms.
  const double w = 0.07, d = 0.09, h = 0.22;
  const double gable = w * 0.5 * (d + 0.006) * (0.055 - 0.018) + w * 0.006 * 0.018;
  EXPECT_NEAR(signed_volume(gabled_carton_mesh(w, d, h)) / (w * d * (h - 0.055) + gable), 1.0, 1e-5);
  // A cylinder less its two sunk lids and four bevelled rims: between these.
  const double cylinder = pi * 0.04 * 0.04 * 0.1, sunk = 2 * pi * 0.037 * 0.037 * 0.003;
  const double volume = signed_volume(even_can_mesh(0.04, 0.1));
  EXPECT_LT(volume, cylinder - sunk);
  EXPECT_GT(volume, 0.995 * (cylinder - sunk));
}

TEST(ChessPieces, HaveTheHeightsAndBasesOfTheStandard) {
  const std::map<std::string, double> heights{{"king", 95},   {"queen", 85}, {"bishop", 70},
                                              {"knight", 60}, {"rook", 55},  {"pawn", 50}};
  for (const auto& [name, height] : heights) {
    SCOPED_TRACE(name);
    const SceneModel piece = chess_model(name);
    EXPECT_NEAR(1000 * piece.mesh.bounds().max().z(), height, 1e-3);
    double base = 0.0;
    for (const Eigen::Vector3f& v : piece.mesh.vertices)
      if (v.z() < 0.001F) base = std::max(base, 2000.0 * v.head<2>().norm());
    EXPECT_GE(base, 0.4 * height - 1e-3);
    EXPECT_LE(base, 0.5 * height + 1e-3);
    EXPECT_LT(base, 800 * chess_square);
    EXPECT_EQ(piece.symmetry.is_continuous(), name != "king" && name != "knight");
  }
}

}  // namespace
}  // namespace perch
