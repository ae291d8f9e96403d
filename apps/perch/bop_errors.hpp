#pragma once

#include <vector>

#include "perch/io/bop_dataset.hpp"
#include "perch/localize/result.hpp"

namespace perch::app {

/// Poses held against the annotations of a data set.
class BopErrors {
 public:
  /// \param residuals of image.truth, how far each is from standing on the plane. \param shown prints a line
  /// for each annotated object.
  void add(BopDataset& dataset, const BopImage& image, const Result& result,
           const std::vector<BopTruthResidual>& residuals, bool shown);
  /// One line on all of them, where there are any.
  void print() const;

 private:
  std::vector<double> distances_;  ///< MSSD of each annotated object, metres; infinite where it was not found
  std::size_t close_ = 0;          ///< of these, within a tenth of the diameter
};

}  // namespace perch::app
