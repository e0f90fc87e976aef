// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "kernels/image.h"
#include "kernels/matcher.h"

namespace disparityd::trust {

/// How far apart, in rows, matched pixels of both eyes lie: counts of offsets in 1/16 px, in three by three regions of
/// the image. A right pixel that lies lower counts as positive.
class RowOffsets {
public:
    static constexpr int regions_along = 3;
    static constexpr int regions = regions_along * regions_along;
    static constexpr int reach_px = 3;
    static constexpr int unit = 16;  ///< of a pixel

    /// Measures some patches of a frame; `turn` says which: four turns in a row look at other places.
    void add(const FrameView& frame, std::uint32_t turn);

    /// The median of a region, 1/16 px; nothing where there are too few offsets.
    std::optional<int> median(int region) const;

private:
    static constexpr int bins = 2 * reach_px * unit + 1;

    std::array<std::array<std::int32_t, bins>, regions> offsets_{};
};

}  // namespace disparityd::trust
