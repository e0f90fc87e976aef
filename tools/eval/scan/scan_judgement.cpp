// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_judgement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace disparityd::eval {
namespace {

/// The part of one object that lies in the band, in one sector.
struct Part {
    int paired = 0;  ///< pixels that both cameras see
    double nearest = 1e9;
    double farthest = 0;
    std::vector<double> distances;
};

/// What is there in each sector.
struct Truth {
    std::vector<std::map<int, Part>> parts;  ///< by sector, then by object
    std::map<int, Part> whole;               ///< by object
};

constexpr double tolerance = 0.1;

int sector_at(const Scan& scan, double bearing_deg) {
    for (std::size_t s = 0; s < scan.sectors.size(); ++s) {
        if (bearing_deg >= scan.sectors[s].from_cdeg / 100.0 && bearing_deg < scan.sectors[s].to_cdeg / 100.0) {
            return static_cast<int>(s);
        }
    }
    return -1;
}

void add(Part& part, double distance, bool paired) {
    part.paired += paired ? 1 : 0;
    part.nearest = std::min(part.nearest, distance);
    part.farthest = std::max(part.farthest, distance);
    part.distances.push_back(distance);
}

bool is_hole(const Course& course, int object) {
    return object >= 0 && course.obstacles[static_cast<std::size_t>(object)].shape == Obstacle::Shape::hole;
}

Truth truth_of(const Scan& scan, const ScanOptions& options, const CourseView& view, const Course& course) {
    Truth truth;
    truth.parts.resize(scan.sectors.size());
    for (std::size_t i = 0; i < view.object.size(); ++i) {
        const Point p = view.point[i];
        const double height = p.z - course.slope_ahead * p.x - course.slope_left * p.y;
        const bool in_band = height >= options.low_m && height < options.high_m;
        if (view.object[i] == -1 || view.object[i] == -3 || !(in_band || is_hole(course, view.object[i]))) {
            continue;
        }
        const int sector = sector_at(scan, std::atan2(p.y, p.x) * 180 / std::numbers::pi);
        if (sector >= 0) {
            const double distance = std::hypot(p.x, p.y);
            add(truth.parts[static_cast<std::size_t>(sector)][view.object[i]], distance, view.both[i] != 0);
            add(truth.whole[view.object[i]], distance, view.both[i] != 0);
        }
    }
    return truth;
}

/// Whether an object is large enough in the image: a post of 3 px, or as many pixels that both cameras
/// see as half of the smallest obstacle.
bool has_to_be_shown(const Part& whole, const Course& course, int object, const ScanOptions& options,
                     const CourseCamera& camera) {
    const double side = camera.f * options.object_m / whole.nearest;
    if (object >= 0) {
        const Obstacle& obstacle = course.obstacles[static_cast<std::size_t>(object)];
        const bool thin = obstacle.shape != Obstacle::Shape::box && obstacle.shape != Obstacle::Shape::hole;
        if (thin && 2 * obstacle.half.x * camera.f / whole.nearest < 3) {
            return false;
        }
    }
    return whole.paired >= side * side / 2;
}

class Judge {
public:
    Judge(const Scan& scan, const ScanOptions& options, const Course& course, const CourseCamera& camera,
          int disparities, const Truth& truth)
        : scan_(scan),
          options_(options),
          course_(course),
          camera_(camera),
          truth_(truth),
          k_(camera.f * camera.baseline_m),
          nearest_(k_ / (disparities - 1)),
          farthest_(std::min({k_ * tolerance / options.subpixel_error_px, options.max_m,
                              std::sqrt(k_ * options.max_error_m / options.subpixel_error_px)})) {}

    ScanCounts count() const {
        ScanCounts counts;
        counts.courses = 1;
        for (int s = 0; s < static_cast<int>(scan_.sectors.size()); ++s) {
            const ScanSector& sector = at(s);
            ++counts.sectors;
            counts.unknown += sector.state == SectorState::unknown ? 1 : 0;
            counts.false_alarms += is_false_alarm(s) ? 1 : 0;
            double open = farthest_;
            for (const auto& [object, part] : truth_.parts[static_cast<std::size_t>(s)]) {
                open = std::min(open, part.nearest);
            }
            counts.free_share += std::min(sector.free_mm / 1000.0, open) / open;
            count_obstacle(s, counts);
        }
        return counts;
    }

private:
    const ScanSector& at(int sector) const { return scan_.sectors[static_cast<std::size_t>(sector)]; }

    bool occupied_between(int sector, double near, double far) const {
        if (sector < 0 || sector >= static_cast<int>(scan_.sectors.size())) {
            return false;
        }
        const double distance = at(sector).distance_mm / 1000.0;
        return at(sector).state == SectorState::occupied && distance >= near && distance <= far;
    }

    void count_obstacle(int s, ScanCounts& counts) const {
        const Part* nearest = nullptr;
        for (const auto& [object, part] : truth_.parts[static_cast<std::size_t>(s)]) {
            // A sector that an object only touches is its neighbour's matter.
            const bool here =
                part.paired >= 8 && 4 * part.paired >= truth_.whole.at(object).paired / sectors_of(object);
            if (here && has_to_be_shown(truth_.whole.at(object), course_, object, options_, camera_) &&
                (nearest == nullptr || part.nearest < nearest->nearest)) {
                nearest = &part;
            }
        }
        if (nearest == nullptr || nearest->nearest > farthest_ || nearest->nearest < options_.min_m) {
            return;
        }
        const double free = at(s).free_mm / 1000.0;
        const bool said_free = free > (1 + tolerance) * nearest->farthest;
        if (nearest->nearest < nearest_) {
            ++counts.near;
            counts.near_free += said_free ? 1 : 0;
            return;
        }
        ++counts.obstacles;
        const double near = (1 - tolerance) * nearest->nearest;
        const double far = (1 + tolerance) * nearest->farthest;
        const bool shown = occupied_between(s, near, far) || occupied_between(s - 1, near, far) ||
                           occupied_between(s + 1, near, far) ||
                           (occupied_between(s, 0, near) && !is_false_alarm(s));  // a part of something nearer
        if (!shown) {
            ++counts.missed;
            counts.declared_free += said_free ? 1 : 0;
        } else if (occupied_between(s, near, far)) {
            std::vector<double> sorted = nearest->distances;
            std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                             sorted.end());
            const double middle = sorted[sorted.size() / 2];
            counts.errors.push_back(std::abs(at(s).distance_mm / 1000.0 - middle) / middle);
        }
    }

    int sectors_of(int object) const {
        int sectors = 0;
        for (const auto& parts : truth_.parts) {
            sectors += parts.contains(object) ? 1 : 0;
        }
        return std::max(sectors, 1);
    }

    bool is_false_alarm(int s) const {
        if (at(s).state != SectorState::occupied) {
            return false;
        }
        const double distance = at(s).distance_mm / 1000.0;
        const double margin = tolerance * distance + 2 * at(s).sigma_mm / 1000.0;
        for (int i = std::max(s - 1, 0); i <= std::min(s + 1, static_cast<int>(scan_.sectors.size()) - 1); ++i) {
            for (const auto& [object, part] : truth_.parts[static_cast<std::size_t>(i)]) {
                // What is too near is matched wrongly, but the way is blocked indeed.
                const bool too_near = part.nearest < nearest_ && distance > part.nearest;
                if (too_near || (distance >= part.nearest - margin && distance <= part.farthest + margin)) {
                    return false;
                }
            }
        }
        return true;
    }

    const Scan& scan_;
    const ScanOptions& options_;
    const Course& course_;
    const CourseCamera& camera_;
    const Truth& truth_;
    double k_;
    double nearest_;   ///< of the range of disparities
    double farthest_;  ///< where one sigma is a tenth of the distance, or nothing is reported any more
};

}  // namespace

void ScanCounts::add(const ScanCounts& other) {
    courses += other.courses;
    sectors += other.sectors;
    unknown += other.unknown;
    obstacles += other.obstacles;
    missed += other.missed;
    declared_free += other.declared_free;
    near += other.near;
    near_free += other.near_free;
    false_alarms += other.false_alarms;
    free_share += other.free_share;
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
}

ScanCounts judge(const Scan& scan, const ScanOptions& options, const CourseView& view, const Course& course,
                 const CourseCamera& camera, int disparities) {
    const Truth truth = truth_of(scan, options, view, course);
    return Judge(scan, options, course, camera, disparities, truth).count();
}

}  // namespace disparityd::eval
