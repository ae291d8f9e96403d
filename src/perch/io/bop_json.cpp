#include "perch/io/bop_json.hpp"

#include <fmt/format.h>

#include "perch/core/error.hpp"
#include "perch/core/pose.hpp"

namespace perch {

JsonEntry read_bop_json(const std::filesystem::path& file) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{256} << 20U;  // ten thousand images of twenty objects
  return JsonEntry::read(file, {fmt::format("{} of a BOP data set", file.filename().string()), most_bytes});
}

int bop_number(const JsonEntry& entry) {
  constexpr std::int64_t most = 999'999;
  const std::int64_t number = entry.integer();
  if (number < 0 || number > most)
    entry.fail(fmt::format("{} is no number of BOP; give one from 0 to {}", number, most));
  return static_cast<int>(number);
}

std::string six_digits(int number) {
  return fmt::format("{:06}", number);
}

Eigen::Matrix3d bop_rotation(const JsonEntry& entry) {
  const std::vector<double> numbers = entry.numbers(9);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix(i, j) = numbers[static_cast<std::size_t>(3 * i + j)];
  try {
    return rigid_transform(matrix, "the matrix").linear();
  } catch (const InputError& e) {
    entry.fail(fmt::format("{}; give a rotation, row after row", e.what()));
  }
}

Eigen::Vector3d bop_lengths(const JsonEntry& entry) {
  const std::vector<double> mm = entry.numbers(3);
  return 0.001 * Eigen::Vector3d(mm[0], mm[1], mm[2]);
}

}  // namespace perch
