#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "perch/eval/record.hpp"
#include "perch/eval/summary.hpp"

// Several methods on the same scenes, for people to read.
namespace perch {

/// The scenes of a record from the one solved best to the one solved worst: by the share of objects within
/// right_threshold, and of equal ones by the mean translation error, no more than 10 cm counted of each and
/// 10 cm for one that was not found; of still equal ones the first comes first.
std::vector<std::size_t> ranked_scenes(const MethodRecord& record);

/// A picture of a comparison, and what is to be seen on it.
struct ShownPicture {
  std::string file;  ///< relative to the text
  std::string caption;
};

/// Tables in Markdown: recall at each threshold of the paper, and what it took: seconds, hypotheses, bounds.
std::string comparison_tables(const std::vector<MethodSummary>& summaries);

/// A page in Markdown that holds the tables and the pictures. \param introduction a paragraph.
std::string comparison_page(const std::string& introduction, const std::vector<MethodSummary>& summaries,
                            const std::vector<ShownPicture>& pictures);

}  // namespace perch
