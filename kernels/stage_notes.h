// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace disparityd {

/// A part of the rectified left image: columns first_x .. end_x - 1, rows first_y .. end_y - 1.
struct PixelBox {
    int first_x = 0;
    int first_y = 0;
    int end_x = 0;
    int end_y = 0;
};

/// What stages that make records of the same frames tell each other. The stages share it, and only the
/// thread that runs them uses it.
struct StageNotes {
    /// From the obstacle scan, of this frame: blocks of FrameView::near that show no ground. Nothing: not known.
    std::optional<std::ptrdiff_t> near_blocks;
    /// From trust, of the frame before: what an eye sees through dirt.
    std::vector<PixelBox> dirty;
    int dark_level = 20;  ///< from trust: a picture is dark where it is less than this, 1 .. 255
};

}  // namespace disparityd
