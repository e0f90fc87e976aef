// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "obstacles/scan.h"

namespace disparityd::eval {

/// What the scans of matched images showed of what those of the true disparities show.
struct ScanComparison {
    int scenes = 0;
    int sectors = 0;
    int true_unknown = 0;        ///< sectors of which the truth itself knows nothing; they are not judged
    int unknown = 0;             ///< of the others
    int obstacles = 0;           ///< sectors in which the truth shows an obstacle, near enough to be told
    int missed = 0;              ///< of those: not shown within 10 % of its distance, there or in the next sector
    int declared_free = 0;       ///< of the missed ones: the sector is said to be free beyond the obstacle
    int false_alarms = 0;        ///< sectors with an obstacle where the truth is free
    double free_share = 0;       ///< sum over judged sectors: how much of what the truth has free is said to be
    std::vector<double> errors;  ///< of the distances of obstacles that were shown, relative

    void add(const ScanComparison& other);
};

/// Compares two scans of the same sectors. `farthest_m`: obstacles beyond it need not be shown.
ScanComparison compare(const Scan& scan, const Scan& truth, double farthest_m);

}  // namespace disparityd::eval
