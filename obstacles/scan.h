// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace disparityd {

enum class SectorState : std::uint8_t { unknown = 0, free = 1, occupied = 2 };

/// One sector of a scan. Distances are horizontal, from the origin, in mm.
struct ScanSector {
    std::int16_t from_cdeg = 0;  ///< bearing of the right edge, 1/100 degree, left positive
    std::int16_t to_cdeg = 0;    ///< of the left edge
    SectorState state = SectorState::unknown;
    std::uint8_t confidence = 0;    ///< mean of the obstacle's pixels; 0 where none is reported
    std::uint16_t distance_mm = 0;  ///< to the nearest obstacle; 0 where none is reported
    std::uint16_t sigma_mm = 0;     ///< one-sigma error of that distance
    std::uint16_t free_mm = 0;      ///< no obstacle is nearer; at most distance_mm where there is one
    std::int16_t low_mm = 0;        ///< the obstacle's lowest part above the ground's plane
    std::int16_t high_mm = 0;       ///< its highest part
    std::uint16_t pixels = 0;       ///< that show the obstacle; 65535 = so many or more

    friend bool operator==(const ScanSector&, const ScanSector&) = default;
};

/// A plane z = height_m + slope_ahead x + slope_left y. x is ahead, y left, z up; of a finished scan, the origin is the
/// robot's, before that it is on the ground below the camera.
struct GroundPlane {
    double height_m = 0;
    double slope_ahead = 0;
    double slope_left = 0;

    friend bool operator==(const GroundPlane&, const GroundPlane&) = default;
};

enum class GroundSource : std::uint8_t {
    configured = 0,  ///< the plane z = 0
    fitted = 1,      ///< fitted to this frame
    held = 2,        ///< fitted to an earlier frame
    gravity = 3,     ///< level, as the camera's inertial sensor says
};

/// A direction along the axes of the left camera's image, of length 1.
struct CameraDirection {
    double right = 0;
    double down = 0;
    double ahead = 0;

    friend bool operator==(const CameraDirection&, const CameraDirection&) = default;
};

/// What an obstacle scan has found in one frame.
struct Scan {
    GroundSource ground_source = GroundSource::configured;
    int ground_age = 0;  ///< frames since the plane was fitted
    GroundPlane ground;
    std::vector<ScanSector> sectors;  ///< by bearing, the right-most first
};

}  // namespace disparityd
