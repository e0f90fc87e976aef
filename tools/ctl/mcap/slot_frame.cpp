// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/mcap/slot_frame.h"

#include <cstring>

#include "products/product_planes.h"
#include "proto/products.h"

namespace disparityd::tools {
namespace {

void put_plane(disparity::PlaneData& to, disparity::Product product, const Plane<const std::uint8_t>& plane) {
    const std::uint32_t pixel_bytes = proto::product_facts(static_cast<v1::Product>(product)).bytes_per_pixel;
    const auto row_bytes = static_cast<std::size_t>(plane.width);
    to.product = product;
    to.bytes_per_pixel = pixel_bytes;
    to.width = static_cast<std::uint32_t>(plane.width) / pixel_bytes;
    to.height = static_cast<std::uint32_t>(plane.height);
    to.bytes.resize(row_bytes * to.height);
    for (int y = 0; y < plane.height; ++y) {
        std::memcpy(to.bytes.data() + static_cast<std::size_t>(y) * row_bytes, plane.data + y * plane.stride,
                    row_bytes);
    }
}

void put_record(disparity::PlaneData& to, std::span<const std::byte> record) {
    to.product = disparity::Product::scan;
    to.bytes_per_pixel = 1;
    to.width = static_cast<std::uint32_t>(record.size());
    to.height = 1;
    to.bytes.resize(record.size());
    std::memcpy(to.bytes.data(), record.data(), record.size());
}

disparity::SensorVector client_vector(const capture::SensorVector& vector) {
    return {vector.x, vector.y, vector.z};
}

}  // namespace

void put_slot(disparity::Frame& frame, const pipeline::FrameSlot& slot, DisparityRange range,
              const products::FrameFacts& facts, const SlotContents& contents) {
    proto::FrameInfo info = products::geometry_of(*slot.rectification, range);
    products::put_frame(info, slot, facts);
    info.flags |= contents.flags;
    proto::copy_frame_fields(frame, info);
    frame.planes.resize(contents.products.size());
    for (std::size_t i = 0; i < contents.products.size(); ++i) {
        const disparity::Product product = contents.products[i];
        if (product == disparity::Product::scan) {
            put_record(frame.planes[i], contents.scan);
        } else {
            put_plane(frame.planes[i], product,
                      products::product_plane(slot.view, slot.raw_eyes, static_cast<v1::Product>(product)));
        }
    }
}

disparity::SensorSample client_sample(const capture::SensorSample& sample) {
    disparity::SensorSample made;
    made.monotonic_ns = sample.monotonic_ns;
    made.realtime_ns = sample.realtime_ns;
    made.camera_ns = sample.camera_ns;
    made.lost_before = sample.lost_before;
    made.frame_sync = (sample.flags & capture::sensor_flag_frame_sync) != 0;
    made.frame_syncs = sample.frame_syncs;
    if ((sample.flags & capture::sensor_flag_inertial) != 0) {
        made.inertial = {client_vector(sample.angular_velocity), client_vector(sample.acceleration),
                         sample.imu_celsius};
    }
    if ((sample.flags & capture::sensor_flag_magnetic) != 0) {
        made.magnetic_field = client_vector(sample.magnetic_field);
    }
    if ((sample.flags & capture::sensor_flag_environment) != 0) {
        made.environment = {sample.celsius, sample.hectopascal, sample.humidity_percent};
    }
    if ((sample.flags & capture::sensor_flag_eye_temperature) != 0) {
        made.eye_temperatures = {sample.left_celsius, sample.right_celsius};
    }
    return made;
}

}  // namespace disparityd::tools
