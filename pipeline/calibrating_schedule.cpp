// SPDX-License-Identifier: Apache-2.0
#include "pipeline/calibrating_schedule.h"

#include <bit>
#include <stdexcept>

#include "kernels/reference/steps.h"

namespace disparityd::pipeline {

namespace {

const calibration::StereoCalibration& calibration_of(const capture::SourceInfo& source) {
    if (!source.calibration) {
        throw std::invalid_argument("self-calibration: " + source.name +
                                    " has no calibration that could be corrected; give one with --calibration FILE");
    }
    return *source.calibration;
}

}  // namespace

CalibratingSchedule::CalibratingSchedule(const capture::SourceInfo& source,
                                         const calibration::RectifiedGeometry& geometry, DisparityRange range,
                                         Plan plan)
    : corrected_(source, geometry, CorrectedRectification::Follow::applied),
      calibration_(calibration_of(source)),
      range_(range),
      plan_(plan),
      left_(static_cast<std::size_t>(corrected_.factory().width) *
            static_cast<std::size_t>(corrected_.factory().height)),
      right_(left_.size()) {}

std::shared_ptr<const calibration::Rectification> CalibratingSchedule::for_frame(capture::RawFrame& frame) {
    const bool due = frames_++ % static_cast<std::uint64_t>(plan_.stride) == 0;
    auto used = corrected_.for_frame(frame);
    if (!due || (frame.flags & capture::frame_flag_corrupt) != 0) {
        return used;
    }
    look_at(frame, *used);
    const bool full = calibration_.frames() >= plan_.batch;
    if (full || std::has_single_bit(static_cast<unsigned>(calibration_.frames()))) {
        estimates_.push_back({frame.sequence, calibration_.solve(frame.correction)});
        if (const calibration::SelfCalibrationResult& result = estimates_.back().result; result.accepted) {
            corrected_.apply(result.correction, corrected_.build(result.correction));
            used = corrected_.for_frame(frame);
        }
    }
    if (full) {
        calibration_.clear();
    }
    return used;
}

void CalibratingSchedule::look_at(const capture::RawFrame& frame, const calibration::Rectification& used) {
    const Rectifier rectifier = used.rectifier();
    const Plane<std::uint8_t> left{left_.data(), used.width, used.height, used.width};
    const Plane<std::uint8_t> right{right_.data(), used.width, used.height, used.width};
    reference::rectify(frame.image, Eye::left, rectifier, left, {0, used.height});
    reference::rectify(frame.image, Eye::right, rectifier, right, {0, used.height});
    calibration_.add(left, right, used, frame.correction, range_);
}

}  // namespace disparityd::pipeline
