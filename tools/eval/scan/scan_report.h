// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kernels/matcher.h"
#include "kernels/scan/scan_options.h"

namespace disparityd::eval {

/// What `disparity-eval --scan` runs.
struct ScanEvaluation {
    MatchOptions match;
    ScanOptions scan;
    const Backend* backend = nullptr;
    std::uint32_t seed = 1;
    int courses_per_kind = 8;
    std::string pictures;  ///< folder for a picture of each course; empty: none
};

/// Draws the courses, scans them and prints a table: one row per kind of course, then all. Shows progress; a Ctrl-C
/// ends it.
void report_scans(const ScanEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
