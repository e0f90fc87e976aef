// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// The bytes of the product SCAN: one ScanHead, then ScanHead::sectors times ScanSector, little endian, without gaps.
/// docs/protocol.md gives the offsets to other languages; step 14 of docs/algorithm.md says how the values come about.
/// The scanner of obstacles/ writes these structures, the client library reads them. A reader takes numbers that the
/// enums do not have, too: a later daemon may send them.
///
/// The frame of reference is the robot's: x ahead, y left, z up, the origin on the ground below the camera, or where
/// the configuration puts it. A bearing is counted from x towards y, so that left is positive; distances are
/// horizontal, from the origin.
namespace disparityd::proto {

inline constexpr std::uint16_t scan_version = 2;
inline constexpr std::uint32_t scan_max_sectors = 360;
/// Doubts of a sector leave out the bits of Frame.flags below the first doubt.
inline constexpr unsigned scan_doubt_shift = 8;

enum class SectorState : std::uint8_t {
    unknown = 0,   ///< nothing is known beyond free_mm, which is less than the scan's least distance
    free = 1,      ///< no obstacle up to free_mm; what lies beyond is unknown
    occupied = 2,  ///< the nearest obstacle is at distance_mm
    masked = 3,    ///< unknown: the robot's own parts hide all of it; free_mm is 0
};

enum class GroundSource : std::uint8_t {
    configured = 0,  ///< the plane z = 0 of the configured mounting
    fitted = 1,      ///< fitted to this frame
    held = 2,        ///< fitted to an earlier frame, ground_age frames ago; this one shows too little ground
    gravity = 3,     ///< level, as the camera's inertial sensor says
    autopilot = 4,   ///< level, as an autopilot says
};

struct ScanHead {
    std::uint16_t version;  ///< scan_version
    std::uint16_t sectors;  ///< 1 .. scan_max_sectors
    GroundSource ground;
    std::uint8_t reserved;  ///< 0
    std::uint16_t ground_age;
    std::int16_t ground_mm;            ///< height of the ground's plane at the origin
    std::int16_t ground_slope_ahead;   ///< of the plane along x, in 1/10000
    std::int16_t ground_slope_left;    ///< along y
    std::int16_t low_mm;               ///< obstacles are what lies between these heights above the ground's plane
    std::int16_t high_mm;              ///< the upper one
    std::uint16_t min_mm;              ///< the smallest distance that the scan reports
    std::uint16_t max_mm;              ///< the largest one; farther obstacles and freedom are cut there
    std::uint16_t mounting_height_mm;  ///< of the camera above the floor, as the floor in view shows; 0: not found
    std::int16_t mounting_pitch_cdeg;  ///< likewise, 1/100 degree
    std::int16_t mounting_roll_cdeg;
    std::uint16_t reserved_words[2];  ///< 0
};

/// Ordered by bearing, the right-most first; sectors may leave gaps.
struct ScanSector {
    std::int16_t from_cdeg = 0;  ///< the right edge, 1/100 degree
    std::int16_t to_cdeg = 0;    ///< the left edge
    SectorState state = SectorState::unknown;
    /// Mean of the obstacle's pixels, as the product CONFIDENCE; 0 where none is reported.
    std::uint8_t confidence = 0;
    std::uint16_t distance_mm = 0;  ///< to the nearest obstacle; 0 where none is reported
    std::uint16_t sigma_mm = 0;     ///< one-sigma error of that distance
    /// There is no obstacle nearer than this: 0 .. max_mm. Of an occupied sector it is at most distance_mm, and less
    /// where something may hide in front of the obstacle.
    std::uint16_t free_mm = 0;
    std::int16_t low_mm = 0;   ///< the obstacle's lowest part above the ground's plane, within the band
    std::int16_t high_mm = 0;  ///< its highest part
    /// Pixels that show the obstacle; 65535 = so many or more. 0 in an occupied sector: it is nearer than can be
    /// measured, distance_mm is the most that it can be, and sigma_mm is as large.
    std::uint16_t pixels = 0;
    std::uint16_t doubts = 0;   ///< why it can be trusted less: bits of Doubt, divided by 1 << scan_doubt_shift
    std::uint8_t trust = 0;     ///< 1 .. 255, more is better; 0: not told
    std::uint8_t reserved = 0;  ///< 0

    friend bool operator==(const ScanSector&, const ScanSector&) = default;
};

static_assert(sizeof(ScanHead) == 32 && sizeof(ScanSector) == 22, "docs/protocol.md gives the sizes");

/// The bytes of a scan.
constexpr std::size_t scan_bytes(std::size_t sectors) {
    return sizeof(ScanHead) + sectors * sizeof(ScanSector);
}

}  // namespace disparityd::proto
