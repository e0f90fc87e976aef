// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "kernels/image.h"
#include "kernels/matcher.h"

namespace disparityd::trust {

/// How far apart, in rows, matched pixels of both eyes lie: counts of offsets in 1/16 px, in six bands of the image:
/// three from top to bottom, then three from left to right. A right pixel that lies lower counts as positive.
class RowOffsets {
public:
    static constexpr int bands_along = 3;
    static constexpr int bands = 2 * bands_along;
    static constexpr int reach_px = 3;
    static constexpr int unit = 16;  ///< of a pixel

    /// Measures some patches of a frame; `turn` says which: four turns in a row look at other places.
    void add(const FrameView& frame, std::uint32_t turn);

    /// The median of a band, 1/16 px; nothing where there are too few offsets, or they do not agree.
    std::optional<int> median(int band) const;

private:
    static constexpr int bins = 2 * reach_px * unit + 1;

    std::array<std::array<std::int32_t, bins>, bands> offsets_{};
};

}  // namespace disparityd::trust
