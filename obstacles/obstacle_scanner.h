// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernels/scan_counts.h"
#include "kernels/steps.h"
#include "obstacles/band.h"
#include "obstacles/drop_sectors.h"
#include "obstacles/floor_finder.h"
#include "obstacles/ground_fit.h"
#include "obstacles/image_mask.h"
#include "obstacles/near_sectors.h"
#include "obstacles/origin_shift.h"
#include "obstacles/scan.h"
#include "obstacles/scan_geometry.h"
#include "obstacles/scan_options.h"
#include "obstacles/sector_decision.h"
#include "obstacles/sector_doubts.h"

namespace disparityd {

/// Makes an obstacle scan of each frame: step 14 of docs/algorithm.md. One thread at a time; it remembers the ground's
/// plane from frame to frame. All memory is allocated by the constructor.
class ObstacleScanner {
public:
    /// `steps`: those of a back end, or of the reference; it outlives this. Throws std::invalid_argument with
    /// validate()'s line for bad options. The mask is of that size, or empty: what masked pixels
    /// hide is not known. A frame has them rejected already.
    ObstacleScanner(int width, int height, const ScanOptions& options, const FrameSteps& steps, ImageMask mask = {});

    /// Fills in all of `scan`, which was made by empty_scan(). A camera without a focal length or baseline gives a scan
    /// in which every sector is unknown. Planes have the configured size; interpolated pixels have confidence 0.
    /// `up`: where up is at that time, for GroundMode::gravity and autopilot; without it, the configured ground is
    /// taken for the first one, and every sector is unknown for the other. `near`: what the near guard has found, where
    /// it is on. `sight`: the frame's left image, and what the stages tell each other.
    void scan(const scan::Pixels& pixels, const scan::Camera& camera, Scan& scan,
              const std::optional<CameraDirection>& up = std::nullopt, const scan::NearBlocks& near = {},
              const scan::Sight& sight = {});

    Scan empty_scan() const;

    const ScanOptions& options() const { return options_; }

private:
    void tell_nothing(Scan& scan);
    void find_mounting(const scan::Pixels& pixels, const scan::Camera& camera, Scan& scan);
    void follow_geometry();
    void find_ground(const scan::Pixels& pixels, const std::optional<CameraDirection>& up, Scan& scan);
    void fit_ground(const scan::Pixels& pixels, Scan& scan);

    const FrameSteps& steps_;
    ScanOptions options_;
    ImageMask mask_;
    std::optional<scan::OriginShift> shift_;  ///< where the camera is not above the robot's origin
    scan::Geometry geometry_;
    scan::Band band_;
    scan::Counts counts_;
    scan::GroundFit ground_fit_;
    scan::SectorDecision decision_;
    scan::DropSectors drop_sectors_;
    scan::NearSectors near_sectors_;
    scan::SectorDoubts sector_doubts_;
    scan::FloorFinder floor_finder_;
    scan::MountingWatch mounting_watch_;
    int frames_until_floor_ = 0;              ///< that are not asked for the floor
    std::optional<Mounting> mounted_;         ///< of geometry_, where it was found
    std::vector<ScanSector> camera_sectors_;  ///< around the camera, for shift_
    std::optional<GroundPlane> band_ground_;  ///< of band_, where that is computed
    std::optional<GroundPlane> ground_;       ///< the plane of the frame before, where one was fitted
    int ground_age_ = 0;                      ///< frames since it was fitted
};

}  // namespace disparityd
