// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "tools/ctl/describe.h"

/// Turns a scan that has arrived into text and JSON.
namespace disparityd::tools {

/// A frame with its scan, and what is known of its arrival.
struct ScanReading {
    disparity::FrameInfo frame;
    disparity::Scan scan;
    std::int64_t age_ns = 0;
    std::optional<double> rate;  ///< scans that arrive here in a second
};

/// What a scan shows in short.
struct ScanSummary {
    std::optional<disparity::ScanSector> nearest;  ///< the sector with the nearest obstacle
    double free = 0;                               ///< shares of the sectors, 0 .. 1
    double occupied = 0;
    double unknown = 0;
    double doubtful = 0;  ///< with a doubt of their own, whatever they show
};
ScanSummary summary_of(const disparity::Scan& scan);

/// Returns the middle of a sector in degrees, to hundredths; left is positive.
double bearing_of(const disparity::ScanSector& sector);

/// Returns what the reading says, in short parts for people.
std::vector<std::string> scan_parts(const ScanReading& reading);

/// Joins parts with commas. A line has at most `columns` bytes, unless a part alone has more: it is cut.
std::vector<std::string> wrapped(const std::vector<std::string>& parts, int columns);

/// Returns the heading of lines, the line of a reading, and that of an interval without one.
std::string scan_heading();
std::string scan_line(const ScanReading& reading);
std::string no_scan_line(const std::string& why);

/// Returns one object for a reading, and for an interval without one. docs/operations.md explains the fields.
Json scan_json(const ScanReading& reading);
Json no_scan_json(const std::string& why);

}  // namespace disparityd::tools
