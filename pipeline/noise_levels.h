// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>

#include "kernels/added_stage.h"
#include "kernels/noise/noise_level_switch.h"
#include "pipeline/heartbeat.h"

namespace disparityd::pipeline {

/// How noisy a frame was, and how it was matched.
struct FrameNoise {
    int sigma256 = 0;  ///< standard deviation of each eye's noise, 1/256 grey levels
    int level = 0;     ///< 0 .. 3
};

/// Gives each frame the noise level with which it is matched ("Noise levels" in docs/algorithm.md). The level follows
/// from the noise of the frames up to the fourth one before it, however many are in flight: a recording gives the same
/// bytes with any number of slots and workers. As a stage it estimates the noise of each finished frame.
class NoiseLevels final : public AddedStage {
public:
    static constexpr std::uint64_t lag = 4;

    std::string_view name() const override { return "noise"; }
    StagePlace place() const override { return StagePlace::record; }
    bool depends_on_earlier_frames() const override { return true; }
    void run(const StageFrame& frame, Parallel& workers) override;

    /// Returns the level of the next frame. One thread calls this once for each frame that run() gets later, in the
    /// same order. Waits until run() had the fourth frame before it; `heartbeat` beats meanwhile, and `failed` ends the
    /// wait.
    int next(bool discontinuity, Heartbeat& heartbeat, const std::atomic<bool>& failed);

    /// Returns what is known of the newest frame in which noise could be estimated. Any thread.
    std::optional<FrameNoise> newest() const;

private:
    std::uint64_t begun_ = 0;  ///< frames that next() was asked for; as the next one, of its thread only
    std::uint64_t first_ = 0;  ///< of these, the one with which the source began anew
    NoiseLevelSwitch switch_;  ///< of run()'s thread only

    mutable std::mutex mutex_;  ///< all below
    std::condition_variable estimated_changed_;
    std::uint64_t estimated_ = 0;        ///< frames that run() had
    std::array<int, 2 * lag> levels_{};  ///< after each of the last ones
    std::optional<FrameNoise> newest_;
};

}  // namespace disparityd::pipeline
