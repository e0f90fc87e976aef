// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "capture/calibration.h"
#include "capture/calibration_correction.h"
#include "capture/frame_source.h"
#include "capture/rectification.h"

namespace disparityd::capture {

/// Which rectification each frame of a source gets. All of them have the size of the first.
class RectificationSchedule {
public:
    virtual ~RectificationSchedule() = default;

    /// The rectification of the factory calibration.
    virtual const Rectification& factory() const = 0;

    /// Called in the capture thread for each frame in order: chooses, and notes the choice in `frame.correction`, where
    /// a recorder finds it.
    virtual std::shared_ptr<const Rectification> for_frame(RawFrame& frame) = 0;
};

/// Every frame as one calibration has it; `rectification` must outlive it.
class FixedRectification final : public RectificationSchedule {
public:
    explicit FixedRectification(const Rectification& rectification);
    const Rectification& factory() const override { return *rectification_; }
    std::shared_ptr<const Rectification> for_frame(RawFrame& frame) override;

private:
    std::shared_ptr<const Rectification> rectification_;  // does not own
};

/// A calibration with corrections that come while frames are on their way. for_frame() is the capture thread's, the
/// rest may be called from any.
class RectificationBook final : public RectificationSchedule {
public:
    /// Where corrections come from: what a recording says of each frame, or apply().
    enum class Follow { recorded, applied };

    /// Throws as make_rectification() does.
    RectificationBook(const SourceInfo& source, const RectifiedGeometry& geometry, Follow follow);

    /// The rectification of a corrected calibration: makes its maps, which takes tens of milliseconds; a thread that
    /// must not wait has another one do this first. Throws as make_rectification() does.
    std::shared_ptr<const Rectification> made(const CalibrationCorrection& correction) const;

    /// The next frame that is asked for, and all after it, have this correction. Nothing with Follow::recorded.
    void apply(const CalibrationCorrection& correction, std::shared_ptr<const Rectification> rectification);

    const Rectification& factory() const override { return *factory_; }
    std::shared_ptr<const Rectification> for_frame(RawFrame& frame) override;

    struct State {
        CalibrationCorrection correction;
        std::optional<std::uint64_t> since;  ///< sequence of the first frame with it; none before the first frame
    };
    State state() const;

private:
    const std::optional<StereoCalibration> calibration_;
    const RectifiedGeometry geometry_;
    const int eye_width_;
    const int height_;
    const Follow follow_;
    const std::shared_ptr<const Rectification> factory_;
    mutable std::mutex mutex_;  ///< the two below
    std::shared_ptr<const Rectification> current_;
    State state_;
};

}  // namespace disparityd::capture
