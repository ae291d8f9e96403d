// The look-up of a point of I near another, beside the exact nearest by a k-d tree.

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "kd_tree.hpp"
#include "observed_mug.hpp"
#include "perch/core/random.hpp"
#include "perch/observation/nearest_table.hpp"

namespace perch {
namespace {

/// Queries as ICP makes them: on and about the surface that was observed.
struct Queries {
  ObservedMug mug;
  NearestTable table{mug.observation, 0.02, SerialExecutor()};
  KdTree tree{mug.observation.points()};
  std::vector<Eigen::Vector3f> points;

  Queries() {
    Random random(1);
    const auto& observed = mug.observation.points();
    const auto offset = [&] { return static_cast<float>(random.uniform(-0.008, 0.008)); };
    for (int i = 0; i < 1000; ++i)
      points.push_back(observed[random.below(observed.size())] +
                       Eigen::Vector3f(offset(), offset(), offset()));
  }
  /// The table answers for a cell's middle, with one point for each cell: two diagonals more than the
  /// nearest, at most.
  bool agree() const {
    const float two_diagonals = 2.0F * 0.005F * std::sqrt(3.0F);
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Vector3f* found = table.lookup(p);
      const float exact = std::sqrt(tree.nearest(p).squared_distance);
      if (found == nullptr || (p - *found).norm() > exact + two_diagonals) return false;
    }
    return true;
  }
};

void look_up(benchmark::State& state) {
  const Queries queries;
  if (!queries.agree()) state.SkipWithError("the table's points lie too far away");
  for (auto _ : state)
    for (const Eigen::Vector3f& p : queries.points) benchmark::DoNotOptimize(queries.table.lookup(p));
}
BENCHMARK(look_up)->Name("nearest_1000/kernel")->Unit(benchmark::kMicrosecond);

void search_tree(benchmark::State& state) {
  const Queries queries;
  for (auto _ : state)
    for (const Eigen::Vector3f& p : queries.points) benchmark::DoNotOptimize(queries.tree.nearest(p));
}
BENCHMARK(search_tree)->Name("nearest_1000/k-d tree")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
