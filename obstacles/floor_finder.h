// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kernels/scan_counts.h"
#include "obstacles/plane_search.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// Finds the floor in one frame without being told where to look: step 14 of docs/algorithm.md, the part "Mounting".
/// The same input gives the same result. All memory is allocated by the constructor.
class FloorFinder {
public:
    /// Returns the mounting that the largest plane below the camera stands for; nothing where there is none, or where
    /// much lies below it.
    std::optional<Mounting> find(const Pixels& pixels, const Camera& camera, double subpixel_error_px);

private:
    PlaneSearch search_;
};

/// Joins what the floor of many frames says of the mounting. One thread.
class MountingWatch {
public:
    /// Takes the next frame of which find() was asked.
    void add(const std::optional<Mounting>& seen);

    /// Returns the mean of the last frames that agreed, where there were enough of them one after the other; until the
    /// next such ones, what was found before holds.
    const std::optional<Mounting>& found() const { return found_; }

private:
    Mounting mean_;
    int agreeing_ = 0;  ///< frames in mean_
    std::optional<Mounting> found_;
};

/// Returns whether a mounting is within `height_m`, or `height_share` of its height, and `angle_deg` of another one.
bool is_near(const Mounting& mounting, const Mounting& other, double height_m, double height_share, double angle_deg);

/// Returns whether a scan can be made with this mounting: one that is found below the band's lower end has no ground.
bool is_usable(const Mounting& mounting, const ScanOptions& options);

/// Returns one line for people where the floor contradicts the mounting of these options, or where the mounting is to
/// be found and is not; else an empty text.
std::string mounting_notice(const std::optional<Mounting>& found, const ScanOptions& options);

}  // namespace disparityd::scan
