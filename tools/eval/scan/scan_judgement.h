// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "obstacles/scan.h"
#include "obstacles/scan_options.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// What the scans of some courses showed of what was there.
struct ScanCounts {
    int courses = 0;
    int sectors = 0;
    int unknown = 0;             ///< sectors
    int obstacles = 0;           ///< sectors whose nearest obstacle has to be shown
    int missed = 0;              ///< of those: not shown within 10 % of its distance, there or in the next sector
    int declared_free = 0;       ///< of the missed ones: the sector is said to be free beyond the obstacle
    int near = 0;                ///< sectors with an obstacle nearer than the range of disparities
    int near_free = 0;           ///< of those: said to be free beyond it
    int false_alarms = 0;        ///< sectors with an obstacle where nothing is
    double free_share = 0;       ///< sum over sectors: how much of what is free is said to be
    std::vector<double> errors;  ///< of the distances of obstacles that were shown, relative

    void add(const ScanCounts& other);
};

/// Compares the scan of a course with the course. `disparities`: the candidates, from 0 on.
ScanCounts judge(const Scan& scan, const ScanOptions& options, const CourseView& view, const Course& course,
                 const CourseCamera& camera, int disparities);

}  // namespace disparityd::eval
