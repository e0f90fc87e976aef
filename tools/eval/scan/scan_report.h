// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/eval/scan/course_scanner.h"

namespace disparityd::eval {

/// What `disparity-eval --scan` runs.
struct ScanEvaluation {
    ScanSettings settings;
    std::uint32_t seed = 1;
    int courses_per_kind = 8;
    std::string pictures;  ///< folder for a picture of each course; empty: none
};

/// Returns the seed of made-up courses, "courses:SEED"; nothing where DATA names something else. Throws
/// std::invalid_argument for a seed that is none, and for courses beside something else.
std::optional<std::uint32_t> seed_of_courses(const std::vector<std::string>& data);

/// The same of courses in bad conditions, "conditions:SEED".
std::optional<std::uint32_t> seed_of_conditions(const std::vector<std::string>& data);

/// Draws the courses, scans them and prints a table: one row per kind of course, then all. Shows progress; a Ctrl-C
/// ends it.
void report_scans(const ScanEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
