// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/obstacle_message.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace disparityd::mavlink {
namespace {

using disparity::ScanSector;
using disparity::SectorState;

constexpr std::uint8_t sensor_type = 4;  // MAV_DISTANCE_SENSOR_UNKNOWN: there is no value for cameras
constexpr std::uint8_t body_frd = 12;    // MAV_FRAME_BODY_FRD

/// Bearings in 1/100 degree, as the scan's record has them: sectors that touch have equal edges.
using Interval = std::pair<long, long>;
constexpr long circle = 36000;

Interval bearings(const ScanSector& sector) {
    return {std::lround(sector.from_deg * 100), std::lround(sector.to_deg * 100)};
}

/// Returns the bearings of a sector of the message: they grow to the left, the message's angles to the right.
Interval bearings(std::size_t message_sector) {
    const long middle = -100L * sector_width_deg * static_cast<long>(message_sector);
    return {middle - 50L * sector_width_deg, middle + 50L * sector_width_deg};
}

/// Returns whole cm, rounded down. Distances are whole mm; what is added is less, and more than the error of a double.
long whole_cm(double metres) {
    return static_cast<long>(std::floor(metres * 100 + 1e-6));
}

bool is_free(const ScanSector& sector, const DistanceLimits& limits) {
    const bool known = sector.state == SectorState::free || sector.state == SectorState::occupied;
    return known && whole_cm(sector.free_m) >= limits.max_cm;
}

/// Returns the obstacle's distance in cm, or nothing when the sector shows none within the limits. One of which only
/// the most that its distance can be is known may lie within them, whatever that is.
std::optional<std::uint16_t> obstacle_cm(const ScanSector& sector, const DistanceLimits& limits) {
    const long cm = whole_cm(sector.distance_m);
    if (sector.state != SectorState::occupied || (cm > limits.max_cm && !sector.is_near())) {
        return std::nullopt;
    }
    return static_cast<std::uint16_t>(std::clamp<long>(cm, limits.min_cm, limits.max_cm));
}

/// Returns what two intervals share, with `other` moved by whole circles to where they meet; one that goes all around
/// may meet the first one twice.
std::vector<Interval> shared(const Interval& interval, const Interval& other) {
    std::vector<Interval> parts;
    for (long shift = -2 * circle; shift <= 2 * circle; shift += circle) {
        const Interval part{std::max(interval.first, other.first + shift),
                            std::min(interval.second, other.second + shift)};
        if (part.first < part.second) {
            parts.push_back(part);
        }
    }
    return parts;
}

/// Whether the parts cover the interval without a gap.
bool cover(std::vector<Interval> parts, const Interval& interval) {
    std::sort(parts.begin(), parts.end());
    long covered_to = interval.first;
    for (const Interval& part : parts) {
        if (part.first > covered_to) {
            return false;
        }
        covered_to = std::max(covered_to, part.second);
    }
    return covered_to >= interval.second;
}

/// Returns what is sent of it: where hidden space counts as an obstacle, how far the way to it is free.
std::uint16_t blocked_cm(const ScanSector& sector, std::uint16_t obstacle, const DistanceLimits& limits) {
    const long free = limits.hidden_as_obstacle ? whole_cm(sector.free_m) : obstacle;
    return static_cast<std::uint16_t>(std::clamp<long>(free, limits.min_cm, obstacle));
}

std::uint16_t distance_in(const Interval& interval, const disparity::Scan& scan, const DistanceLimits& limits) {
    std::optional<std::uint16_t> nearest;
    bool all_free = true;
    std::vector<Interval> parts;
    for (const ScanSector& sector : scan.sectors) {
        const std::vector<Interval> met = shared(interval, bearings(sector));
        if (met.empty()) {
            continue;
        }
        parts.insert(parts.end(), met.begin(), met.end());
        if (const auto cm = obstacle_cm(sector, limits)) {
            const std::uint16_t blocked = blocked_cm(sector, *cm, limits);
            nearest = std::min(nearest.value_or(blocked), blocked);
        }
        all_free = all_free && is_free(sector, limits);
    }
    if (nearest) {
        return *nearest;
    }
    return all_free && cover(std::move(parts), interval) ? limits.free_cm() : unknown_cm;
}

/// Where an obstacle is, from the camera in m: x ahead, y right, z down.
struct Place {
    double x = 0;
    double y = 0;
    double z = 0;

    double distance() const { return std::hypot(x, y, z); }
};

/// Returns the place moved along its direction into the limits. A millimetre is left on both sides: receivers compute
/// the distance from rounded coordinates.
Place within(const Place& place, const DistanceLimits& limits) {
    const double distance = place.distance();
    const double wanted = std::clamp(distance, limits.min_cm / 100.0 + 0.001, limits.max_cm / 100.0 - 0.001);
    const double scale = wanted / distance;
    return {place.x * scale, place.y * scale, place.z * scale};
}

Place place_of(const ScanSector& sector, const DistanceLimits& limits, std::optional<double> camera_height_m) {
    const double bearing = (sector.from_deg + sector.to_deg) / 2 * std::numbers::pi / 180;
    const double horizontal = std::max(sector.distance_m, limits.min_cm / 100.0);
    const double low = std::min(sector.low_m, sector.high_m);
    const double high = std::max(sector.low_m, sector.high_m);
    const double down = camera_height_m ? *camera_height_m - std::clamp(*camera_height_m, low, high) : 0;
    return within({horizontal * std::cos(bearing), -horizontal * std::sin(bearing), down}, limits);
}

Message obstacle_3d(const Place& place, const DistanceLimits& limits, std::uint32_t time_ms) {
    constexpr std::uint16_t no_id = 0xffff;  // it is not followed from scan to scan
    Message message{obstacle_distance_3d_kind, {}};
    PayloadWriter(message.payload)
        .u32(time_ms)
        .f32(static_cast<float>(place.x))
        .f32(static_cast<float>(place.y))
        .f32(static_cast<float>(place.z))
        .f32(static_cast<float>(limits.min_cm) / 100)
        .f32(static_cast<float>(limits.max_cm) / 100)
        .u16(no_id)
        .u8(sensor_type)
        .u8(body_frd);
    return message;
}

}  // namespace

SectorDistances sector_distances(const disparity::Scan& scan, const DistanceLimits& limits) {
    SectorDistances distances{};
    for (std::size_t i = 0; i < distances.size(); ++i) {
        distances[i] = distance_in(bearings(i), scan, limits);
    }
    return distances;
}

Message obstacle_distance(const SectorDistances& distances, const DistanceLimits& limits, std::uint64_t time_us) {
    Message message{obstacle_distance_kind, {}};
    PayloadWriter writer(message.payload);
    writer.u64(time_us);
    for (const std::uint16_t cm : distances) {
        writer.u16(cm);
    }
    writer.u16(limits.min_cm)
        .u16(limits.max_cm)
        .u8(sensor_type)
        .u8(sector_width_deg)
        .f32(sector_width_deg)
        .f32(0)  // angle_offset
        .u8(body_frd);
    return message;
}

std::vector<Message> obstacles_3d(const disparity::Scan& scan, const DistanceLimits& limits,
                                  std::optional<double> camera_height_m, std::uint32_t time_ms) {
    std::vector<Place> places;
    for (const ScanSector& sector : scan.sectors) {
        if (obstacle_cm(sector, limits)) {
            places.push_back(place_of(sector, limits, camera_height_m));
        }
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const Place& a, const Place& b) { return a.distance() < b.distance(); });
    std::vector<Message> messages;
    messages.reserve(places.size());
    for (const Place& place : places) {
        messages.push_back(obstacle_3d(place, limits, time_ms));
    }
    return messages;
}

}  // namespace disparityd::mavlink
