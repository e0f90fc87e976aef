// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "calibration/self_calibration.h"
#include "capture/rectification_schedule.h"

namespace disparityd::calibration {

/// Self-calibration while frames are replayed, at fixed frame numbers: every `stride`-th frame is looked at, beginning
/// with the first. Estimates are made after 1, 2, 4, ... and after `batch` of them, where the collection starts again;
/// what is accepted holds from the frame at hand on. All of it in the capture thread, which waits: the same frames give
/// the same corrections, whatever else the machine has to do.
class CalibratingSchedule final : public capture::RectificationSchedule {
public:
    struct Plan {
        int stride = 10;
        int batch = 8;
    };

    /// `range`: the disparities that corners are looked for in. Throws std::invalid_argument for a source without
    /// calibration, or with images that are rectified already.
    CalibratingSchedule(const capture::SourceInfo& source, const capture::RectifiedGeometry& geometry,
                        DisparityRange range, Plan plan);

    const capture::Rectification& factory() const override { return book_.factory(); }
    std::shared_ptr<const capture::Rectification> for_frame(capture::RawFrame& frame) override;

    /// What is in use; its state() may be read from any thread at any time.
    const capture::RectificationBook& book() const { return book_; }

    struct Estimate {
        std::uint64_t sequence = 0;  ///< of the frame it was made at, the first to have the correction
        SelfCalibrationResult result;
    };
    /// In order; not while frames are on their way.
    const std::vector<Estimate>& estimates() const { return estimates_; }

private:
    void look_at(const capture::RawFrame& frame, const capture::Rectification& used);

    capture::RectificationBook book_;
    SelfCalibration calibration_;
    DisparityRange range_;
    Plan plan_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    std::uint64_t frames_ = 0;
    std::vector<Estimate> estimates_;
};

}  // namespace disparityd::calibration
