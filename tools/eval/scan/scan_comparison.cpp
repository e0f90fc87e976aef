// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_comparison.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace disparityd::eval {
namespace {

constexpr double distance_tolerance = 0.1;

/// Two scans, and what is asked of a sector and the two next to it.
class Sectors {
public:
    Sectors(const Scan& scan, const Scan& truth) : scan_(scan), truth_(truth) {}

    static bool occupied_between(const Scan& scan, int sector, double near, double far) {
        if (sector < 0 || sector >= static_cast<int>(scan.sectors.size())) {
            return false;
        }
        const ScanSector& seen = scan.sectors[static_cast<std::size_t>(sector)];
        return seen.state == SectorState::occupied && seen.distance_mm >= near && seen.distance_mm <= far;
    }

    static bool occupied_near(const Scan& scan, int sector, double near, double far) {
        return occupied_between(scan, sector - 1, near, far) || occupied_between(scan, sector, near, far) ||
               occupied_between(scan, sector + 1, near, far);
    }

    /// The scan shows an obstacle that the truth neither shows nor leaves room for.
    bool is_false_alarm(int sector) const {
        const ScanSector& seen = scan_.sectors[static_cast<std::size_t>(sector)];
        const double margin = distance_tolerance * seen.distance_mm + 2 * seen.sigma_mm;
        const double near = seen.distance_mm - margin;
        const double far = seen.distance_mm + margin;
        return seen.state == SectorState::occupied &&
               truth_.sectors[static_cast<std::size_t>(sector)].free_mm >= seen.distance_mm &&
               !occupied_near(truth_, sector, near, far);
    }

    /// What the truth shows is there, or hidden behind something else that is.
    bool shown(int sector) const {
        const double distance = truth_.sectors[static_cast<std::size_t>(sector)].distance_mm;
        const double near = (1 - distance_tolerance) * distance;
        return occupied_near(scan_, sector, near, (1 + distance_tolerance) * distance) ||
               (occupied_between(scan_, sector, 0, near) && !is_false_alarm(sector));
    }

private:
    const Scan& scan_;
    const Scan& truth_;
};

}  // namespace

void ScanComparison::add(const ScanComparison& other) {
    scenes += other.scenes;
    sectors += other.sectors;
    true_unknown += other.true_unknown;
    unknown += other.unknown;
    obstacles += other.obstacles;
    missed += other.missed;
    declared_free += other.declared_free;
    false_alarms += other.false_alarms;
    free_share += other.free_share;
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
}

ScanComparison compare(const Scan& scan, const Scan& truth, double farthest_m) {
    if (scan.sectors.size() != truth.sectors.size()) {
        throw std::logic_error("two scans of different sectors cannot be compared");
    }
    const Sectors sectors(scan, truth);
    ScanComparison counts;
    counts.scenes = 1;
    for (int s = 0; s < static_cast<int>(scan.sectors.size()); ++s) {
        const ScanSector& seen = scan.sectors[static_cast<std::size_t>(s)];
        const ScanSector& is = truth.sectors[static_cast<std::size_t>(s)];
        ++counts.sectors;
        if (is.state == SectorState::unknown) {
            ++counts.true_unknown;
            continue;
        }
        counts.unknown += seen.state == SectorState::unknown ? 1 : 0;
        counts.false_alarms += sectors.is_false_alarm(s) ? 1 : 0;
        counts.free_share += is.free_mm > 0 ? std::min<double>(seen.free_mm, is.free_mm) / is.free_mm : 1;
        if (is.state != SectorState::occupied || is.distance_mm > 1000 * farthest_m) {
            continue;
        }
        ++counts.obstacles;
        if (!sectors.shown(s)) {
            ++counts.missed;
            counts.declared_free += seen.free_mm > (1 + distance_tolerance) * is.distance_mm ? 1 : 0;
        } else if (Sectors::occupied_between(scan, s, (1 - distance_tolerance) * is.distance_mm,
                                             (1 + distance_tolerance) * is.distance_mm)) {
            counts.errors.push_back(std::abs(seen.distance_mm - is.distance_mm) / static_cast<double>(is.distance_mm));
        }
    }
    return counts;
}

}  // namespace disparityd::eval
