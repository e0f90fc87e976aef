// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/laser_scan_message.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bridges/ros_messages/message_header.h"

namespace disparityd::ros {
namespace {

using disparity::Scan;
using disparity::ScanSector;
using disparity::SectorState;

constexpr double most_rays = 3600;
constexpr double edge_deg = 0.015;  // edges are told in 1/100 degree: less than this is not an overlap
constexpr double millimetre = 0.001;

/// Has equal parts of the scan's range of bearings.
struct Grid {
    double from_deg;
    double step_deg;
    int rays;
};

Grid grid_of(const Scan& scan) {
    double widths = 0;
    double from = scan.sectors.front().from_deg;
    double to = from;
    for (const ScanSector& sector : scan.sectors) {
        widths += std::max(0.0, sector.to_deg - sector.from_deg);
        from = std::min(from, sector.from_deg);
        to = std::max(to, sector.to_deg);
    }
    const double mean = std::max(widths / static_cast<double>(scan.sectors.size()), 0.01);
    const double rays = std::clamp(std::round((to - from) / mean), 1.0, most_rays);
    return {from, (to - from) / rays, static_cast<int>(rays)};
}

struct Ray {
    float range = std::numeric_limits<float>::quiet_NaN();
    float intensity = 0;
};

/// Returns where the ray ends in an occupied sector.
double end_of(const ScanSector& sector, HiddenSpace hidden, double min_m) {
    const bool as_near_as_may_be = hidden == HiddenSpace::obstacle || sector.is_near();
    return std::max(as_near_as_may_be ? std::min(sector.free_m, sector.distance_m) : sector.distance_m, min_m);
}

Ray ray_of(const Scan& scan, HiddenSpace hidden, double from_deg, double to_deg) {
    const double least = std::min(edge_deg, (to_deg - from_deg) / 4);
    double free_deg = 0;
    std::optional<Ray> nearest;
    for (const ScanSector& sector : scan.sectors) {
        const double overlap = std::min(to_deg, sector.to_deg) - std::max(from_deg, sector.from_deg);
        if (overlap <= least) {
            continue;
        }
        if (sector.state == SectorState::occupied) {
            const Ray ray{static_cast<float>(end_of(sector, hidden, scan.min_m)),
                          static_cast<float>(sector.confidence)};
            nearest = !nearest || ray.range < nearest->range ? ray : nearest;
        } else if (sector.state == SectorState::free && sector.free_m >= scan.max_m - millimetre / 2) {
            free_deg += overlap;
        }
    }
    if (nearest) {
        return *nearest;
    }
    return free_deg >= to_deg - from_deg - 2 * least ? Ray{std::numeric_limits<float>::infinity(), 0} : Ray{};
}

float radians(double degrees) {
    return static_cast<float>(degrees * std::numbers::pi / 180);
}

}  // namespace

std::optional<std::string> laser_scan(const Scan& scan, std::int64_t realtime_ns, const FrameNames& names,
                                      HiddenSpace hidden) {
    if (scan.sectors.empty()) {
        return std::nullopt;
    }
    const Grid grid = grid_of(scan);
    std::vector<float> ranges;
    std::vector<float> intensities;
    for (int i = 0; i < grid.rays; ++i) {
        const double from = grid.from_deg + i * grid.step_deg;
        const Ray ray = ray_of(scan, hidden, from, from + grid.step_deg);
        ranges.push_back(ray.range);
        intensities.push_back(ray.intensity);
    }
    const double first = grid.from_deg + grid.step_deg / 2;
    CdrWriter cdr(8 * ranges.size() + 256);
    write_header(cdr, realtime_ns, names.scan);
    cdr.f32(radians(first)).f32(radians(first + (grid.rays - 1) * grid.step_deg)).f32(radians(grid.step_deg));
    cdr.f32(0).f32(0);  // all rays are of one instant
    cdr.f32(static_cast<float>(scan.min_m)).f32(static_cast<float>(scan.max_m));
    cdr.f32_sequence(ranges).f32_sequence(intensities);
    return cdr.take();
}

}  // namespace disparityd::ros
