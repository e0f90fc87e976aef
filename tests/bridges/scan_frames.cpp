// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/scan_frames.h"

#include <cstring>

namespace disparityd::test {

std::vector<std::uint8_t> scan_with_obstacle(int bearing_deg, int distance_mm) {
    proto::ScanHead head{};
    head.version = proto::scan_version;
    head.sectors = 1;
    head.high_mm = 1000;
    head.max_mm = 20000;
    proto::ScanSector sector{};
    sector.from_cdeg = static_cast<std::int16_t>(100 * bearing_deg - 250);
    sector.to_cdeg = static_cast<std::int16_t>(100 * bearing_deg + 250);
    sector.state = proto::SectorState::occupied;
    sector.distance_mm = static_cast<std::uint16_t>(distance_mm);
    sector.high_mm = 500;
    std::vector<std::uint8_t> bytes(proto::scan_bytes(1));
    std::memcpy(bytes.data(), &head, sizeof head);
    std::memcpy(bytes.data() + sizeof head, &sector, sizeof sector);
    return bytes;
}

disparity::Frame client_frame(const std::vector<std::uint8_t>& scan, std::chrono::nanoseconds age) {
    disparity::Frame frame;
    frame.age_ns = age.count();
    frame.planes = {{disparity::Product::scan, static_cast<std::uint32_t>(scan.size()), 1, 1, scan}};
    return frame;
}

v1::Envelope frame_message(const std::vector<std::uint8_t>& scan, std::chrono::nanoseconds age) {
    v1::Envelope message;
    v1::Frame& frame = *message.mutable_frame();
    frame.set_age_ns(age.count());
    v1::PlaneInfo& plane = *frame.add_planes();
    plane.set_product(v1::SCAN);
    plane.set_width(static_cast<std::uint32_t>(scan.size()));
    plane.set_height(1);
    plane.set_bytes_per_pixel(1);
    plane.set_payload_bytes(scan.size());
    message.set_payload_bytes(scan.size());
    return message;
}

}  // namespace disparityd::test
