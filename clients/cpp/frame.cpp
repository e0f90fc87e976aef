// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/disparity_client.hpp"

namespace disparity {
namespace {

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

const PlaneData* Frame::plane(Product product) const {
    return find(planes, product);
}

const BorrowedPlane* BorrowedFrame::plane(Product product) const {
    return find(planes, product);
}

}  // namespace disparity
