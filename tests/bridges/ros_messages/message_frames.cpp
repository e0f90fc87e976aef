// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/ros_messages/message_frames.h"

#include <cstring>
#include <utility>

#include "proto/scan.h"

namespace disparityd::test {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;

constexpr std::size_t pixels = std::size_t{frame_width} * frame_height;

/// Returns a plane of one byte per pixel.
template <typename Function>
PlaneData plane_u8(Product product, Function value) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < pixels; ++i) {
        bytes.push_back(static_cast<std::uint8_t>(value(static_cast<int>(i))));
    }
    return plane_of_bytes(product, 1, std::move(bytes));
}

/// Returns a plane of two bytes per pixel.
template <typename Function>
PlaneData plane_16(Product product, Function value) {
    std::vector<std::uint8_t> bytes(2 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto number = static_cast<std::uint16_t>(value(static_cast<int>(i)));
        std::memcpy(&bytes[2 * i], &number, sizeof number);
    }
    return plane_of_bytes(product, 2, std::move(bytes));
}

PlaneData disparities() {
    return plane_16(Product::disparity, [](int i) { return i == 0 ? -16 : i == 1 ? -4 : 16 * i + i % 16; });
}

/// Returns 0 for pixel 0 and 65535 for pixel 1.
PlaneData lengths(Product product, int first) {
    return plane_16(product, [first](int i) { return i == 0 ? 0 : i == 1 ? 65535 : first + i; });
}

PlaneData scan() {
    using proto::SectorState;
    const auto sector = [](int from_deg, SectorState state, std::uint16_t distance_mm, std::uint16_t free_mm) {
        proto::ScanSector record{};
        record.from_cdeg = static_cast<std::int16_t>(100 * from_deg);
        record.to_cdeg = static_cast<std::int16_t>(100 * (from_deg + 10));
        record.state = state;
        record.distance_mm = distance_mm;
        record.free_mm = free_mm;
        record.confidence = state == SectorState::occupied ? 200 : 0;
        return record;
    };
    const std::vector<proto::ScanSector> sectors{
        sector(-15, SectorState::occupied, 2500, 2500), sector(-5, SectorState::free, 0, 10000),
        sector(5, SectorState::free, 0, 4000), sector(15, SectorState::unknown, 0, 0)};
    proto::ScanHead head{};
    head.version = proto::scan_version;
    head.sectors = static_cast<std::uint16_t>(sectors.size());
    head.min_mm = 500;
    head.max_mm = 10000;
    std::vector<std::uint8_t> bytes(proto::scan_bytes(sectors.size()));
    std::memcpy(bytes.data(), &head, sizeof head);
    std::memcpy(bytes.data() + sizeof head, sectors.data(), sectors.size() * sizeof sectors[0]);
    const auto size = static_cast<std::uint32_t>(bytes.size());
    return {Product::scan, size, 1, 1, std::move(bytes)};
}

}  // namespace

PlaneData plane_of_bytes(Product product, std::uint32_t bytes_per_pixel, std::vector<std::uint8_t> bytes) {
    return {product, frame_width, frame_height, bytes_per_pixel, std::move(bytes)};
}

Frame bare_frame() {
    Frame frame;
    frame.publish_index = 5;
    frame.realtime_ns = stamp_ns;
    frame.f = 100;
    frame.cx = 3.5;
    frame.cy = 1.5;
    frame.baseline_mm = 120;
    frame.disparity_offset = 0.25;
    frame.disparities = 64;
    frame.invalid = -16;
    frame.width = frame_width;
    frame.height = frame_height;
    return frame;
}

Frame grey_frame() {
    Frame frame = bare_frame();
    frame.planes = {disparities(),
                    plane_u8(Product::confidence, [](int i) { return i; }),
                    lengths(Product::depth, 1000),
                    plane_u8(Product::left, [](int i) { return 7 * i; }),
                    lengths(Product::depth_error, 10),
                    scan()};
    return frame;
}

Frame colour_frame() {
    Frame frame = bare_frame();
    std::vector<std::uint8_t> bgr;
    for (std::size_t i = 0; i < pixels; ++i) {
        for (const std::size_t value : {i, 2 * i, 255 - i}) {
            bgr.push_back(static_cast<std::uint8_t>(value));
        }
    }
    frame.planes = {disparities(), plane_of_bytes(Product::left_colour, 3, std::move(bgr))};
    return frame;
}

disparity::SensorBatch sensor_batch() {
    disparity::SensorSample all;
    all.realtime_ns = stamp_ns;
    all.inertial = {{0.5F, -0.25F, 0.125F}, {0.75F, -9.75F, 1.5F}, 36.5F};
    all.magnetic_field = {20, -30, 40};
    all.environment = {41.25F, 1013.25F, 45.5F};
    all.eye_temperatures = {33.5F, 34.25F};
    disparity::SensorSample motion;
    motion.realtime_ns = stamp_ns + 2'500'000;
    motion.inertial = {{1, 2, 3}, {4, 5, 6}, 37};
    disparity::SensorBatch batch;
    batch.samples = {all, motion};
    return batch;
}

v1::Status daemon_status() {
    v1::Status status;
    status.set_server_version("1.2.3");
    status.set_state("running");
    status.set_source("scene:vga@15");
    status.set_rate(14.5);
    status.set_published(4321);
    status.set_synthetic(true);
    v1::Geometry& geometry = *status.mutable_geometry();
    geometry.set_width(frame_width);
    geometry.set_height(frame_height);
    geometry.set_f(100);
    geometry.set_baseline_mm(120);
    v1::StepTime& step = *status.add_steps();
    step.set_name("match");
    step.set_p90_us(1234.5);
    status.add_notices("a notice");
    return status;
}

}  // namespace disparityd::test
