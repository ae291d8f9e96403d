#pragma once

#include <string>
#include <vector>

#include "perch/eval/record.hpp"
#include "perch/eval/summary.hpp"

// Evaluations as text; the formats are in docs/evaluation.md. Every text ends with a newline.
namespace perch {

/// For a terminal: the counts at the paper's thresholds, the verdicts and the recalls of each method, and the
/// scenes without a result.
std::string summary_table(const std::vector<MethodSummary>& summaries);

/// For a terminal: a line for each object under each method.
std::string object_table(const std::vector<MethodRecord>& methods);

/// objects.csv: a line for each object under each method, with every error.
std::string objects_csv(const std::vector<MethodRecord>& methods);

/// thresholds.csv: a line for each method and threshold of the paper.
std::string thresholds_csv(const std::vector<MethodSummary>& summaries);

/// evaluation.json: the summaries, and every record that they are made of.
std::string evaluation_json(const std::vector<MethodRecord>& methods,
                            const std::vector<MethodSummary>& summaries);

}  // namespace perch
