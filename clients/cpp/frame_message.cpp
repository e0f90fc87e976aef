// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/frame_message.h"

#include <cstring>
#include <stdexcept>

#include <zstd.h>

#include "proto/frame_message.h"
#include "proto/framing.h"
#include "proto/products.h"

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
    // zstd writes at most the bytes of the plane, whatever size the compressed data claim.
    const std::size_t size = ZSTD_decompress(plane.bytes.data(), plane.bytes.size(), payload.data(), payload.size());
    if (ZSTD_isError(size) != 0 || size != plane.bytes.size()) {
        throw std::invalid_argument("compressed plane of " +
                                    disparityd::proto::product_name(static_cast<std::uint32_t>(info.product())) +
                                    " is damaged");
    }
}

}  // namespace

void take_over(Frame& frame, const v1::Frame& message, std::span<const std::uint8_t> payload) {
    disparityd::proto::copy_frame_fields(frame, disparityd::proto::to_info(message));
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
