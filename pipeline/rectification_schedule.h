// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "calibration/calibration.h"
#include "calibration/calibration_correction.h"
#include "calibration/rectification.h"
#include "capture/frame_source.h"

namespace disparityd::pipeline {

/// Throws std::runtime_error with one line when a frame was recorded with a correction that no camera can need.
void check_recorded_correction(const capture::RawFrame& frame);

/// Chooses the rectification of each frame of a source. All rectifications have the size of the first.
class RectificationSchedule {
public:
    virtual ~RectificationSchedule() = default;

    /// Returns the rectification of the factory calibration.
    virtual const calibration::Rectification& factory() const = 0;

    /// Returns the rectification of a frame and notes its correction in `frame.correction`, where a recorder finds it.
    /// Called in the capture thread for each frame in order.
    virtual std::shared_ptr<const calibration::Rectification> for_frame(capture::RawFrame& frame) = 0;
};

/// Gives all frames one rectification, which must outlive this object.
class FixedRectification final : public RectificationSchedule {
public:
    explicit FixedRectification(const calibration::Rectification& rectification);
    const calibration::Rectification& factory() const override { return *rectification_; }
    std::shared_ptr<const calibration::Rectification> for_frame(capture::RawFrame& frame) override;

private:
    std::shared_ptr<const calibration::Rectification> rectification_;  // does not own
};

/// Maps of a calibration with the current correction, which changes while frames are on their way. for_frame() is for
/// the capture thread, the rest for any.
class CorrectedRectification final : public RectificationSchedule {
public:
    /// Where corrections come from: from each frame, as recorded, or from apply().
    enum class Follow { recorded, applied };

    /// Throws as make_rectification() does.
    CorrectedRectification(const capture::SourceInfo& source, const calibration::RectifiedGeometry& geometry,
                           Follow follow);

    /// Builds the maps of a corrected calibration, which takes tens of milliseconds: a thread that must not wait leaves
    /// this to another one. Throws as make_rectification() does.
    std::shared_ptr<const calibration::Rectification> build(const calibration::CalibrationCorrection& correction) const;

    /// From the next call of for_frame() on, frames get this correction. Does nothing with Follow::recorded.
    void apply(const calibration::CalibrationCorrection& correction,
               std::shared_ptr<const calibration::Rectification> rectification);

    const calibration::Rectification& factory() const override { return *factory_; }
    std::shared_ptr<const calibration::Rectification> for_frame(capture::RawFrame& frame) override;

    struct State {
        calibration::CalibrationCorrection correction;
        std::optional<std::uint64_t> since;  ///< sequence of the first frame with it; none before the first frame
    };
    State state() const;

private:
    const std::optional<calibration::StereoCalibration> calibration_;
    const calibration::RectifiedGeometry geometry_;
    const int eye_width_;
    const int height_;
    const Follow follow_;
    const std::shared_ptr<const calibration::Rectification> factory_;
    mutable std::mutex mutex_;  ///< the two below
    std::shared_ptr<const calibration::Rectification> current_;
    State state_;
};

}  // namespace disparityd::pipeline
