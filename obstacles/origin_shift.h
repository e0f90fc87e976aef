// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "obstacles/scan.h"
#include "obstacles/scan_options.h"

namespace disparityd::scan {

/// Returns whether the camera is not above the robot's origin.
bool is_shifted(const ScanOptions& options);

/// Turns a scan around the camera into one around the robot's origin: step 14 of docs/algorithm.md, the part "Origin".
/// Memory is allocated by the constructor only.
class OriginShift {
public:
    explicit OriginShift(const ScanOptions& options);

    /// Returns the options of the scan around the camera: wider, nearer and farther by what the origin is away.
    const ScanOptions& camera_options() const { return camera_options_; }

    /// Fills in the sectors around the origin from those around the camera, which lie next to each other.
    void move(std::span<const ScanSector> camera_sectors, std::span<ScanSector> sectors);

private:
    /// On the ground, from the robot's origin or without one, mm.
    struct Point {
        double ahead = 0;
        double left = 0;
    };
    /// A part of the ground that begins at the camera, at most a quarter turn wide, with what its sector knows.
    struct Cone {
        Point right;  ///< its edges' directions
        Point left;
        double free_mm = 0;
        bool seen = false;  ///< the image shows something of it
    };
    /// What is known of a sector around the origin.
    struct Found {
        double free_mm = 0;
        double obstacle_mm = 0;    ///< where there is one
        int obstacle = -1;         ///< camera sector of the nearest; -1: none
        std::uint16_t doubts = 0;  ///< of all obstacles in it
        std::uint8_t trust = 0;    ///< the least of them; 0: none tells it
    };

    void set_edges(std::span<const ScanSector> camera_sectors, std::span<ScanSector> sectors);
    void make_cones(std::span<const ScanSector> camera_sectors);
    void add_cones(double from_deg, double to_deg, double free_mm);
    std::optional<double> blocked_at(const Cone& cone, const Point& direction) const;
    double free_along(double bearing_deg) const;
    void find_free();
    void block(const Point& point, double min_mm);
    void block_corners(const Cone& cone);
    void find_obstacle(const ScanSector& obstacle, int camera_sector);
    void find_doubts(std::span<const ScanSector> camera_sectors, int sector, double end_mm, ScanSector& out) const;
    void put(std::span<const ScanSector> camera_sectors, std::span<ScanSector> sectors) const;

    ScanOptions options_;
    ScanOptions camera_options_;
    int more_ = 0;  ///< camera sectors to the right of the first sector around the origin
    Point camera_;
    double least_mm_;
    double most_mm_;
    double asked_from_mm_;  ///< what is nearer and not in the image is not asked for
    double from_deg_ = 0;   ///< of the sectors around the origin
    double width_deg_ = 0;  ///< of one
    std::vector<Cone> cones_;
    std::vector<Found> found_;
};

}  // namespace disparityd::scan
