// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/frames/planes.h"

#include "proto/products.h"

namespace disparityd::web {

bool is_whole_image(const disparity::PlaneData& plane) {
    const auto number = static_cast<std::uint32_t>(plane.product);
    return plane.product != disparity::Product::scan && number >= 1 && number <= proto::products.size() &&
           plane.bytes_per_pixel == proto::products[number - 1].bytes_per_pixel &&
           plane.bytes.size() == std::uint64_t{plane.width} * plane.height * plane.bytes_per_pixel;
}

const disparity::PlaneData* whole_plane(const disparity::Frame& frame, disparity::Product product) {
    const disparity::PlaneData* const plane = frame.plane(product);
    return plane != nullptr && !plane->bytes.empty() && is_whole_image(*plane) ? plane : nullptr;
}

void leave_out_broken_planes(disparity::Frame& frame) {
    std::erase_if(frame.planes, [](const disparity::PlaneData& plane) {
        return plane.product != disparity::Product::scan && !is_whole_image(plane);
    });
}

}  // namespace disparityd::web
