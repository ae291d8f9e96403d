// How many points a candidate explains that a scene does not yet, beside one point at a time.

#include <benchmark/benchmark.h>

#include "perch/core/random.hpp"
#include "perch/observation/point_set.hpp"

namespace perch {
namespace {

/// 20,000 points of I; a candidate explains those of a quarter of them, each with some left out.
struct Sets {
  static constexpr std::size_t points = 20'000, first = 7'000, last = 12'000;
  PointSet candidate, scene{points};

  Sets() {
    Random random(1);
    PointSet all(points);
    for (std::size_t i = 0; i < points; ++i) {
      if (i >= first && i < last && random.uniform() < 0.9) all.insert(i);
      if (random.uniform() < 0.5) scene.insert(i);
    }
    candidate = all.trimmed();
  }
  std::size_t one_by_one() const {
    std::size_t count = 0;
    for (std::size_t i = first; i < last; ++i) count += candidate.contains(i) && !scene.contains(i);
    return count;
  }
};

void count_words(benchmark::State& state) {
  const Sets sets;
  if (sets.candidate.count_not_in(sets.scene) != sets.one_by_one())
    state.SkipWithError("the counts are not the same");
  for (auto _ : state) benchmark::DoNotOptimize(sets.candidate.count_not_in(sets.scene));
}
BENCHMARK(count_words)->Name("count_not_in/kernel")->Unit(benchmark::kMicrosecond);

void count_points(benchmark::State& state) {
  const Sets sets;
  for (auto _ : state) benchmark::DoNotOptimize(sets.one_by_one());
}
BENCHMARK(count_points)->Name("count_not_in/one by one")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
