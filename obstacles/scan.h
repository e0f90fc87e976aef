// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "proto/scan.h"

namespace disparityd {

// A scan is made as it is sent.
using proto::GroundSource;
using proto::ScanSector;
using proto::SectorState;

/// A plane z = height_m + slope_ahead x + slope_left y. x is ahead, y left, z up; of a finished scan, the origin is the
/// robot's, before that it is on the ground below the camera.
struct GroundPlane {
    double height_m = 0;
    double slope_ahead = 0;
    double slope_left = 0;

    friend bool operator==(const GroundPlane&, const GroundPlane&) = default;
};

/// A direction along the axes of the left camera's image, of length 1.
struct CameraDirection {
    double right = 0;
    double down = 0;
    double ahead = 0;

    friend bool operator==(const CameraDirection&, const CameraDirection&) = default;
};

/// How the left camera is mounted above the floor, in the words of ScanOptions.
struct Mounting {
    double height_m = 0;
    double pitch_deg = 0;
    double roll_deg = 0;

    friend bool operator==(const Mounting&, const Mounting&) = default;
};

/// What an obstacle scan has found in one frame.
struct Scan {
    GroundSource ground_source = GroundSource::configured;
    int ground_age = 0;  ///< frames since the plane was fitted
    GroundPlane ground;
    std::optional<Mounting> mounting;  ///< that the floor of this frame and the ones before it shows
    std::vector<ScanSector> sectors;   ///< by bearing, the right-most first
};

}  // namespace disparityd
