#pragma once

#include <string>
#include <vector>

#include "perch/eval/summary.hpp"

// Scripts for gnuplot that draw on its standard output, for run_gnuplot. There must be a method, and all must
// have been held against the same scenes.
namespace perch {

enum class FigureFormat { png, svg };

/// The paper's three histograms: how many objects each method recognized, a panel for each limit of the
/// translation, a group of bars for each limit of the yaw. Ambiguous objects stand paler on top.
std::string threshold_figure(const std::vector<MethodSummary>& summaries, FigureFormat format);

/// The share of objects within 1 cm and 10 degrees against how much of them is visible, with 95 % intervals.
std::string visibility_figure(const std::vector<MethodSummary>& summaries, FigureFormat format);

}  // namespace perch
