#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "perch/eval/record.hpp"
#include "perch/eval/summary.hpp"

namespace perch {

/// Writes evaluation.json, objects.csv, thresholds.csv and the figures thresholds and visibility, each as
/// .png and .svg: all together or none. Returns why there are no figures, one line, where gnuplot is not
/// installed; those of an earlier run are removed then. Throws InputError where the files can't be written.
std::string write_evaluation(const std::filesystem::path& folder, const std::vector<MethodRecord>& methods,
                             const std::vector<MethodSummary>& summaries);

/// Throws InputError where write_evaluation would, for reasons that can be seen beforehand. Leaves nothing.
void rehearse_evaluation(const std::filesystem::path& folder);

}  // namespace perch
