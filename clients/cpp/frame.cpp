// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/metres.h"
#include "proto/doubt.h"
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
    if (head.mounting_height_mm != 0) {
        scan.mounting = {metres(head.mounting_height_mm), head.mounting_pitch_cdeg / 100.0,
                         head.mounting_roll_cdeg / 100.0};
    }
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
    sector.trust = record.trust;
    sector.doubts = std::uint32_t{record.doubts} << proto::scan_doubt_shift;
    return sector;
}

/// Reads the bytes of the product SCAN, which may be anything: those of a borrowed frame may change meanwhile. Throws
/// std::runtime_error when they have another version or another length than their head says.
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

template <typename Plane>
const Plane* find(const std::vector<Plane>& planes, Product product) {
    for (const Plane& plane : planes) {
        if (plane.product == product) {
            return &plane;
        }
    }
    return nullptr;
}

}  // namespace

std::string doubt_names(std::uint32_t flags) {
    return proto::doubt_names(flags);
}

const PlaneData* Frame::plane(Product product) const {
    return find(planes, product);
}

const BorrowedPlane* BorrowedFrame::plane(Product product) const {
    return find(planes, product);
}

std::optional<Scan> Frame::scan() const {
    const PlaneData* record = plane(Product::scan);
    return record == nullptr ? std::nullopt : std::optional(read_scan(record->bytes.data(), record->bytes.size()));
}

std::optional<Scan> BorrowedFrame::scan() const {
    const BorrowedPlane* record = plane(Product::scan);
    return record == nullptr ? std::nullopt : std::optional(read_scan(record->bytes.data(), record->bytes.size()));
}

std::optional<double> distance_m(const FrameInfo& frame, double disparity_px) {
    const double d = disparity_px + frame.disparity_offset;
    return has_metres(frame) && d > 0 ? std::optional(frame.f * frame.baseline_mm / d / 1000) : std::nullopt;
}

std::optional<FloatImage> Frame::disparity_px() const {
    return disparity_px_of(*this);
}
std::optional<FloatImage> Frame::depth_m() const {
    return depth_m_of(*this);
}
std::optional<FloatImage> Frame::depth_error_m() const {
    return depth_error_m_of(*this);
}
std::optional<Points> Frame::points(std::uint32_t step) const {
    return points_of(*this, step);
}

std::optional<FloatImage> BorrowedFrame::disparity_px() const {
    return disparity_px_of(*this);
}
std::optional<FloatImage> BorrowedFrame::depth_m() const {
    return depth_m_of(*this);
}
std::optional<FloatImage> BorrowedFrame::depth_error_m() const {
    return depth_error_m_of(*this);
}
std::optional<Points> BorrowedFrame::points(std::uint32_t step) const {
    return points_of(*this, step);
}

}  // namespace disparity
