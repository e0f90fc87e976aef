// SPDX-License-Identifier: Apache-2.0
#include "obstacles/origin_shift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "obstacles/scan_geometry.h"

namespace disparityd::scan {
namespace {

constexpr double widest_cone_deg = 90;
/// A point on the ground can lie so far aside of its direction from the origin, seen from the camera.
constexpr double most_aside_deg = 90;
/// The camera is on the robot: what is nearer to the origin than so many times its own distance is the robot.
constexpr double robot_share = 1.5;
/// The parts of a sector at its edges, of its width, that are not asked for, and that make no obstacle of one.
constexpr double edge_share = 0.25;
constexpr double least_camera_m = 0.01;
constexpr double most_m = 65;
constexpr std::size_t arc_points = 9;

/// 0 tells nothing.
std::uint8_t lesser_trust(std::uint8_t one, std::uint8_t other) {
    return one == 0 || other == 0 ? std::max(one, other) : std::min(one, other);
}

double largest_way(const ScanOptions& options) {
    return std::sqrt(options.camera_ahead_m * options.camera_ahead_m + options.camera_left_m * options.camera_left_m);
}

bool whole_view(const ScanOptions& options) {
    return options.from_deg == 0 && options.to_deg == 0;
}

/// Returns how many sectors are added on each side, so that the camera's reach as far aside as those of the origin.
int sectors_aside(const ScanOptions& options) {
    if (whole_view(options)) {
        return 0;
    }
    const double range = options.to_deg - options.from_deg;
    const double width = range / options.sectors;
    const double fitting = std::min(std::ceil(most_aside_deg / width), std::floor((360 - range) / (2 * width)));
    return std::max(std::min(static_cast<int>(fitting), (max_scan_sectors - options.sectors) / 2), 0);
}

ScanOptions around_camera(const ScanOptions& options) {
    ScanOptions wider = options;
    const int more = sectors_aside(options);
    const double width = (options.to_deg - options.from_deg) / options.sectors;
    wider.sectors += 2 * more;
    wider.from_deg -= more * width;
    wider.to_deg += more * width;
    wider.min_m = std::max(options.min_m - largest_way(options), least_camera_m);
    wider.max_m = std::min(options.max_m + largest_way(options), most_m);
    return wider;
}

template <typename Point>
double cross(const Point& a, const Point& b) {
    return a.ahead * b.left - a.left * b.ahead;
}

template <typename Point>
double dot(const Point& a, const Point& b) {
    return a.ahead * b.ahead + a.left * b.left;
}

template <typename Point>
Point direction_of(double bearing_deg) {
    return {std::cos(bearing_deg * per_degree), std::sin(bearing_deg * per_degree)};
}

template <typename Point>
double bearing_of(const Point& point) {
    return std::atan2(point.left, point.ahead) / per_degree;
}

std::uint16_t whole_mm(double value) {
    return static_cast<std::uint16_t>(std::floor(std::clamp(value, 0.0, 65535.0) + 0.5));
}

}  // namespace

bool is_shifted(const ScanOptions& options) {
    return options.camera_ahead_m != 0 || options.camera_left_m != 0;
}

OriginShift::OriginShift(const ScanOptions& options)
    : options_(options),
      camera_options_(around_camera(options)),
      more_(sectors_aside(options)),
      camera_{1000 * options.camera_ahead_m, 1000 * options.camera_left_m},
      least_mm_(1000 * options.min_m),
      most_mm_(1000 * options.max_m),
      asked_from_mm_(std::max(least_mm_, 1000 * robot_share * largest_way(options))),
      found_(static_cast<std::size_t>(options.sectors)) {
    // A sector is split into at most 360 / 90 cones more than it would have by itself, and so is what lies outside all.
    cones_.reserve(static_cast<std::size_t>(camera_options_.sectors) +
                   2 * static_cast<std::size_t>(360 / widest_cone_deg) + 2);
}

void OriginShift::move(std::span<const ScanSector> camera_sectors, std::span<ScanSector> sectors) {
    set_edges(camera_sectors, sectors);
    make_cones(camera_sectors);
    std::fill(found_.begin(), found_.end(), Found{.free_mm = most_mm_});
    find_free();
    for (std::size_t s = 0; s < camera_sectors.size(); ++s) {
        if (camera_sectors[s].state == SectorState::occupied) {
            find_obstacle(camera_sectors[s], static_cast<int>(s));
        }
    }
    put(camera_sectors, sectors);
}

void OriginShift::set_edges(std::span<const ScanSector> camera_sectors, std::span<ScanSector> sectors) {
    const auto first = camera_sectors.begin() + more_;
    for (std::size_t s = 0; s < sectors.size(); ++s) {
        sectors[s] = {};
        sectors[s].from_cdeg = first[static_cast<std::ptrdiff_t>(s)].from_cdeg;
        sectors[s].to_cdeg = first[static_cast<std::ptrdiff_t>(s)].to_cdeg;
    }
    from_deg_ = sectors.front().from_cdeg / 100.0;
    width_deg_ = (sectors.back().to_cdeg / 100.0 - from_deg_) / static_cast<double>(sectors.size());
}

void OriginShift::make_cones(std::span<const ScanSector> camera_sectors) {
    cones_.clear();
    for (const ScanSector& sector : camera_sectors) {
        add_cones(sector.from_cdeg / 100.0, sector.to_cdeg / 100.0, sector.free_mm);
    }
    add_cones(camera_sectors.back().to_cdeg / 100.0, camera_sectors.front().from_cdeg / 100.0 + 360, 0);
}

/// Adds a range of bearings around the camera, of which the image shows nothing where nothing of it is free.
void OriginShift::add_cones(double from_deg, double to_deg, double free_mm) {
    const double parts = std::ceil((to_deg - from_deg) / widest_cone_deg);
    for (int i = 0; i < static_cast<int>(parts); ++i) {
        cones_.push_back({direction_of<Point>(from_deg + (to_deg - from_deg) * i / parts),
                          direction_of<Point>(from_deg + (to_deg - from_deg) * (i + 1) / parts), free_mm, free_mm > 0});
    }
}

/// Returns the least distance along a ray from the origin at which a point of the cone is not known to be free.
std::optional<double> OriginShift::blocked_at(const Cone& cone, const Point& direction) const {
    double from = cone.seen ? least_mm_ : asked_from_mm_;
    double to = std::numeric_limits<double>::infinity();
    const auto limit = [&](double per_mm, double least) {  // per_mm t >= least
        if (per_mm > 0) {
            from = std::max(from, least / per_mm);
        } else if (per_mm < 0) {
            to = std::min(to, least / per_mm);
        } else if (least > 0) {
            to = 0;
        }
    };
    // The point t direction - camera lies to the left of the right edge and to the right of the left one.
    limit(cross(cone.right, direction), cross(cone.right, camera_));
    limit(cross(direction, cone.left), cross(camera_, cone.left));
    if (!(from < to)) {
        return std::nullopt;
    }
    if (!cone.seen) {
        return from > asked_from_mm_ ? from : 0;
    }
    // It is free while the point is no farther from the camera than the sector is free.
    const double along = dot(direction, camera_);
    const double root = along * along - dot(camera_, camera_) + cone.free_mm * cone.free_mm;
    if (root < 0 || from < along - std::sqrt(root) || from > along + std::sqrt(root)) {
        return from;
    }
    const double end = along + std::sqrt(root);
    return end < to ? std::optional(end) : std::nullopt;
}

double OriginShift::free_along(double bearing_deg) const {
    const auto direction = direction_of<Point>(bearing_deg);
    double free = most_mm_;
    for (const Cone& cone : cones_) {
        free = std::min(free, blocked_at(cone, direction).value_or(free));
    }
    return free;
}

void OriginShift::find_free() {
    const double edge = edge_share * width_deg_;
    for (std::size_t s = 0; s < found_.size(); ++s) {
        const double from = from_deg_ + width_deg_ * static_cast<double>(s);
        found_[s].free_mm = std::min(free_along(from + edge), free_along(from + width_deg_ - edge));
    }
    for (const Cone& cone : cones_) {
        block_corners(cone);
    }
}

/// Limits what is free by a point between the rays of find_free().
void OriginShift::block(const Point& point, double min_mm) {
    const double distance = std::sqrt(dot(point, point));
    const double middle = from_deg_ + width_deg_ * static_cast<double>(found_.size()) / 2;
    const double sector = (middle + std::remainder(bearing_of(point) - middle, 360.0) - from_deg_) / width_deg_;
    const double within = sector - std::floor(sector);
    if (distance < min_mm || sector < 0 || sector >= static_cast<double>(found_.size()) || within < edge_share ||
        within > 1 - edge_share) {
        return;
    }
    Found& found = found_[static_cast<std::size_t>(sector)];
    found.free_mm = std::min(found.free_mm, distance);
}

/// Limits what is free by the points of a cone, not known to be free, that are nearest to the origin.
void OriginShift::block_corners(const Cone& cone) {
    const double least = cone.seen ? least_mm_ : asked_from_mm_;
    const auto at = [this](const Point& direction, double distance) {
        return Point{camera_.ahead + distance * direction.ahead, camera_.left + distance * direction.left};
    };
    for (const Point* edge : {&cone.right, &cone.left}) {
        block(at(*edge, std::max(cone.free_mm, -dot(*edge, camera_))), least);
    }
    // The arc around the camera is nearest where it faces the origin.
    const double way = std::sqrt(dot(camera_, camera_));
    const Point home{-camera_.ahead / way, -camera_.left / way};
    if (cross(cone.right, home) > 0 && cross(home, cone.left) > 0) {
        block(at(home, cone.free_mm), least);
    }
}

/// Finds the sectors around the origin that an obstacle lies in: an arc around the camera as wide as its sector.
void OriginShift::find_obstacle(const ScanSector& obstacle, int camera_sector) {
    std::array<double, arc_points> bearings{};
    std::array<double, arc_points> distances{};
    const double middle = from_deg_ + width_deg_ * static_cast<double>(found_.size()) / 2;
    for (std::size_t i = 0; i < arc_points; ++i) {
        const double part = static_cast<double>(i) / (arc_points - 1);
        const auto direction =
            direction_of<Point>((obstacle.from_cdeg + (obstacle.to_cdeg - obstacle.from_cdeg) * part) / 100);
        const Point point{camera_.ahead + obstacle.distance_mm * direction.ahead,
                          camera_.left + obstacle.distance_mm * direction.left};
        distances[i] = std::sqrt(dot(point, point));
        const double before = i == 0 ? middle : bearings[i - 1];
        bearings[i] = before + std::remainder(bearing_of(point) - before, 360.0);
    }
    const auto [right, left] = std::minmax_element(bearings.begin(), bearings.end());
    const double enough = edge_share * std::min(*left - *right, width_deg_);
    for (std::size_t s = 0; s < found_.size(); ++s) {
        for (const double turn : {-360.0, 0.0, 360.0}) {
            const double from = from_deg_ + width_deg_ * static_cast<double>(s) + turn;
            const double to = from + width_deg_;
            if (std::min(*left, to) - std::max(*right, from) < enough) {
                continue;
            }
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i + 1 < arc_points; ++i) {
                const auto [one, other] = std::minmax(bearings[i], bearings[i + 1]);
                if (one <= to && other >= from) {
                    nearest = std::min({nearest, distances[i], distances[i + 1]});
                }
            }
            Found& found = found_[s];
            found.doubts |= obstacle.doubts;
            found.trust = lesser_trust(found.trust, obstacle.trust);
            if (found.obstacle < 0 || nearest < found.obstacle_mm) {
                found.obstacle = camera_sector;
                found.obstacle_mm = nearest;
            }
        }
    }
}

/// Adds the doubts of what a sector says up to a distance: those of all camera sectors that the way to it leads
/// through. Seen from the camera the way turns in one direction only.
void OriginShift::find_doubts(std::span<const ScanSector> camera_sectors, int sector, double end_mm,
                              ScanSector& out) const {
    const auto direction = direction_of<Point>(from_deg_ + width_deg_ * (sector + 0.5));
    const double first_deg = camera_sectors.front().from_cdeg / 100.0;
    const double range_deg = camera_sectors.back().to_cdeg / 100.0 - first_deg;
    const auto seen_at = [&](double mm) {
        const Point point{mm * direction.ahead - camera_.ahead, mm * direction.left - camera_.left};
        return std::remainder(bearing_of(point) - first_deg - range_deg / 2, 360.0) + range_deg / 2;
    };
    double begin = seen_at(least_mm_);
    if (begin < 0 || begin > range_deg) {
        begin = seen_at(std::min(std::max(least_mm_, asked_from_mm_), end_mm));  // the robot is in between
    }
    const double end = begin + std::remainder(seen_at(end_mm) - begin, 360.0);
    const double width = range_deg / static_cast<double>(camera_sectors.size());
    for (std::size_t s = 0; s < camera_sectors.size(); ++s) {
        const double right = width * static_cast<double>(s);
        if (right <= std::max(begin, end) && right + width > std::min(begin, end)) {
            out.doubts |= camera_sectors[s].doubts;
            out.trust = lesser_trust(out.trust, camera_sectors[s].trust);
        }
    }
}

void OriginShift::put(std::span<const ScanSector> camera_sectors, std::span<ScanSector> sectors) const {
    for (std::size_t s = 0; s < sectors.size(); ++s) {
        const Found& found = found_[s];
        ScanSector& out = sectors[s];
        const bool any = found.obstacle >= 0;
        const double free = any ? std::min(found.free_mm, found.obstacle_mm) : found.free_mm;
        out.free_mm = free > least_mm_ ? whole_mm(free) : 0;
        if (any && found.obstacle_mm >= least_mm_ && found.obstacle_mm <= most_mm_) {
            const ScanSector& seen = camera_sectors[static_cast<std::size_t>(found.obstacle)];
            const auto from = out.from_cdeg;
            const auto to = out.to_cdeg;
            const auto free_mm = out.free_mm;
            out = seen;
            out.from_cdeg = from;
            out.to_cdeg = to;
            out.distance_mm = whole_mm(found.obstacle_mm);
            out.free_mm = std::min(free_mm, out.distance_mm);
        } else {
            out.state = out.free_mm > 0 ? SectorState::free : SectorState::unknown;
        }
        // An obstacle that is nearer than is told, or behind another one, leaves its doubts.
        out.doubts = found.doubts;
        out.trust = found.trust;
        const double end = out.state == SectorState::unknown ? most_mm_ : std::max(out.free_mm, out.distance_mm);
        find_doubts(camera_sectors, static_cast<int>(s), end, out);
    }
}

}  // namespace disparityd::scan
