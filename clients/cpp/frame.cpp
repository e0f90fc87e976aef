// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/disparity_client.hpp"

namespace disparity {

const PlaneData* Frame::plane(Product product) const {
    for (const PlaneData& plane : planes) {
        if (plane.product == product) {
            return &plane;
        }
    }
    return nullptr;
}

}  // namespace disparity
