// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "calibration/self_calibration.h"
#include "capture/frame_source.h"
#include "capture/rectification_schedule.h"
#include "pipeline/frame_slot.h"
#include "proto/disparity.pb.h"

namespace disparityd {

/// Self-calibration beside a live pipeline, in a thread of its own of the lowest priority. It takes the rectified pair
/// of a published frame now and then, and puts what it has found into the book, where the next frame finds it. The
/// publish thread only copies a pair when the estimator is idle; nobody ever waits for it.
class SelfCalibrator {
public:
    struct Settings {
        std::chrono::seconds interval{10};  ///< between frames that are looked at
        std::string path;                   ///< file that keeps the correction; empty: it is not kept
    };

    /// Applies a correction that was kept. `book` must outlive this object. The source has a calibration of raw
    /// cameras.
    SelfCalibrator(const capture::SourceInfo& source, capture::RectificationBook& book, DisparityRange range,
                   Settings settings);
    ~SelfCalibrator();
    SelfCalibrator(const SelfCalibrator&) = delete;
    SelfCalibrator& operator=(const SelfCalibrator&) = delete;

    /// A finished frame, in the publish thread. Allocates nothing.
    void offer(const pipeline::FrameSlot& slot) noexcept;

    void fill(v1::SelfCalibration& message) const;

private:
    void run();
    void look();
    void estimate();
    void keep(const capture::CalibrationCorrection& correction) const;

    enum Stage : int { busy, wanted, filled };

    const capture::SourceInfo source_;
    capture::RectificationBook& book_;
    const DisparityRange range_;
    const Settings settings_;
    calibration::SelfCalibration calibration_;  ///< of the estimator's thread

    std::atomic<int> stage_{busy};
    std::atomic<bool> stopping_{false};
    // The publish thread's while the stage is `wanted`, else the estimator's.
    std::chrono::steady_clock::time_point due_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    std::shared_ptr<const capture::Rectification> used_;
    capture::CalibrationCorrection already_;

    mutable std::mutex mutex_;  ///< the two below
    calibration::SelfCalibrationResult last_;
    calibration::SelfCalibrationResult accepted_;  ///< what is in use
    std::thread thread_;
};

/// What the status says of a correction, whoever has found it.
void fill(v1::SelfCalibration& message, const capture::RectificationBook::State& state);

}  // namespace disparityd
