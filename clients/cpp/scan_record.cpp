// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/scan_record.h"

#include <cstring>
#include <stdexcept>
#include <string>

#include "proto/scan.h"

namespace disparity {
namespace {

namespace proto = disparityd::proto;

/// An unsigned or signed number of millimetres in metres.
template <typename T>
double metres(T millimetres) {
    return millimetres / 1000.0;
}

Scan scan_of(const proto::ScanHead& head) {
    Scan scan;
    scan.ground = static_cast<GroundSource>(head.ground);
    scan.ground_age = head.ground_age;
    scan.ground_height_m = metres(head.ground_mm);
    scan.ground_slope_ahead = head.ground_slope_ahead / 10000.0;
    scan.ground_slope_left = head.ground_slope_left / 10000.0;
    scan.low_m = metres(head.low_mm);
    scan.high_m = metres(head.high_mm);
    scan.min_m = metres(head.min_mm);
    scan.max_m = metres(head.max_mm);
    return scan;
}

ScanSector sector_of(const proto::ScanSector& record) {
    ScanSector sector;
    sector.from_deg = record.from_cdeg / 100.0;
    sector.to_deg = record.to_cdeg / 100.0;
    sector.state = static_cast<SectorState>(record.state);
    sector.distance_m = metres(record.distance_mm);
    sector.sigma_m = metres(record.sigma_mm);
    sector.free_m = metres(record.free_mm);
    sector.low_m = metres(record.low_mm);
    sector.high_m = metres(record.high_mm);
    sector.pixels = record.pixels;
    sector.confidence = record.confidence;
    return sector;
}

}  // namespace

Scan read_scan(const std::uint8_t* bytes, std::size_t size) {
    proto::ScanHead head{};
    if (size < sizeof head) {
        throw std::runtime_error("the scan has " + std::to_string(size) + " bytes, its head alone has " +
                                 std::to_string(sizeof head));
    }
    std::memcpy(&head, bytes, sizeof head);
    if (head.version != proto::scan_version) {
        throw std::runtime_error("the scan has version " + std::to_string(head.version) + ", this program knows " +
                                 std::to_string(proto::scan_version) +
                                 ": use the client library that came with the daemon");
    }
    if (head.sectors > proto::scan_max_sectors || size != proto::scan_bytes(head.sectors)) {
        throw std::runtime_error("the scan has " + std::to_string(size) + " bytes, which is not the length of " +
                                 std::to_string(head.sectors) + " sectors");
    }
    Scan scan = scan_of(head);
    scan.sectors.reserve(head.sectors);
    for (std::size_t i = 0; i < head.sectors; ++i) {
        proto::ScanSector record{};
        std::memcpy(&record, bytes + proto::scan_bytes(i), sizeof record);
        scan.sectors.push_back(sector_of(record));
    }
    return scan;
}

}  // namespace disparity
