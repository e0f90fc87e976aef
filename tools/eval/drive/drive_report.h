// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/parallel.h"
#include "tools/eval/drive/drive.h"
#include "tools/eval/drive/matched_sight.h"

namespace disparityd::eval {

/// What `disparity-eval --scan drive:SEED` runs.
struct DriveEvaluation {
    ScanSettings settings;
    std::uint32_t seed = 1;
    int courses = 100;
    /// Of conditions, beside the clean courses; "all": all of them. "noise:low" is one strength, else there are all.
    std::vector<std::string> names;
    std::string pictures;  ///< folder for a picture of each clean drive; empty: none
    Robot robot;
};

/// The drives of one row of the table.
struct DriveCounts {
    int courses = 0;
    int collisions = 0;
    int reached = 0;
    int stops = 0;
    double gone_m = 0;
    double seconds = 0;
    double true_gone_m = 0;  ///< with perfect depth, from here on
    double true_seconds = 0;
    int true_reached = 0;
    int true_collisions = 0;
    std::vector<std::string> collided;  ///< one line for each collision

    void add(const DriveCounts& other);
    double speed() const { return seconds > 0 ? gone_m / seconds : 0; }
    double true_speed() const { return true_seconds > 0 ? true_gone_m / true_seconds : 0; }
};

/// Returns the seed of drives, "drive:SEED"; nothing where DATA names something else. Throws std::invalid_argument for
/// a seed that is none, and for drives beside something else.
std::optional<std::uint32_t> seed_of_drives(const std::vector<std::string>& data);

/// Drives one course in a condition, and the same with perfect depth.
DriveCounts count_drive(const Course& course, const ConditionAt& at, const DriveEvaluation& evaluation);

/// The same, with what perfect depth gives in the course as it is: most conditions do not change that.
DriveCounts count_drive(const Course& course, const ConditionAt& at, const DriveEvaluation& evaluation,
                        const DriveResult& perfect_as_it_is);

/// Drives all courses and prints a table: one row for the clean courses, then one for each condition and strength; then
/// a line for each collision. Courses run side by side on the workers. Shows progress; a Ctrl-C ends it. Throws
/// std::invalid_argument for an unknown name or strength.
void report_drives(const DriveEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
