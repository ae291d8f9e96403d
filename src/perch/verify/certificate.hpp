#pragma once

#include "perch/io/result_file.hpp"
#include "perch/localize/scene.hpp"
#include "perch/verify/check.hpp"

namespace perch {

/// Checks what needs no picture: whether the numbers of the certificate fit each other, whether counts are
/// counts, and whether the objects are those of the scene, in its order. The lower bound itself is taken on
/// trust.
void check_certificate(const Scene& scene, const ReportedResult& result, Checks& checks);

}  // namespace perch
