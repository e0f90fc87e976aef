// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/matcher.h"
#include "trust/eye_texture.h"

namespace disparityd::trust {

enum class CellState : std::uint8_t {
    unknown,  ///< the other eye shows too little texture, or it is not known where it sees the same
    sharp,
    dull,  ///< it shows much less texture than the other eye, wherever that may see the same
};

struct DullCells {
    Cells<CellState> left{};
    Cells<CellState> right{};
};

/// Compares each cell of an eye with the cells of the other one where the disparities around it put the same things.
/// Where nothing was measured, the nearest cells that were say which disparities may be meant.
void find_dull_cells(const FrameView& frame, const EyeTexture& left, const EyeTexture& right, DullCells& found);

/// Marks the left cells that may show the same as one of the right cells, by the same disparities.
void add_left_cells(const FrameView& frame, const Cells<bool>& right, Cells<bool>& left);

}  // namespace disparityd::trust
