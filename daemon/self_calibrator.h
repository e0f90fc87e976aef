// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "calibration/online/self_calibration.h"
#include "capture/frame_source.h"
#include "daemon/background_pairs.h"
#include "pipeline/frame_slot.h"
#include "pipeline/rectification_schedule.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// Estimates corrections of a live camera in the background, from the rectified pair of a published frame now and then,
/// and applies an accepted correction from the next frame on.
class SelfCalibrator {
public:
    struct Settings {
        std::chrono::seconds interval{10};  ///< between two frames that are used
        std::string path;                   ///< file of the correction; empty: it is not saved
    };

    /// Applies the saved correction. `corrected` must outlive this object. The source has a calibration of raw cameras.
    SelfCalibrator(const capture::SourceInfo& source, pipeline::CorrectedRectification& corrected, DisparityRange range,
                   Settings settings);
    ~SelfCalibrator();
    SelfCalibrator(const SelfCalibrator&) = delete;
    SelfCalibrator& operator=(const SelfCalibrator&) = delete;

    /// Returns whether a frame is due to be offered. Any thread.
    bool wants() const noexcept { return pairs_.wants(); }

    /// Offers a finished frame; called in the publish thread. Allocates nothing.
    void offer(const pipeline::FrameSlot& slot) noexcept;

    /// Puts the correction and how it was found into the status. Any thread.
    void fill(v1::SelfCalibration& message) const;

private:
    void look(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right);
    void estimate();
    void keep(const calibration::CalibrationCorrection& correction) const;

    const capture::SourceInfo source_;
    pipeline::CorrectedRectification& corrected_;
    const DisparityRange range_;
    const Settings settings_;
    calibration::SelfCalibration calibration_;  ///< used by the estimator's thread only

    // Belong to the pair that the estimator gets or has.
    std::shared_ptr<const calibration::Rectification> used_;
    calibration::CalibrationCorrection already_;

    mutable std::mutex mutex_;  ///< the two below
    calibration::SelfCalibrationResult last_;
    calibration::SelfCalibrationResult accepted_;  ///< what is in use
    BackgroundPairs pairs_;                        ///< last: its thread uses the rest
};

/// Puts a correction into the status, whether it was estimated here or recorded.
void put_correction(v1::SelfCalibration& message, const pipeline::CorrectedRectification::State& state);

}  // namespace disparityd::daemon
