// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "kernels/added_stage.h"
#include "obstacles/image_mask.h"

namespace disparityd {

/// Takes what shows the robot's own parts out of a frame: masked pixels are rejected, and no block of the near guard
/// that touches one is near. Its constructor allocates all its memory.
class MaskStage final : public AddedStage {
public:
    /// `mask` is not empty; `range` is what frames are matched with.
    MaskStage(const ImageMask& mask, DisparityRange range);

    std::string_view name() const override { return "mask"; }
    StagePlace place() const override { return StagePlace::after_matching; }
    bool depends_on_earlier_frames() const override { return false; }
    void run(const StageFrame& frame, Parallel& workers) override;

private:
    /// Columns [first, last) of a row.
    struct Run {
        int row = 0;
        int first = 0;
        int last = 0;
    };

    std::vector<Run> runs_;  ///< of masked pixels
    std::int16_t invalid_;
};

}  // namespace disparityd
