// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/scan_record.h"

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

std::optional<Scan> Frame::scan() const {
    const PlaneData* record = plane(Product::scan);
    return record == nullptr ? std::nullopt : std::optional(read_scan(record->bytes.data(), record->bytes.size()));
}

std::optional<Scan> BorrowedFrame::scan() const {
    const BorrowedPlane* record = plane(Product::scan);
    return record == nullptr ? std::nullopt : std::optional(read_scan(record->bytes.data(), record->bytes.size()));
}

}  // namespace disparity
