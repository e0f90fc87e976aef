// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/frame_message.h"

#include <cstring>
#include <stdexcept>

#include <zstd.h>

#include "proto/framing.h"

namespace disparity {
namespace {

namespace v1 = disparityd::v1;

void unpack(PlaneData& plane, const v1::PlaneInfo& info, std::span<const std::uint8_t> payload) {
    plane.product = static_cast<Product>(info.product());
    plane.width = info.width();
    plane.height = info.height();
    plane.bytes_per_pixel = info.bytes_per_pixel();
    plane.bytes.resize(disparityd::proto::raw_plane_bytes(info));
    if (info.encoding() == v1::RAW) {
        std::memcpy(plane.bytes.data(), payload.data(), plane.bytes.size());
        return;
    }
    // Writes no more than the plane has, whatever the compressed data claim.
    const std::size_t size = ZSTD_decompress(plane.bytes.data(), plane.bytes.size(), payload.data(), payload.size());
    if (ZSTD_isError(size) != 0 || size != plane.bytes.size()) {
        throw std::invalid_argument("compressed plane of product " + std::to_string(info.product()) + " is damaged");
    }
}

}  // namespace

void take_over(Frame& frame, const v1::Frame& message, std::span<const std::uint8_t> payload) {
    const v1::Geometry& geometry = message.geometry();
    frame.publish_index = message.publish_index();
    frame.sequence = message.sequence();
    frame.monotonic_ns = message.monotonic_ns();
    frame.realtime_ns = message.realtime_ns();
    frame.age_ns = message.age_ns();
    frame.dropped_before = message.dropped_before();
    frame.calibration_id = geometry.calibration_id();
    frame.f = geometry.f();
    frame.cx = geometry.cx();
    frame.cy = geometry.cy();
    frame.baseline_mm = geometry.baseline_mm();
    frame.disparity_offset = geometry.disparity_offset();
    frame.d_min = geometry.d_min();
    frame.disparities = geometry.disparities();
    frame.invalid = geometry.invalid();
    frame.flags = message.flags();
    frame.width = geometry.width();
    frame.height = geometry.height();
    frame.region_x = message.region().x();
    frame.region_y = message.region().y();
    frame.planes.resize(static_cast<std::size_t>(message.planes_size()));
    for (int i = 0; i < message.planes_size(); ++i) {
        const v1::PlaneInfo& info = message.planes(i);
        unpack(frame.planes[static_cast<std::size_t>(i)], info, payload.first(info.payload_bytes()));
        payload = payload.subspan(info.payload_bytes());
    }
}

}  // namespace disparity
