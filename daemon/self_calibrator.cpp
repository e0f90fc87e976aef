// SPDX-License-Identifier: Apache-2.0
#include "daemon/self_calibrator.h"

#include <algorithm>
#include <bit>
#include <exception>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/failure_text.h"
#include "base/start_thread.h"
#include "calibration/online/correction_file.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

using std::chrono::steady_clock;

/// Frames of one collection: an estimate is made after half of them and after all, then the collection starts again.
constexpr int batch = 8;

void copy(Plane<const std::uint8_t> plane, std::vector<std::uint8_t>& to) {
    for (int y = 0; y < plane.height; ++y) {
        std::copy_n(plane.row(y), plane.width, to.begin() + static_cast<std::ptrdiff_t>(y) * plane.width);
    }
}

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
      left_(static_cast<std::size_t>(corrected.factory().width) * static_cast<std::size_t>(corrected.factory().height)),
      right_(left_.size()) {
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
    thread_ = base::start_thread([this] { run(); });
}

SelfCalibrator::~SelfCalibrator() {
    stopping_.store(true);
    // A change of the stage wakes the thread, whatever it waits for.
    stage_.store(filled);
    stage_.notify_one();
    thread_.join();
}

void SelfCalibrator::offer(const pipeline::FrameSlot& slot) noexcept {
    if (stage_.load(std::memory_order_acquire) != wanted || steady_clock::now() < due_) {
        return;
    }
    copy(slot.view.left, left_);
    copy(slot.view.right, right_);
    used_ = slot.rectification;
    already_ = slot.raw.correction;
    int expected = wanted;
    if (stage_.compare_exchange_strong(expected, filled, std::memory_order_acq_rel)) {
        stage_.notify_one();
    }
}

void SelfCalibrator::run() {
    pthread_setname_np(pthread_self(), "self-calibrate");
    // Not SCHED_IDLE: on a busy machine the thread would never run.
    constexpr int least_urgent = 19;
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), least_urgent);
    for (;;) {
        due_ = steady_clock::now() + settings_.interval;
        int before = busy;
        stage_.compare_exchange_strong(before, wanted, std::memory_order_acq_rel);
        stage_.wait(wanted, std::memory_order_acquire);
        if (stopping_.load()) {
            return;
        }
        stage_.store(busy, std::memory_order_relaxed);
        try {
            look();
        } catch (...) {
            // Most likely there is no memory. The correction in use stays.
            log_caught("self-calibration");
            calibration_.clear();
        }
        if (stopping_.load()) {
            return;
        }
    }
}

void SelfCalibrator::look() {
    const int width = used_->width;
    const int height = used_->height;
    calibration_.add({left_.data(), width, height, width}, {right_.data(), width, height, width}, *used_, already_,
                     range_, &stopping_);
    used_.reset();
    const int frames = calibration_.frames();
    if (!stopping_.load() && (frames == batch / 2 || frames >= batch)) {
        estimate();
    }
    if (frames >= batch) {
        calibration_.clear();
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
