// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/metres.h"
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

std::optional<double> distance_m(const FrameInfo& frame, double disparity_px) {
    const double d = disparity_px + frame.disparity_offset;
    return has_metres(frame) && d > 0 ? std::optional(frame.f * frame.baseline_mm / d / 1000) : std::nullopt;
}

std::optional<FloatImage> Frame::disparity_px() const {
    return disparity_px_of(*this);
}
std::optional<FloatImage> Frame::depth_m() const {
    return depth_m_of(*this);
}
std::optional<FloatImage> Frame::depth_error_m() const {
    return depth_error_m_of(*this);
}
std::optional<Points> Frame::points(std::uint32_t step) const {
    return points_of(*this, step);
}

std::optional<FloatImage> BorrowedFrame::disparity_px() const {
    return disparity_px_of(*this);
}
std::optional<FloatImage> BorrowedFrame::depth_m() const {
    return depth_m_of(*this);
}
std::optional<FloatImage> BorrowedFrame::depth_error_m() const {
    return depth_error_m_of(*this);
}
std::optional<Points> BorrowedFrame::points(std::uint32_t step) const {
    return points_of(*this, step);
}

}  // namespace disparity
