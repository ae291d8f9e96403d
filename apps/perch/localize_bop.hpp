#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "perch/core/stopwatch.hpp"
#include "perch/io/bop_dataset.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// The options of `perch localize` for data sets in BOP layout.
class BopLocalization {
 public:
  void add_to(CLI::App& command);
  bool given() const { return !folder_.empty(); }
  const std::string& folder() const { return folder_; }
  const BopOptions& options() const { return options_; }
  /// The images to be localized. Throws InputError.
  std::vector<BopImageTargets> images(BopDataset& dataset) const;
  /// Throws InputError where options of data sets are given without one.
  void check() const;

 private:
  std::string folder_;
  BopOptions options_;
  std::optional<int> scene_, image_;
  std::optional<std::string> targets_;
};

/// Localizes images of a data set and writes BOP's results file. Returns the exit status.
/// \param output folder for all that is written, or empty. \param watch since the command began.
int localize_bop(const BopLocalization& bop, const Settings& settings, const Executor& executor,
                 const std::string& output, bool quiet, const Stopwatch& watch);

}  // namespace perch::app
