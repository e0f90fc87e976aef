// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernels/parallel.h"
#include "tools/eval/scan/course_scanner.h"

namespace disparityd::eval {

/// What `disparity-eval --scan conditions:SEED` runs.
struct ConditionEvaluation {
    ScanSettings settings;
    std::uint32_t seed = 1;
    int courses = 8;
    std::vector<std::string> names;  ///< of conditions; empty: all
    std::string pictures;            ///< folder for a picture of each group of conditions; empty: none
};

/// Takes each course as it is and in each condition at each strength, scans it and prints a table: one row for the
/// clean courses, then one for each condition and strength. Courses run side by side on the workers. Shows progress; a
/// Ctrl-C ends it. Throws std::invalid_argument for an unknown name.
void report_conditions(const ConditionEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
