// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

void guided_median(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid, int size,
                   Plane<std::int16_t> out, Rows rows) {
    constexpr std::size_t most = 7 * 7;
    const int radius = size / 2;
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < in.width; ++x) {
            if (in.at(x, y) == invalid) {
                out.at(x, y) = invalid;
                continue;
            }
            std::array<std::int16_t, most> counting;  // the pixel itself is one of them
            std::size_t count = 0;
            for (int dy = -radius; dy <= radius; ++dy) {
                const int row = std::clamp(y + dy, 0, in.height - 1);
                for (int dx = -radius; dx <= radius; ++dx) {
                    const int column = std::clamp(x + dx, 0, in.width - 1);
                    const std::int16_t value = in.at(column, row);
                    if (value != invalid &&
                        std::abs(guide.at(column, row) - guide.at(x, y)) <= guided_median_tolerance) {
                        counting[count++] = value;
                    }
                }
            }
            auto* const middle = counting.begin() + (count - 1) / 2;
            std::nth_element(counting.begin(), middle, counting.begin() + count);
            out.at(x, y) = *middle;
        }
    }
}

}  // namespace disparityd::reference
