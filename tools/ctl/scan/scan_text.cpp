// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/message_text.h"
#include "clients/json/scan_json.h"
#include "proto/doubt.h"
#include "tools/command_line/table.h"

namespace disparityd::tools {
namespace {

using json::ground_word;

constexpr double second_ns = 1e9;

bool has_metres(const ScanReading& reading) {
    return reading.frame.f > 0 && reading.frame.baseline_mm > 0;
}

std::string age_text(const ScanReading& reading) {
    const double seconds = static_cast<double>(reading.age_ns) / second_ns;
    return seconds < 1 ? fixed(1000 * seconds, 0) + " ms" : fixed(seconds, 1) + " s";
}

std::string percent(double share) {
    return fixed(100 * share, 0) + " %";
}

/// Returns the words of the doubts that any sector has.
std::string sector_doubts(const disparity::Scan& scan) {
    std::uint32_t doubts = 0;
    for (const disparity::ScanSector& sector : scan.sectors) {
        doubts |= sector.doubts;
    }
    return proto::doubt_names(doubts);
}

std::string bearing_text(const disparity::ScanSector& sector) {
    const double bearing = bearing_of(sector);
    const std::string degrees = fixed(std::abs(bearing), 0);
    return degrees == "0" ? "ahead" : degrees + " deg " + (bearing > 0 ? "left" : "right");
}

std::string ground_text(const disparity::Scan& scan) {
    const std::string word = std::string("ground ") + ground_word(scan.ground);
    return scan.ground == disparity::GroundSource::held ? word + " from " + std::to_string(scan.ground_age) +
                                                              (scan.ground_age == 1 ? " frame ago" : " frames ago")
                                                        : word;
}

std::string mounting_text(const disparity::Mounting& mounting) {
    return "floor seen from " + fixed(mounting.height_m, 2) + " m, pitch " + fixed(mounting.pitch_deg, 1) + ", roll " +
           fixed(mounting.roll_deg, 1);
}

Json nearest_json(const ScanSummary& summary) {
    if (!summary.nearest) {
        return {};
    }
    return {{"distance_m", summary.nearest->distance_m},
            {"bearing_deg", bearing_of(*summary.nearest)},
            {"low_m", summary.nearest->low_m},
            {"high_m", summary.nearest->high_m}};
}

}  // namespace

ScanSummary summary_of(const disparity::Scan& scan) {
    ScanSummary summary;
    int free = 0;
    int occupied = 0;
    int doubtful = 0;
    for (const disparity::ScanSector& sector : scan.sectors) {
        free += sector.state == disparity::SectorState::free ? 1 : 0;
        occupied += sector.state == disparity::SectorState::occupied ? 1 : 0;
        if (sector.state == disparity::SectorState::occupied &&
            (!summary.nearest || sector.distance_m < summary.nearest->distance_m)) {
            summary.nearest = sector;
        }
        doubtful += sector.doubts != 0 ? 1 : 0;
    }
    const int all = static_cast<int>(scan.sectors.size());
    if (all > 0) {
        summary.free = static_cast<double>(free) / all;
        summary.occupied = static_cast<double>(occupied) / all;
        summary.doubtful = static_cast<double>(doubtful) / all;
        summary.unknown = static_cast<double>(all - free - occupied) / all;
    }
    return summary;
}

double bearing_of(const disparity::ScanSector& sector) {
    return std::round(50 * (sector.from_deg + sector.to_deg)) / 100;  // edges have hundredths
}

std::vector<std::string> scan_parts(const ScanReading& reading) {
    const ScanSummary seen = summary_of(reading.scan);
    std::vector<std::string> parts{
        "frame " + std::to_string(reading.frame.sequence),
        (static_cast<double>(reading.age_ns) < second_ns ? "age " : "OLD: ") + age_text(reading)};
    parts.push_back((reading.rate ? fixed(*reading.rate, 1) : "-") + "/s");
    if (!has_metres(reading)) {
        parts.emplace_back("no calibration: nothing is known");
    } else if (seen.nearest) {
        const std::string at_most = seen.nearest->is_near() ? "at most " : "";
        parts.push_back("nearest " + at_most + fixed(seen.nearest->distance_m, 2) + " m " +
                        bearing_text(*seen.nearest));
        parts.push_back(fixed(seen.nearest->low_m, 2) + " to " + fixed(seen.nearest->high_m, 2) + " m high");
    } else {
        parts.emplace_back("no obstacle seen");
    }
    parts.push_back(percent(seen.free) + " free");
    parts.push_back(percent(seen.unknown) + " unknown");
    if (const std::string doubts = sector_doubts(reading.scan); !doubts.empty()) {
        parts.push_back(percent(seen.doubtful) + " in doubt: " + doubts);
    }
    parts.push_back(ground_text(reading.scan));
    if (reading.scan.mounting) {
        parts.push_back(mounting_text(*reading.scan.mounting));
    }
    if ((reading.frame.flags & disparity::FrameFlags::synthetic) != 0) {
        parts.emplace_back("synthetic");
    }
    if (const std::string doubts = proto::doubt_names(reading.frame.flags); !doubts.empty()) {
        parts.push_back("DOUBTS: " + doubts);
    }
    return parts;
}

std::vector<std::string> wrapped(const std::vector<std::string>& parts, int columns) {
    const auto most = static_cast<std::size_t>(std::max(columns, 4));
    std::vector<std::string> lines;
    for (const std::string& part : parts) {
        const std::string text = base::printable(part, most);
        if (!lines.empty() && lines.back().size() + 3 + text.size() <= most) {  // with the comma behind it
            lines.back() += ", " + text;
        } else {
            if (!lines.empty()) {
                lines.back() += ',';
            }
            lines.push_back(text);
        }
    }
    return lines;
}

std::string scan_heading() {
    return "    frame     age  scans/s  nearest  bearing         height  free  occupied  unknown  ground";
}

std::string scan_line(const ScanReading& reading) {
    const ScanSummary seen = summary_of(reading.scan);
    std::string distance = "-", bearing = "-", height = "-";
    if (seen.nearest) {
        distance = fixed(seen.nearest->distance_m, 2) + " m";
        bearing = fixed(bearing_of(*seen.nearest), 1);
        height = fixed(seen.nearest->low_m, 2) + " to " + fixed(seen.nearest->high_m, 2);
    }
    char text[200];
    std::snprintf(text, sizeof text, "%9llu %7s %8s %8s %8s %14s %5s %9s %8s  %s%s%s",
                  static_cast<unsigned long long>(reading.frame.sequence), age_text(reading).c_str(),
                  reading.rate ? fixed(*reading.rate, 1).c_str() : "-", distance.c_str(), bearing.c_str(),
                  height.c_str(), percent(seen.free).c_str(), percent(seen.occupied).c_str(),
                  percent(seen.unknown).c_str(), ground_word(reading.scan.ground),
                  has_metres(reading) ? "" : ", no calibration",
                  (reading.frame.flags & disparity::FrameFlags::synthetic) != 0 ? ", synthetic" : "");
    const std::string doubts = proto::doubt_names(reading.frame.flags);
    const std::string of_sectors = sector_doubts(reading.scan);
    return text + (doubts.empty() ? "" : ", " + doubts) +
           (of_sectors.empty() ? "" : ", " + percent(seen.doubtful) + " of the sectors: " + of_sectors);
}

std::string no_scan_line(const std::string& why) {
    return "no scan: " + why;
}

Json scan_json(const ScanReading& reading) {
    const ScanSummary seen = summary_of(reading.scan);
    Json json{{"sequence", reading.frame.sequence},
              {"monotonic_ns", reading.frame.monotonic_ns},
              {"realtime_ns", reading.frame.realtime_ns},
              {"age_ms", static_cast<double>(reading.age_ns) / 1e6},
              {"scans_per_second", reading.rate ? Json(*reading.rate) : Json()},
              {"dropped", reading.frame.dropped_before},
              {"skipped", reading.frame.skipped},
              {"calibrated", has_metres(reading)},
              {"synthetic", (reading.frame.flags & disparity::FrameFlags::synthetic) != 0},
              {"trust", disparity::trust_of(reading.frame.flags)},
              {"doubts", json::doubts_json(reading.frame.flags)},
              {"nearest", nearest_json(seen)},
              {"free", seen.free},
              {"occupied", seen.occupied},
              {"unknown", seen.unknown},
              {"doubtful", seen.doubtful}};
    json.update(json::to_json(reading.scan));
    return json;
}

Json no_scan_json(const std::string& why) {
    return {{"sequence", nullptr}, {"why", why}};
}

}  // namespace disparityd::tools
