// SPDX-License-Identifier: Apache-2.0
#include "capture/rectification_schedule.h"

#include <stdexcept>
#include <string>
#include <utility>

namespace disparityd::capture {

FixedRectification::FixedRectification(const Rectification& rectification)
    : rectification_(std::shared_ptr<const Rectification>(), &rectification) {}

std::shared_ptr<const Rectification> FixedRectification::for_frame(RawFrame&) {
    return rectification_;
}

RectificationBook::RectificationBook(const SourceInfo& source, const RectifiedGeometry& geometry, Follow follow)
    : calibration_(source.calibration),
      geometry_(geometry),
      eye_width_(source.eye_width),
      height_(source.height),
      follow_(follow),
      factory_(std::make_shared<const Rectification>(make_rectification(calibration_, eye_width_, height_, geometry_))),
      current_(factory_) {}

std::shared_ptr<const Rectification> RectificationBook::made(const CalibrationCorrection& correction) const {
    if (!correction.any() || !calibration_ || calibration_->rectified) {
        return factory_;
    }
    return std::make_shared<const Rectification>(
        make_rectification(corrected(*calibration_, correction), eye_width_, height_, geometry_));
}

void RectificationBook::apply(const CalibrationCorrection& correction,
                              std::shared_ptr<const Rectification> rectification) {
    const std::lock_guard lock(mutex_);
    if (follow_ == Follow::applied) {
        current_ = std::move(rectification);
        state_ = {correction, std::nullopt};
    }
}

std::shared_ptr<const Rectification> RectificationBook::for_frame(RawFrame& frame) {
    const std::lock_guard lock(mutex_);
    if (follow_ == Follow::recorded && frame.correction != state_.correction) {
        if (!is_plausible(frame.correction)) {
            throw std::runtime_error("frame " + std::to_string(frame.sequence) +
                                     ": the recorded correction of the calibration is damaged; use the calibration "
                                     "alone: --no-self-calibration");
        }
        current_ = made(frame.correction);
        state_ = {frame.correction, std::nullopt};
    }
    if (!state_.since) {
        state_.since = frame.sequence;
    }
    frame.correction = state_.correction;
    return current_;
}

RectificationBook::State RectificationBook::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

}  // namespace disparityd::capture
