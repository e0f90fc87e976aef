// SPDX-License-Identifier: Apache-2.0
#include "daemon/self_calibrator.h"

#include <exception>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/failure_text.h"
#include "calibration/online/correction_file.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

/// Frames of one collection: an estimate is made after half of them and after all, then the collection starts again.
constexpr int batch = 8;

double degrees(std::int32_t nrad) {
    return nrad * 1e-9 * 180 / std::numbers::pi;
}

}  // namespace

SelfCalibrator::SelfCalibrator(const capture::SourceInfo& source, pipeline::CorrectedRectification& corrected,
                               DisparityRange range, Settings settings)
    : source_(source),
      corrected_(corrected),
      range_(range),
      settings_(std::move(settings)),
      calibration_(source.calibration.value()),
      pairs_("self-calibrate", corrected.factory().width, corrected.factory().height, settings_.interval,
             [this](auto left, auto right) { look(left, right); }) {
    if (!settings_.path.empty()) {
        try {
            if (const auto kept = calibration::read_correction(settings_.path, *source.calibration)) {
                corrected_.apply(*kept, corrected_.build(*kept));
                log_info(fmt::format("self-calibration: the correction in {} is applied", settings_.path));
            }
        } catch (const std::exception& error) {
            log_warning(fmt::format("self-calibration: {}", base::failure_text(error)));
        }
    }
}

SelfCalibrator::~SelfCalibrator() = default;

void SelfCalibrator::offer(const pipeline::FrameSlot& slot) noexcept {
    if (pairs_.wants()) {
        used_ = slot.rectification;
        already_ = slot.raw.correction;
        pairs_.give(slot.view);
    }
}

void SelfCalibrator::look(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    try {
        calibration_.add(left, right, *used_, already_, range_, &pairs_.stopping());
        used_.reset();
        const int frames = calibration_.frames();
        if (!pairs_.stopping().load() && (frames == batch / 2 || frames >= batch)) {
            estimate();
        }
        if (frames >= batch) {
            calibration_.clear();
        }
    } catch (...) {
        calibration_.clear();  // the correction in use stays
        throw;
    }
}

void SelfCalibrator::estimate() {
    const calibration::SelfCalibrationResult result = calibration_.solve(corrected_.state().correction);
    log_line(result.accepted ? LogLevel::info : LogLevel::debug,
             fmt::format("self-calibration: {}: {}", result.accepted ? "corrected" : "nothing changed", result.reason));
    const auto rectification = result.accepted ? corrected_.build(result.correction) : nullptr;
    {
        // The explanation first, then the correction: a status with a correction explains it.
        const std::lock_guard lock(mutex_);
        last_ = result;
        if (result.accepted) {
            accepted_ = result;
        }
    }
    if (result.accepted) {
        corrected_.apply(result.correction, rectification);
        keep(result.correction);
    }
}

void SelfCalibrator::keep(const calibration::CalibrationCorrection& correction) const {
    if (settings_.path.empty()) {
        return;
    }
    try {
        calibration::write_correction(settings_.path, *source_.calibration, correction);
    } catch (const std::exception& error) {
        log_warning(fmt::format("self-calibration: {}", base::failure_text(error)));
    }
}

void SelfCalibrator::fill(v1::SelfCalibration& message) const {
    put_correction(message, corrected_.state());
    message.set_estimating(true);
    const std::lock_guard lock(mutex_);
    message.set_detail(last_.frames > 0 ? last_.reason : "collecting frames");
    const bool found_here = accepted_.accepted;
    message.set_error_before_px(found_here ? accepted_.error_before : last_.error_before);
    message.set_error_after_px(found_here ? accepted_.error_after : 0);
    message.set_frames(static_cast<std::uint32_t>(last_.frames));
    message.set_matches(static_cast<std::uint32_t>(last_.matches));
}

void put_correction(v1::SelfCalibration& message, const pipeline::CorrectedRectification::State& state) {
    message.set_corrected(state.correction.any());
    message.set_pitch_degrees(degrees(state.correction.pitch_nrad));
    message.set_yaw_degrees(degrees(state.correction.yaw_nrad));
    message.set_roll_degrees(degrees(state.correction.roll_nrad));
    message.set_focal_ratio(1 + state.correction.focal_ppb * 1e-9);
    message.set_since_sequence(state.since.value_or(0));
}

}  // namespace disparityd::daemon
