// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/scan_counts.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// Between these horizontal distances, in mm, nothing can stand. Both are 0 where nothing is known.
struct Clear {
    double from = 0;
    double to = 0;
};

/// What the right eye says of pixels that were not measured. A thing there that both eyes could see would be in the
/// right image, too, nearer than what that shows where it was measured. So a strip that a thing hides from the right
/// eye can itself hide nothing much nearer than that thing. One thread; memory is allocated by the constructor only.
class RightView {
public:
    explicit RightView(const Geometry& geometry);

    /// A frame begins. `pixels` outlive what is asked of it.
    void begin(const Pixels& pixels);

    /// Returns between which horizontal distances no obstacle of the smallest size covers one of the columns
    /// [first, end) of the middle row of a group, first < end.
    Clear clear(const Geometry& geometry, int group, int first, int end);

private:
    const std::int16_t* row_of(const Geometry& geometry, int group);
    void add_up(const std::int16_t* row, int begin, int first);
    bool may_stand(int at, int half, int added) const;

    Pixels pixels_;
    int width_;
    /// By group and column of the right image: the column of the left one that shows the same; none.
    std::vector<std::int16_t> sources_;
    std::vector<std::uint8_t> known_;  ///< by group: its sources are of this frame
    /// Of the columns before one: how many show what lies behind all that may stand in the pixels asked for.
    std::vector<std::int16_t> behind_;
};

}  // namespace disparityd::scan
