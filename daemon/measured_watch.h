// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>

#include "calibration/calibration.h"
#include "daemon/background_pairs.h"
#include "kernels/options.h"
#include "pipeline/frame_slot.h"

namespace disparityd::daemon {

/// Counts how much of the frames is measured and how much is too near for that, and looks in the background for the
/// likely cause where it is little (calibration/empty_result/).
class MeasuredWatch {
public:
    /// The frames have this size and range; `calibration` is what their pairs are rectified by.
    MeasuredWatch(int width, int height, DisparityRange range,
                  const std::optional<calibration::StereoCalibration>& calibration);

    /// One line for people when much of the image has become nearer than the range, once each time; else empty. One
    /// thread.
    std::string near_line();

    /// Takes a finished frame; called in the publish thread. Counts a few frames a second. Allocates nothing.
    void offer(const pipeline::FrameSlot& slot) noexcept;

    struct Finding {
        double share = 0;   ///< of the pixels that is measured, 0 .. 1
        double near = 0;    ///< of the image that is nearer than the range; 0 without the near guard
        std::string cause;  ///< for people, UTF-8: why so little; empty where enough is, or while no cause is known
    };

    /// Returns what was found last; nothing before the first frame. Any thread.
    std::optional<Finding> finding() const;

private:
    void look(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right);

    const DisparityRange range_;
    const std::optional<calibration::StereoCalibration> calibration_;
    std::chrono::steady_clock::time_point next_count_;  ///< of the publish thread
    std::atomic<double> share_{-1};                     ///< of the pixels; negative: no frame yet
    std::atomic<double> near_{0};                       ///< of the image
    bool near_told_ = false;                            ///< of the thread that calls near_line()
    std::atomic<bool> has_cause_{false};                ///< the cause below is that of what is measured now
    mutable std::mutex mutex_;                          ///< the next
    std::string cause_;
    BackgroundPairs pairs_;  ///< last: its thread uses the rest
};

}  // namespace disparityd::daemon
