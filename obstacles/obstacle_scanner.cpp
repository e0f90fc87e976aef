// SPDX-License-Identifier: Apache-2.0
#include "obstacles/obstacle_scanner.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "obstacles/gravity_ground.h"

namespace disparityd {
namespace {

/// A plane that was fitted holds for so many frames without ground.
constexpr int hold_frames = 30;
/// Planes that differ by less are the same ground, measured twice: their mean has less noise.
constexpr double same_height_m = 0.02;
constexpr double same_slope = 0.0175;

/// One frame of so many is asked for the floor: a mounting changes rarely.
constexpr int floor_every = 8;
/// A mounting that differs by less is not worth new tables.
constexpr double same_mounting_m = 0.01;
constexpr double same_mounting_deg = 0.5;

const ScanOptions& checked(const ScanOptions& options) {
    if (const std::string wrong = validate(options); !wrong.empty()) {
        throw std::invalid_argument(wrong);
    }
    return options;
}

bool same(const GroundPlane& a, const GroundPlane& b) {
    return std::abs(a.height_m - b.height_m) < same_height_m && std::abs(a.slope_ahead - b.slope_ahead) < same_slope &&
           std::abs(a.slope_left - b.slope_left) < same_slope;
}

GroundPlane mean(const GroundPlane& a, const GroundPlane& b) {
    return {(a.height_m + b.height_m) / 2, (a.slope_ahead + b.slope_ahead) / 2, (a.slope_left + b.slope_left) / 2};
}

}  // namespace

ObstacleScanner::ObstacleScanner(int width, int height, const ScanOptions& options, const FrameSteps& steps,
                                 ImageMask mask)
    : steps_(steps),
      options_(checked(options)),
      mask_(std::move(mask)),
      shift_(scan::is_shifted(options) ? std::optional<scan::OriginShift>(options) : std::nullopt),
      geometry_(width, height, shift_ ? shift_->camera_options() : options),
      band_(width, height),
      counts_(geometry_.sectors(), geometry_.groups(), width),
      decision_(geometry_),
      drop_sectors_(geometry_),
      near_sectors_(geometry_),
      sector_doubts_(geometry_),
      camera_sectors_(shift_ ? static_cast<std::size_t>(geometry_.sectors()) : 0) {}

Scan ObstacleScanner::empty_scan() const {
    Scan scan;
    scan.sectors.resize(static_cast<std::size_t>(options_.sectors));
    return scan;
}

void ObstacleScanner::scan(const scan::Pixels& pixels, const scan::Camera& camera, Scan& scan,
                           const std::optional<CameraDirection>& up, const scan::NearBlocks& near,
                           const scan::Sight& sight) {
    if (sight.notes != nullptr) {
        sight.notes->near_blocks.reset();
    }
    if (!(camera == geometry_.camera())) {
        geometry_.set(camera);
        follow_geometry();
    }
    find_mounting(pixels, camera, scan);
    if (!camera.metric() || (options_.find_mounting && !mounted_)) {
        tell_nothing(scan);
        return;
    }
    find_ground(pixels, up, scan);
    if (options_.ground == GroundMode::autopilot && scan.ground_source != GroundSource::autopilot) {
        tell_nothing(scan);
        return;
    }
    if (band_ground_ != scan.ground) {
        band_.set(geometry_, scan.ground);
        band_ground_ = scan.ground;
    }
    std::vector<ScanSector>& sectors = shift_ ? camera_sectors_ : scan.sectors;
    const scan::CountTables tables = scan::count_tables(geometry_, band_);
    steps_.scan_counts(pixels, tables, counts_);
    decision_.decide(pixels, geometry_, scan.ground, counts_, sectors);
    drop_sectors_.add(pixels, geometry_, tables, scan.ground, sectors);
    near_sectors_.add(near, geometry_, tables, scan.ground, sectors);
    sector_doubts_.add(pixels, sight, geometry_, sectors);
    if (sight.notes != nullptr) {
        sight.notes->near_blocks = near_sectors_.blocks();
    }
    if (!shift_) {
        return;
    }
    shift_->move(camera_sectors_, scan.sectors);
    scan.ground.height_m -=
        scan.ground.slope_ahead * options_.camera_ahead_m + scan.ground.slope_left * options_.camera_left_m;
}

void ObstacleScanner::tell_nothing(Scan& scan) {
    scan.ground_source = GroundSource::configured;
    scan.ground_age = 0;
    scan.ground = {};
    std::fill(scan.sectors.begin(), scan.sectors.end(), ScanSector{});
}

/// Computes what follows from the geometry.
void ObstacleScanner::follow_geometry() {
    decision_.set(geometry_, mask_);
    ground_fit_.set(geometry_);
    band_ground_.reset();
}

/// Looks for the floor in some of the frames, and takes the mounting that they show where it is asked for.
void ObstacleScanner::find_mounting(const scan::Pixels& pixels, const scan::Camera& camera, Scan& scan) {
    if (camera.metric() && --frames_until_floor_ < 0) {
        frames_until_floor_ = floor_every - 1;
        mounting_watch_.add(floor_finder_.find(pixels, camera, options_.subpixel_error_px));
    }
    scan.mounting = mounting_watch_.found();
    if (!options_.find_mounting || !scan.mounting || !scan::is_usable(*scan.mounting, options_) ||
        (mounted_ && scan::is_near(*scan.mounting, *mounted_, same_mounting_m, 0, same_mounting_deg))) {
        return;
    }
    mounted_ = scan.mounting;
    geometry_.mount(*mounted_);
    follow_geometry();
    ground_.reset();
}

void ObstacleScanner::find_ground(const scan::Pixels& pixels, const std::optional<CameraDirection>& up, Scan& scan) {
    scan.ground_source = GroundSource::configured;
    scan.ground_age = 0;
    scan.ground = {};
    switch (geometry_.options().ground) {
        case GroundMode::configured: break;
        case GroundMode::fitted: fit_ground(pixels, scan); break;
        case GroundMode::gravity:
        case GroundMode::autopilot:
            if (const auto level = up ? scan::level_ground(*up, geometry_.options()) : std::nullopt) {
                scan.ground_source =
                    options_.ground == GroundMode::gravity ? GroundSource::gravity : GroundSource::autopilot;
                scan.ground = *level;
            }
            break;
    }
}

void ObstacleScanner::fit_ground(const scan::Pixels& pixels, Scan& scan) {
    if (const auto fitted = ground_fit_.fit(pixels, geometry_, ground_.value_or(GroundPlane{}))) {
        ground_ = ground_ && same(*fitted, *ground_) ? mean(*fitted, *ground_) : *fitted;
        ground_age_ = 0;
        scan.ground_source = GroundSource::fitted;
    } else if (ground_ && ground_age_ < hold_frames) {
        ++ground_age_;
        scan.ground_source = GroundSource::held;
    } else {
        ground_.reset();
        return;
    }
    scan.ground_age = ground_age_;
    scan.ground = *ground_;
}

}  // namespace disparityd
