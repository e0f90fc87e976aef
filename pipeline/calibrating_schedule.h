// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "calibration/online/self_calibration.h"
#include "pipeline/rectification_schedule.h"

namespace disparityd::pipeline {

/// Calibrates itself while frames are replayed, at fixed frame numbers: it collects matches of every `stride`-th frame,
/// beginning with the first, and estimates after 1, 2, 4, ... and `batch` of them. After `batch` the collection starts
/// again. An accepted correction holds from the current frame on. All of this runs in the capture thread, which waits:
/// the same frames give the same corrections on a busy machine, too.
class CalibratingSchedule final : public RectificationSchedule {
public:
    struct Plan {
        int stride = 10;
        int batch = 8;
    };

    /// Corners are matched within `range`. Throws std::invalid_argument for a source without
    /// calibration, or with images that are rectified already.
    CalibratingSchedule(const capture::SourceInfo& source, const calibration::RectifiedGeometry& geometry,
                        DisparityRange range, Plan plan);

    const calibration::Rectification& factory() const override { return corrected_.factory(); }
    std::shared_ptr<const calibration::Rectification> for_frame(capture::RawFrame& frame) override;

    /// Returns the rectification in use; any thread may call its state() at any time.
    const CorrectedRectification& corrected() const { return corrected_; }

    struct Estimate {
        std::uint64_t sequence = 0;  ///< of the frame that completed the estimate, the first with its correction
        calibration::SelfCalibrationResult result;
    };
    /// Returns the estimates in order. Not to be called while the pipeline runs.
    const std::vector<Estimate>& estimates() const { return estimates_; }

private:
    void look_at(const capture::RawFrame& frame, const calibration::Rectification& used);

    CorrectedRectification corrected_;
    calibration::SelfCalibration calibration_;
    DisparityRange range_;
    Plan plan_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    std::uint64_t frames_ = 0;
    std::vector<Estimate> estimates_;
};

}  // namespace disparityd::pipeline
