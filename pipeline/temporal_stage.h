// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "kernels/added_stage.h"

namespace disparityd::pipeline {

/// Step 17 of docs/algorithm.md: a disparity that agrees with the one of the frame before becomes a mean over time,
/// which makes the noise of what stands still less. It measures no pixel more and none less, moves a disparity by at
/// most a quarter of a pixel, and changes no confidence.
class TemporalStage final : public AddedStage {
public:
    /// Width and height are those of the rectified image.
    TemporalStage(int width, int height);

    std::string_view name() const override { return "temporal"; }
    StagePlace place() const override { return StagePlace::after_matching; }
    bool depends_on_earlier_frames() const override { return true; }
    void run(const StageFrame& frame, Parallel& workers) override;

private:
    void average(const FrameView& frame, Rows rows);

    std::vector<std::int16_t> means_;  ///< of the frame before, 1/64 px
    std::int64_t before_ns_ = 0;       ///< when that was captured
};

}  // namespace disparityd::pipeline
