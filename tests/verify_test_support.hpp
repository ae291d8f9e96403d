#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "perch/io/result_file.hpp"
#include "perch/io/result_json.hpp"
#include "perch/io/test_files.hpp"
#include "perch/verify/count_range.hpp"
#include "perch/verify/verify.hpp"

namespace perch::testing_verify {

/// The checks of a result.json with this text.
inline Checks verify_text(const Scene& scene, const std::string& text) {
  const testing_files::TemporaryDirectory directory;
  const ReportedResult result = read_result(directory.write("result.json", text), scene);
  return verify(scene, result, stated_settings(result.guarantee));
}

inline const Check& check_of(const Checks& checks, const std::string& name) {
  const auto found =
      std::find_if(checks.begin(), checks.end(), [&](const Check& check) { return check.name == name; });
  if (found == checks.end()) throw std::logic_error("no check " + name);
  return *found;
}

/// The range of a count that a check recomputed, as printed.
inline CountRange range_of(const Checks& checks, const std::string& name) {
  const std::string& text = check_of(checks, name).recomputed;
  long long low = 0, high = 0;
  const int read = std::sscanf(text.c_str(), "%lld to %lld", &low, &high);
  if (read < 1) throw std::logic_error(name + " has no range: " + text);
  return {low, read == 2 ? high : low};
}

inline std::vector<std::string> wrong_of(const Checks& checks) {
  std::vector<std::string> names;
  for (const Check& check : checks)
    if (!check.holds) names.push_back(check.name);
  return names;
}

}  // namespace perch::testing_verify
