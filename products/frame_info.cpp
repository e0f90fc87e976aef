// SPDX-License-Identifier: Apache-2.0
#include "products/frame_info.h"

#include "kernels/matcher.h"
#include "proto/disparity.pb.h"

namespace disparityd::products {

void put_geometry(proto::FrameInfo& info, const calibration::Rectification& rectification) {
    info.calibration_id = rectification.calibration_id;
    info.f = rectification.f;
    info.cx = rectification.cx;
    info.cy = rectification.cy;
    info.baseline_mm = rectification.baseline_mm;
    info.disparity_offset = rectification.disparity_offset;
}

proto::FrameInfo geometry_of(const calibration::Rectification& rectification, DisparityRange range) {
    proto::FrameInfo info{};
    put_geometry(info, rectification);
    info.d_min = range.first;
    info.disparities = static_cast<std::uint32_t>(range.count);
    info.invalid = invalid_disparity(range);
    info.width = static_cast<std::uint32_t>(rectification.width);
    info.height = static_cast<std::uint32_t>(rectification.height);
    return info;
}

void put_frame(proto::FrameInfo& info, const pipeline::FrameSlot& slot, const FrameFacts& facts) {
    info.sequence = slot.raw.sequence;
    info.monotonic_ns = slot.raw.monotonic_ns;
    info.realtime_ns = slot.raw.realtime_ns;
    info.dropped_before = slot.dropped_before;
    info.flags = v1::FLAG_NONE;
    const auto set = [&info](bool is, v1::FrameFlags flag) {
        info.flags |= is ? static_cast<std::uint32_t>(flag) : 0U;
    };
    set(slot.rectification->unrectified, v1::UNRECTIFIED);
    set(facts.synthetic, v1::SYNTHETIC);
    set(facts.interpolated, v1::INTERPOLATED);
    set(slot.dropped_before > 0, v1::DROPPED_BEFORE);
    set(facts.first || (slot.raw.flags & capture::frame_flag_discontinuity) != 0, v1::DISCONTINUITY);
    set((slot.raw.flags & capture::frame_flag_exposure_centre) != 0, v1::EXPOSURE_CENTRE);
}

}  // namespace disparityd::products
