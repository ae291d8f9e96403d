#include "perch/localize/result.hpp"

namespace perch {

std::optional<double> Result::suboptimality_bound() const {
  if (!search_cost) return std::nullopt;
  if (lower_bound == 0) return *search_cost == 0 ? std::optional(1.0) : std::nullopt;
  return static_cast<double>(*search_cost) / static_cast<double>(lower_bound);
}

}  // namespace perch
