#include "perch/model/distance_transform.hpp"

#include <algorithm>
#include <limits>

namespace perch {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The lower envelope of parabolas rooted at (i, line[i]), evaluated at every i.
class LowerEnvelope {
 public:
  explicit LowerEnvelope(int longest)
      : line(static_cast<std::size_t>(longest)), roots_(line.size()), borders_(line.size() + 1) {}

  std::vector<float> line;

  void transform(std::size_t n, float* out, std::size_t stride) {
    std::size_t count = 0;
    for (std::size_t q = 0; q < n; ++q) {
      if (line[q] == infinity) continue;
      float border = -infinity;
      while (count > 0) {
        const std::size_t p = roots_[count - 1];
        const float fq = static_cast<float>(q), fp = static_cast<float>(p);
        border = ((line[q] + fq * fq) - (line[p] + fp * fp)) / (2.0F * (fq - fp));
        if (border > borders_[count - 1]) break;
        --count;
        border = -infinity;
      }
      roots_[count] = q;
      borders_[count] = border;
      ++count;
    }
    if (count == 0) {
      for (std::size_t q = 0; q < n; ++q) out[q * stride] = infinity;
      return;
    }
    std::size_t k = 0;
    for (std::size_t q = 0; q < n; ++q) {
      const float fq = static_cast<float>(q);
      while (k + 1 < count && borders_[k + 1] < fq) ++k;
      const float d = fq - static_cast<float>(roots_[k]);
      out[q * stride] = d * d + line[roots_[k]];
    }
  }

 private:
  std::vector<std::size_t> roots_;
  std::vector<float> borders_;
};

}  // namespace

void squared_distance_transform(std::vector<float>& grid, const Eigen::Vector3i& size) {
  LowerEnvelope envelope(size.maxCoeff());
  const std::size_t nx = static_cast<std::size_t>(size.x()), ny = static_cast<std::size_t>(size.y()),
                    nz = static_cast<std::size_t>(size.z());
  const auto pass = [&](std::size_t start, std::size_t n, std::size_t stride) {
    for (std::size_t q = 0; q < n; ++q) envelope.line[q] = grid[start + q * stride];
    envelope.transform(n, grid.data() + start, stride);
  };
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t j = 0; j < ny; ++j) pass((k * ny + j) * nx, nx, 1);
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t i = 0; i < nx; ++i) pass(k * ny * nx + i, ny, nx);
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) pass(j * nx + i, nz, nx * ny);
}

}  // namespace perch
