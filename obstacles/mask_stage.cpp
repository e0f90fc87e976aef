// SPDX-License-Identifier: Apache-2.0
#include "obstacles/mask_stage.h"

#include <algorithm>

#include "kernels/near_plane.h"

namespace disparityd {

MaskStage::MaskStage(const ImageMask& mask, DisparityRange range) : invalid_(invalid_disparity(range)) {
    for (int y = 0; y < mask.height(); ++y) {
        for (int x = 0; x < mask.width(); ++x) {
            if (!mask.at(x, y)) {
                continue;
            }
            if (x == 0 || !mask.at(x - 1, y)) {
                runs_.push_back({y, x, x});
            }
            runs_.back().last = x + 1;
        }
    }
}

void MaskStage::run(const StageFrame& frame, Parallel& /*workers*/) {
    const FrameView& view = frame.view;
    for (const Run& run : runs_) {
        std::fill(view.disparity.row(run.row) + run.first, view.disparity.row(run.row) + run.last, invalid_);
        std::fill(view.confidence.row(run.row) + run.first, view.confidence.row(run.row) + run.last, std::uint8_t{0});
    }
    if (!view.near) {
        return;
    }
    for (const Run& run : runs_) {
        std::int16_t* const blocks = view.near.row(run.row / near_block);
        std::fill(blocks + run.first / near_block, blocks + near_blocks(run.last), not_near);
    }
}

}  // namespace disparityd
