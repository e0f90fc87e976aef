// SPDX-License-Identifier: Apache-2.0
#include "daemon/scan_record.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "proto/scan.h"

namespace disparityd::daemon {
namespace {

static_assert(std::endian::native == std::endian::little, "a scan is little endian");

template <typename T>
T limited(double value) {
    using Limits = std::numeric_limits<T>;
    return static_cast<T>(std::lround(std::clamp(value, double{Limits::min()}, double{Limits::max()})));
}

proto::ScanHead head_of(const Scan& scan, const ScanOptions& options) {
    proto::ScanHead head{};
    head.version = proto::scan_version;
    head.sectors = static_cast<std::uint16_t>(scan.sectors.size());
    head.ground = scan.ground_source;
    head.ground_age = limited<std::uint16_t>(scan.ground_age);
    head.ground_mm = limited<std::int16_t>(1000 * scan.ground.height_m);
    head.ground_slope_ahead = limited<std::int16_t>(10000 * scan.ground.slope_ahead);
    head.ground_slope_left = limited<std::int16_t>(10000 * scan.ground.slope_left);
    head.low_mm = limited<std::int16_t>(1000 * options.low_m);
    head.high_mm = limited<std::int16_t>(1000 * options.high_m);
    head.least_mm = limited<std::uint16_t>(1000 * options.min_m);
    head.most_mm = limited<std::uint16_t>(1000 * options.max_m);
    return head;
}

}  // namespace

void put_scan(const Scan& scan, const ScanOptions& options, std::vector<std::uint8_t>& bytes) {
    bytes.resize(proto::scan_bytes(scan.sectors.size()));
    const proto::ScanHead head = head_of(scan, options);
    std::memcpy(bytes.data(), &head, sizeof head);
    std::memcpy(bytes.data() + sizeof head, scan.sectors.data(), scan.sectors.size() * sizeof(ScanSector));
}

}  // namespace disparityd::daemon
