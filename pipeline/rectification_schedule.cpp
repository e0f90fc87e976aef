// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rectification_schedule.h"

#include <stdexcept>
#include <string>
#include <utility>

namespace disparityd::pipeline {

void check_recorded_correction(const capture::RawFrame& frame) {
    if (!calibration::is_plausible(frame.correction)) {
        throw std::runtime_error("frame " + std::to_string(frame.sequence) +
                                 ": the recorded correction of the calibration is damaged; use the calibration alone: "
                                 "--no-self-calibration");
    }
}

FixedRectification::FixedRectification(const calibration::Rectification& rectification)
    : rectification_(std::shared_ptr<const calibration::Rectification>(), &rectification) {}

std::shared_ptr<const calibration::Rectification> FixedRectification::for_frame(capture::RawFrame&) {
    return rectification_;
}

CorrectedRectification::CorrectedRectification(const capture::SourceInfo& source,
                                               const calibration::RectifiedGeometry& geometry, Follow follow)
    : calibration_(source.calibration),
      geometry_(geometry),
      eye_width_(source.eye_width),
      height_(source.height),
      follow_(follow),
      factory_(std::make_shared<const calibration::Rectification>(
          calibration::make_rectification(calibration_, eye_width_, height_, geometry_))),
      current_(factory_) {}

std::shared_ptr<const calibration::Rectification> CorrectedRectification::build(
    const calibration::CalibrationCorrection& correction) const {
    if (!correction.any() || !calibration_ || calibration_->rectified) {
        return factory_;
    }
    return std::make_shared<const calibration::Rectification>(calibration::make_rectification(
        calibration::corrected(*calibration_, correction), eye_width_, height_, geometry_));
}

void CorrectedRectification::apply(const calibration::CalibrationCorrection& correction,
                                   std::shared_ptr<const calibration::Rectification> rectification) {
    const std::lock_guard lock(mutex_);
    if (follow_ == Follow::applied) {
        current_ = std::move(rectification);
        state_ = {correction, std::nullopt};
    }
}

std::shared_ptr<const calibration::Rectification> CorrectedRectification::for_frame(capture::RawFrame& frame) {
    const std::lock_guard lock(mutex_);
    if (follow_ == Follow::recorded && frame.correction != state_.correction) {
        check_recorded_correction(frame);
        current_ = build(frame.correction);
        state_ = {frame.correction, std::nullopt};
    }
    if (!state_.since) {
        state_.since = frame.sequence;
    }
    frame.correction = state_.correction;
    return current_;
}

CorrectedRectification::State CorrectedRectification::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

}  // namespace disparityd::pipeline
